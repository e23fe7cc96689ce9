from __future__ import annotations

from math import inf, isnan, nan
from typing import Any

import pytest

from elitescript.errors import ArgumentTypeError, InvalidValueError


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("40", 40),
        ("-7", -7),
        ("+7", 7),
        ("007", 7),
        (" \t12\r\n", 12),
        ("10.1", 10.1),
        ("-2.", -2.0),
        (".3", 0.3),
        ("10E1", 100.0),
        ("1.5e-4", 1.5e-4),
        (".5E+2", 50.0),
        ("0XABC", 0xABC),
        ("-0x4a", -0x4A),
        ("INF", inf),
        ("-infinity", -inf),
        ("1e-400", 0.0),
        ("9" * 400, int("9" * 400)),
    ],
)
def test_text_that_shows_a_number(call: Any, text: str, number: float) -> None:
    result = call("to_num", text)
    assert result == number
    assert type(result) is type(number)


def test_nan_is_a_number_here(call: Any) -> None:
    assert isnan(call("to_num", "NaN"))
    assert isnan(call("to_num", "-nan"))


@pytest.mark.parametrize(
    "text",
    ["", " ", "12a", "1 2", "1_000", "0x", "0xg", "--1", "1e", ".", "e5", "nane", "0b1", "1,5", "٣", "1.5f", "\v1"],
)
def test_text_that_shows_no_number(call: Any, text: str) -> None:
    with pytest.raises(InvalidValueError, match=r"^to_num: .* is not a number"):
        call("to_num", text)


@pytest.mark.parametrize("text", ["1e309", "-1E999", "9" * 5000])
def test_number_that_is_too_large(call: Any, text: str) -> None:
    with pytest.raises(InvalidValueError, match=r"^to_num: .* is too large a number"):
        call("to_num", text)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.0, "1"),
        (0.1 + 0.2, "0.3"),
        (2.7182818284, "2.718282"),
        (1e-7, "0"),
        (100.0, "100"),
        (1e20, "100000000000000000000"),
        (-1.25, "-1.25"),
        (nan, "nan"),
        (-inf, "-inf"),
        (True, "True"),
        ("text", "text"),
        (-3, "-3"),
        ([8.0, 9.0, 3.5], "[8, 9, 3.5]"),
        ((1, 2.50), "(1, 2.5)"),
        ((), "()"),
        ((1,), "(1,)"),
        ([(1, 2.5), ()], "[(1, 2.5), ()]"),
        ({"a": 1.0, 2: [(3.5,)]}, "{'a': 1, 2: [(3.5,)]}"),
        ({}, "{}"),
        ({3, 1.5, (2,)}, "{(2,), 1.5, 3}"),
        (set(), "set()"),
        (frozenset({1}), "frozenset({1})"),
        ([{1}, {}], "[{1}, {}]"),
        (None, "None"),
        ([None, b"a"], "[None, b'a']"),
        (b"a", "b'a'"),
        (1 + 2j, "(1+2j)"),
        (range(3), "range(0, 3)"),
        ([], "[]"),
        ([[1.0, []], ["a", True]], "[[1, []], ['a', True]]"),
    ],
)
def test_values_as_text(call: Any, value: Any, text: str) -> None:
    assert call("to_str", value) == text
    assert call("str_cat", value, "") == text
    assert call("str_cat", "<", value) == "<" + text


def test_longest_text(call: Any) -> None:
    assert len(call("to_str", "a" * 1023)) == 1023
    assert len(call("str_cat", "a" * 1000, "b" * 23)) == 1023
    endless: list[Any] = [1]
    endless.append(endless)
    for value in ("a" * 1024, [1] * 100_000, endless, 10**2000, 10**100_000, [10**100_000], [[[[endless]]]]):
        with pytest.raises(InvalidValueError, match=r"^to_str: the text would be longer than 1023 bytes"):
            call("to_str", value)
    assert len(call("to_str", "a" * 1021 + "Ö")) == 1022
    with pytest.raises(InvalidValueError):
        call("to_str", "a" * 1022 + "Ö")


def test_deep_lists_are_written(call: Any) -> None:
    deep: list[Any] = []
    for _ in range(500):
        deep = [deep]
    assert call("to_str", deep) == "[" * 501 + "]" * 501


@pytest.mark.parametrize("value", [[1, object()], [[len]], {"a": object()}])
def test_lists_of_other_values_are_refused(call: Any, value: Any) -> None:
    with pytest.raises(ArgumentTypeError, match=r"^to_str: what is written holds values of built-in types, not "):
        call("to_str", value)


def test_positions_and_lengths_count_characters(call: Any) -> None:
    assert call("str_len", "Öl") == 2
    assert call("str_len", "\ud800") == 1
    assert call("str_at", "Öl", 1) == "l"
    assert call("str_sub", "Öl", 1) == "l"
    assert call("str_find", "Öl", "l") == 1


def test_parts_of_a_text(call: Any) -> None:
    assert call("str_sub", "abc", 3) == ""
    assert call("str_sub", "", 0) == ""
    assert call("str_sub", "abc", 1, None) == "bc"
    assert call("str_sub", "abc", 1, len=1) == "b"
    assert call("str_find", "abcabc", "c", 3) == 5
    assert call("str_find", "abc", "c", 99) == -1
    assert call("str_find", "abc", "") == 0
