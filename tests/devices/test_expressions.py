"""Expressions over signals: what they come to, what they refuse."""

from __future__ import annotations

import pytest

from elitescript.devices.expressions import Expression
from elitescript.errors import UsageError

LEVELS = {
    "standard_digital_out[0]": True,
    "standard_digital_out[1]": False,
    "standard_analog_out[0]": 2.5,
    "tool_analog_in": 4.0,
}


@pytest.mark.parametrize(
    "text, value",
    [
        ("standard_digital_out[0]", True),
        ("not standard_digital_out[0]", False),
        ("standard_digital_out[0] and not standard_digital_out[1]", True),
        ("standard_digital_out[1] or False", False),
        ("standard_analog_out[0] > 2", True),
        ("1 < standard_analog_out[0] <= 2.5", True),
        ("-standard_analog_out[0] * 2 + 1", -4.0),
        ("tool_analog_in // 3 + 7 % 4", 4.0),
        ("max(tool_analog_in, 5) if standard_digital_out[1] else round(2.6)", 3),
        ("[a, a + 1][1]", 11),
        ("{'x': a}['x']", 10),
        ("'b' in ['b'] and a != 3", True),
        ("len('abc') + abs(-2)", 5),
        ("'T%03d' % a", "T010"),
        ("standard_digital_out[1] or 'none'", "none"),
    ],
)
def test_they_come_to_what_python_makes_of_them(text, value):
    assert Expression(text, ("a",)).value(LEVELS.__getitem__, {"a": 10}) == value


def test_they_say_which_signals_they_depend_on():
    expression = Expression("standard_digital_out[ 0 ] and tool_analog_in > 3 or standard_digital_out[0]")
    assert expression.signals == ("standard_digital_out[0]", "tool_analog_in")


@pytest.mark.parametrize(
    "text, words",
    [
        ("", "write an expression"),
        ("1 +", "is no expression"),
        ("x", "nothing is called 'x'"),
        ("standard_digital_out[16]", "indices 0 to 15, not 16"),
        ("standard_digital_out", "needs an index"),
        ("open('x')", "is not possible here; functions are abs, bool"),
        ("abs(x=3)", "is not possible here"),
        ("(1).real", "is not possible here"),
        ("lambda: 1", "is not possible here"),
        ("[n for n in [1]]", "is not possible here"),
        ("2 ** 9999999", "Pow is not possible here"),
        ("f'{1}'", "is not possible here"),
        ("(" * 500 + ")" * 500, "is no expression"),
        ("1" * 3000, "2000 characters at most"),
        ("-" * 60 + "1", "more than 40 deep"),
        (3, "write an expression as a text"),
        ("standard_digital_out[0] && a", "write `and` instead of `&&`"),
        ("standard_digital_out[0] || a", "write `or` instead of `\\|\\|`"),
        ("!standard_digital_out[0]", "write `not` instead of `!`"),
        ("standard_digital_out[0] = True", "write `==` instead of `=`"),
        ("'a = b' === a", "write `==` instead of `===`"),
        ("standard_digital_out[0] AND a", "write `and` instead of `AND`"),
        ("standard_digital_out[0] ? 1 : 0", "`a if condition else b`"),
        ("standard_digital_out[0] == true", "write True"),
        ("standard_digital_ot[0]", "did you mean 'standard_digital_out'"),
        ("standard_digital_uot", "did you mean 'standard_digital_out'"),
        ("get_standard_digital_out(3)", r"write standard_digital_out\[3\]"),
    ],
)
def test_what_is_not_possible_is_refused(text, words):
    with pytest.raises(UsageError, match=words):
        Expression(text)


def test_values_that_do_not_fit_are_explained():
    with pytest.raises(UsageError, match="'1 / a' cannot be worked out: ZeroDivisionError"):
        Expression("1 / a", ("a",)).value(LEVELS.__getitem__, {"a": 0})


def test_what_would_take_the_memory_is_refused():
    with pytest.raises(UsageError, match="the result would be too large"):
        Expression("'a' * a", ("a",)).value(LEVELS.__getitem__, {"a": 10**10})
