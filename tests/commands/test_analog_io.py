from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.enums import AnalogDomain
from elitescript.messages.machine import SetAnalogDomain, SetAnalogFraction


@pytest.mark.parametrize(
    ("name", "args", "signal"),
    [
        ("get_standard_analog_in", (1,), "standard_analog_in"),
        ("get_standard_analog_out", (1,), "standard_analog_out"),
        ("get_tool_analog_in", (), "tool_analog_in"),
        ("get_tool_analog_out", (), "tool_analog_out"),
    ],
)
def test_levels_are_read_in_their_unit(call: Any, robot: Any, name: str, args: Any, signal: str) -> None:
    robot.machine.image[signal, args[0] if args else 0] = 0.0123
    assert call(name, *args) == 0.0123


@pytest.mark.parametrize(
    ("name", "args", "request_"),
    [
        ("set_standard_analog_input_domain", (1, 0), SetAnalogDomain("standard_analog_in", 1, AnalogDomain.CURRENT)),
        ("set_standard_analog_output_domain", (0, 1), SetAnalogDomain("standard_analog_out", 0, AnalogDomain.VOLTAGE)),
        ("set_tool_analog_input_domain", (1,), SetAnalogDomain("tool_analog_in", 0, AnalogDomain.VOLTAGE)),
        ("set_tool_analog_output_domain", (0,), SetAnalogDomain("tool_analog_out", 0, AnalogDomain.CURRENT)),
    ],
)
def test_domains_are_chosen(call: Any, robot: Any, name: str, args: Any, request_: Any) -> None:
    call(name, *args)
    assert robot.asked == [request_]


@pytest.mark.parametrize("fraction", [0, 0.25, 1])
def test_outputs_are_set_as_a_fraction(call: Any, robot: Any, fraction: float) -> None:
    call("set_standard_analog_out", 1, fraction)
    assert robot.asked == [SetAnalogFraction("standard_analog_out", 1, float(fraction))]


@pytest.mark.parametrize(("given", "fraction"), [(1.5, 1.0), (-0.1, 0.0)])
def test_fractions_are_limited_with_a_warning(call: Any, robot: Any, given: float, fraction: float) -> None:
    call("set_standard_analog_out", 0, given)
    (request,) = robot.asked
    ((code, text, _hint),) = robot.told
    assert (code, text) == ("W234", f"set_standard_analog_out: f is {given:g}, limited to {fraction:g}")
    assert request == SetAnalogFraction("standard_analog_out", 0, fraction)
