import json
from math import inf, nan

from elitescript.json_records.jsonlines import line, plain


def test_what_json_has_stays_as_it_is():
    record = {"a": [1, 2.5, True, None, "x"], "b": {"c": 10**30}}
    assert json.loads(line(record)) == record


def test_what_json_lacks_is_written_as_text():
    assert plain([nan, inf, -inf]) == ["NaN", "Infinity", "-Infinity"]
    assert plain((1, (2,))) == [1, [2]]
    assert plain({1: 2}) == {"repr": "{1: 2}"}
    assert plain(1j) == {"repr": "1j"}


def test_floats_keep_every_digit():
    assert json.loads(line({"x": 0.1 + 0.2}))["x"] == 0.1 + 0.2


def test_a_list_that_contains_itself_ends_somewhere():
    loop = []
    loop.append(loop)
    assert "..." in line({"loop": loop})


def test_an_object_whose_repr_fails_still_has_a_line():
    class Broken:
        def __repr__(self):
            raise ValueError

    assert plain(Broken()) == {"repr": "<Broken>"}


def test_a_subclass_of_str_or_int_is_plain():
    class Name(str):
        pass

    assert type(json.loads(line({"n": Name("x")}))["n"]) is str


def test_lists_that_contain_themselves_many_times_over_end_soon():
    loop = []
    loop += [loop, loop, loop]
    assert len(line({"loop": loop})) < 1000
    root = {"kids": []}
    root["kids"] += [{"parent": root}, {"parent": root}, {"parent": root}]
    assert len(line(root)) < 1000
    twice = [1, 2]
    assert json.loads(line({"a": [twice, twice]}))["a"] == [[1, 2], [1, 2]]


def test_what_no_encoding_has_is_still_json():
    assert json.loads(line({"s": "\ud800 中"}))["s"] == "\ud800 中"


def test_a_number_of_many_digits_is_described():
    assert "bits" in plain(10**50_000)["repr"]
    assert plain(10**3000) == 10**3000


def test_addresses_are_left_out():
    assert "0x" not in plain(object())["repr"]
