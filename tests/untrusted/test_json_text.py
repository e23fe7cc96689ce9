"""JSON that others wrote."""

from __future__ import annotations

import pytest

from elitescript.untrusted.json_text import DEPTH_MAX, JsonError, json_value


def refusal(data: str | bytes) -> JsonError:
    with pytest.raises(JsonError) as found:
        json_value(data)
    return found.value


def test_values_come_as_json_has_them() -> None:
    assert json_value(b'{"a": [1, 2.5, null, true, "\\u00e9[{"]}') == {"a": [1, 2.5, None, True, "é[{"]}


def test_nesting_is_bounded_before_parsing() -> None:
    deepest = "[" * DEPTH_MAX + "]" * DEPTH_MAX
    assert json_value(deepest) != []
    error = refusal("[\n" + deepest + "]")
    assert (str(error), error.line) == ("nested more than 100 deep in line 2", 2)
    assert str(refusal('{"a":' * 200_000)) == "nested more than 100 deep in line 1"


def test_brackets_in_texts_and_beside_each_other_do_not_nest() -> None:
    assert json_value('["' + "[" * 1000 + '\\"[[", ' + "[]," * 1000 + "1]")[-1] == 1


def test_a_number_of_thousands_of_digits_is_refused_in_words_of_json() -> None:
    error = refusal("[1,\n" + "9" * 5000 + "]")
    assert (str(error), error.line) == ("a number of 5000 digits in line 2", 2)


def test_places_are_kept() -> None:
    error = refusal('[1,\n x"]')
    assert (str(error), error.at, error.line) == ("Expecting value: line 2 column 2", 5, 2)


def test_what_is_not_utf_8_is_refused() -> None:
    error = refusal(b'["a",\n"\xff"]')
    assert (str(error), error.at, error.line) == ("not UTF-8: invalid start byte at byte 7", 7, 2)


def test_constants_can_be_refused() -> None:
    def no(name: str) -> float:
        raise JsonError(f"{name} is no JSON")

    with pytest.raises(JsonError, match="NaN is no JSON"):
        json_value("[NaN]", parse_constant=no)
