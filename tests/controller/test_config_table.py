"""Tables are read key by key, and what is left over is a mistake."""

import pytest

from elitescript.controller.config_table import ConfigTable, shown
from elitescript.errors import UsageError


def test_values_come_out_in_their_kinds():
    table = ConfigTable("[x]", {"a": 1, "b": [1, 2.5], "c": "word", "d": [0, 3, 4], "e": 7})
    assert table.number("a", "m") == 1.0
    assert table.numbers("b", 2, "m") == (1.0, 2.5)
    assert table.numbers("e", 3, "m") == (7.0, 7.0, 7.0)
    assert table.text("c", "other") == "word"
    assert table.direction("d") == (0.0, 0.6, 0.8)
    table.finish()


def test_what_is_not_given_is_none_or_the_default():
    table = ConfigTable("[x]", {})
    assert (table.number("a", "m"), table.numbers("a", 3, "m"), table.direction("a"), table.value("a")) == (None,) * 4
    assert table.text("a", "default") == "default"
    assert not table.has("a")


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
        read(ConfigTable("[x]", {"s": "w", "n": -1, "l": [1, "w"]}))


def test_what_is_no_table_is_refused_and_long_values_are_cut():
    with pytest.raises(UsageError, match=r"\[x\] must be a table of keys, got 3"):
        ConfigTable("[x]", 3)
    assert len(shown("a" * 100)) == 60
