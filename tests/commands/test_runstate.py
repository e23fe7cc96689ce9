from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.enums import RunstateChoice
from elitescript.messages.machine import SetRunstateChoice


@pytest.mark.parametrize(
    ("kind", "signal"),
    [
        ("configurable_digital", "configurable_digital_out"),
        ("gp_boolean", "output_bool_register"),
        ("standard_analog", "standard_analog_out"),
        ("standard_digital", "standard_digital_out"),
        ("tool_digital", "tool_digital_out"),
    ],
)
@pytest.mark.parametrize("choice", list(RunstateChoice))
def test_outputs_are_tied(call: Any, robot: Any, kind: str, signal: str, choice: RunstateChoice) -> None:
    call(f"set_runstate_{kind}_output_to_value", 1, int(choice))
    assert robot.asked == [SetRunstateChoice(signal, 1, choice)]


def test_the_tool_has_one_analog_output(call: Any, robot: Any) -> None:
    call("set_runstate_tool_analog_output_to_value", 3)
    assert robot.asked == [SetRunstateChoice("tool_analog_out", 0, RunstateChoice.FOLLOW)]
