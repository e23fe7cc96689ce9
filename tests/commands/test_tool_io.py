from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ScriptStateError
from elitescript.messages.enums import ToolPinMode
from elitescript.messages.machine import SetToolAnalogMode, SetToolPin, WriteSignal


def test_settings_are_passed_on(call: Any, robot: Any) -> None:
    call("set_tool_digital", 2, True)
    call("set_tool_analog_io_work_mode", 3)
    call("set_tool_digital_io_config", 1, 2, True, False)
    call("set_tool_voltage", 24)
    assert robot.asked == [
        WriteSignal("tool_digital_out", 2, True),
        SetToolAnalogMode(3),
        SetToolPin(1, ToolPinMode.NPN, True, False),
        WriteSignal("tool_voltage", 0, 24),
    ]


def test_pins_are_read_through_their_configuration(call: Any, robot: Any) -> None:
    robot.machine.image["tool_digital_in", 1] = True
    assert call("get_tool_digital", 1) is True
    assert call("get_tool_digital", 0) is False


def test_setting_an_input_pin_is_refused_by_the_machine(call: Any, robot: Any) -> None:
    robot.refusal = ScriptStateError("tool pin 2 is an input", code="R122")
    with pytest.raises(ScriptStateError, match=r"^set_tool_digital: tool pin 2 is an input") as caught:
        call("set_tool_digital", 2, True)
    assert caught.value.code == "R122"


def test_generated_programs_can_configure_the_tool_with_any_firmware() -> None:
    from elitescript.commands.catalogue import CATALOGUE

    for name in ("set_tool_analog_io_work_mode", "set_tool_digital_io_config"):
        command = CATALOGUE.get(name)
        assert command is not None
        assert command.since == "2.10"
