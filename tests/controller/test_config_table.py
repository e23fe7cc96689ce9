"""Tests that tables are read key by key, and that keys which are left over are refused."""

import pytest

from elitescript.controller.safety.config_table import ConfigTable
from elitescript.errors import UsageError


def test_values_come_out_in_their_kinds():
    table = ConfigTable("x", {"a": 1, "b": [1, 2.5], "c": "word", "d": [0, 3, 4], "e": 7})
    assert table.number("a", "m") == 1.0
    assert table.numbers("b", 2, "m") == (1.0, 2.5)
    assert table.numbers("e", 3, "m") == (7.0, 7.0, 7.0)
    assert table.text("c", "other") == "word"
    assert table.direction("d") == (0.0, 0.6, 0.8)
    table.finish()


def test_what_is_not_given_is_none_or_the_default():
    table = ConfigTable("x", {})
    assert (table.number("a", "m"), table.numbers("a", 3, "m"), table.direction("a"), table.value("a")) == (None,) * 4
    assert table.text("a", "default") == "default"
    assert table.table("a") is None
    assert table.tables("a") == []


@pytest.mark.parametrize(
    ("read", "text"),
    [
        (lambda t: t.number("s", "m"), r"\[x\] s must be a number in m, got 'w'"),
        (lambda t: t.number("n", "m", is_positive=True), r"n must be a number > 0 in m, got -1"),
        (lambda t: t.numbers("l", 2, "m"), r"l\[1\] must be a number in m, got 'w'"),
        (lambda t: t.text("n", ""), r"n must be a text, got -1"),
        (lambda t: t.text("s", "", ("a", "b")), r"s must be one of 'a', 'b', got 'w'"),
        (lambda t: t.direction("n"), r"n must be three numbers, got -1"),
        (lambda t: t.finish(), r"s is not known"),
    ],
)
def test_a_wrong_value_says_what_it_must_be(read, text):
    with pytest.raises(UsageError, match=text):
        read(ConfigTable("x", {"s": "w", "n": -1, "l": [1, "w"]}))


def test_what_is_no_table_is_refused_and_long_values_are_cut():
    with pytest.raises(UsageError, match=r"\[x\] must be a table of keys, got 3"):
        ConfigTable("x", 3)
    with pytest.raises(UsageError, match=r"\[x\] a must be a text, got \[0, 0[0, ]+\.\.\.$") as found:
        ConfigTable("x", {"a": [0] * 100}).text("a", "")
    assert len(str(found.value).partition("got ")[2]) == 60


def test_inner_tables_are_named_by_their_place():
    table = ConfigTable("x", {"y": {"a": "w"}, "z": [{}, {"b": "w"}], "n": 3})
    with pytest.raises(UsageError, match=r"^\[x.y\] a must be a number"):
        table.table("y").number("a", "")
    with pytest.raises(UsageError, match=r"^\[\[x.z\]\] 2: b must be a number"):
        table.tables("z")[1].number("b", "")
    with pytest.raises(UsageError, match=r"^\[x.n\] must be a table"):
        table.table("n")
    with pytest.raises(UsageError, match=r"^\[x\] n must be a list of tables: write each under \[\[x.n\]\]"):
        table.tables("n")
