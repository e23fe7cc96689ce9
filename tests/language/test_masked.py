from __future__ import annotations

import pytest

from elitescript.language.text.masked import header_colon, operand_before, top_level


@pytest.mark.parametrize(
    ("code", "colon"),
    [
        ("if x:", 4),
        ("if x: f()", 4),
        ("if x[1:2]: f({1: 2})", 9),
        ("while n := f(): g()", 14),
        ("if lambda: 0: f()", 12),
        ("if (lambda: 0): f()", 14),
        ("else:", 4),
        ("def f(a: int = {1: 2}) -> x: y", 27),
        ("if x", -1),
        ("if x[1:2]", -1),
    ],
)
def test_the_colon_of_a_header(code, colon):
    assert header_colon(code) == colon


@pytest.mark.parametrize(
    ("code", "mark", "indices"),
    [("a, f(b, c), d", ",", [1, 10]), ("a; b", ";", [1]), ("(a, b)", ",", []), ("", ",", [])],
)
def test_marks_outside_brackets(code, mark, indices):
    assert list(top_level(code, mark)) == indices


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ("x ", True),
        ("f(1)", True),
        ("a[0]", True),
        ('""', True),
        ("3", True),
        ("None", True),
        ("x +", False),
        ("return", False),
        ("not ", False),
        ("", False),
        ("(", False),
    ],
)
def test_what_ends_with_a_value(code, expected):
    assert operand_before(code) is expected
