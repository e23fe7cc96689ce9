from __future__ import annotations

import pytest

from tests.lint.checking import body, marked, only


@pytest.mark.parametrize(
    ("call", "column"),
    [
        ("set_standard_digital_out(16, True)", 28),
        ("set_standard_digital_out(-1, True)", 28),
        ("set_standard_digital_out(b=True, n=8 * 2)", 38),
        ("sleep(-0.5)", 9),
        ("movej([0, 0, 0, 0, 0, 0], a=-1)", 31),
        ("movel([0.4, 0, 0.3, 0, 0, 0], r=d2r(-90))", 35),
        ("stopj(0)", 9),
        ("set_tool_voltage(13)", 20),
        ("movej([0, 1e999, 0, 0, 0, 0])", 9),
    ],
)
def test_a_literal_outside_the_range_is_found_at_the_argument(call, column):
    assert body(call) == [f"E305 2:{column}"]


@pytest.mark.parametrize(
    "lines",
    [
        ("set_standard_digital_out(15, True)", "sleep(0)", "stopj(0.1)", "set_tool_voltage(24)"),
        ("n = get_flag(1)", "set_standard_digital_out(n + 16, True)"),
        ("movej([0, d2r(-180), 2 * 3.14, -1, 0, 0], a=1.4, v=1.05, t=0, r=0)",),
        ("for n in range(16):", "  set_standard_digital_out(n, True)"),
    ],
    ids=str,
)
def test_what_may_fit_is_left_alone(lines):
    assert body(*lines) == []


def test_a_value_that_a_name_always_has_counts():
    assert body("LAMP = 16", "def on():", "  set_standard_digital_out(LAMP, True)", "on()") == ["E305 4:30"]


def test_a_name_that_may_change_does_not():
    assert body("lamp = 16", "lamp = 1", "set_standard_digital_out(lamp, True)") == []
    assert body("global lamp", "lamp = 16", "lamp = 1", "set_standard_digital_out(lamp, True)") == []


def test_the_text_has_value_limit_and_unit():
    problem = only("def job():\n  sleep(-1)\nend\n")
    assert problem.text == "sleep: t must be >= 0 s, got -1"
    assert problem.hint == "it is called as sleep(t)"


def test_the_argument_is_underlined():
    assert marked("def job():\n  set_standard_digital_out(2 ** 5, True)\nend\n") == "2 ** 5"


def test_a_function_of_the_program_is_not_the_command():
    lines = ("def set_flag(n, b):", "  pass", "set_flag(-5, True)")
    assert [finding for finding in body(*lines) if finding.startswith("E")] == []
