"""Checks that commands make before they say that they are not simulated."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from elitescript.errors import ArgumentTypeError, NotSimulatedError


@pytest.mark.parametrize(
    "text",
    [
        "serial_write('hello')",
        "serial_write(300)",
        "serial_write([1, 300])",
        "serial_write(b'a')",
        "tool_serial_write(bytearray(b'a'))",
        "serial_modbus_write_registers(1, 0, 12)",
        "serial_modbus_write_bits(1, 0, [True, 0, 1])",
        "serial_read(4, timeout=1)",
        "rpc_factory('xmlrpc', '127.0.0.1:9120')",
    ],
)
def test_good_calls_get_as_far_as_the_reason(script: Any, robot: Any, text: str) -> None:
    name = text.partition("(")[0]
    with pytest.raises(NotSimulatedError, match=f"^{name}: .* not simulated yet$") as caught:
        script(text)
    assert caught.value.code == "R106"
    assert robot.asked == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("freedrive_mode([1, 1, 1, 1, 1, 1], 'flange')", "frame must be one of 'base', 'tool', got 'flange'"),
        ("serial_write([1, 'a'])", "data element 1 must be an int, not str 'a'"),
        ("serial_write(1.5)", "data must be str or int or bytes or list"),
        ("modbus_set_output_signal('s', 'on')", "digital_value must be bool or list"),
    ],
)
def test_values_of_several_kinds_are_refused_in_plain_words(script: Any, text: str, message: str) -> None:
    with pytest.raises(Exception, match=message):
        script(text)


def test_control_time_of_servoj_is_a_number(script: Any) -> None:
    with pytest.raises(ArgumentTypeError, match=r"^servoj: t must be a number, not str 'fast'"):
        script("servoj([0, 0, 0, 0, 0, 0], 'fast')")


def test_serial_ports_are_off_and_can_be_switched_off(script: Callable[[str], Any]) -> None:
    assert script("tool_serial_config(False, 115200, 0, 1, modbus_rtu=False, usage=0)") is False
    assert script("serial_config(False, 115200, 0, 1)") is True
    assert script("masterboard_serial_config(False, 115200, 0, 1)") is True
    assert script("[tool_serial_is_open(), serial_is_open()]") == [False, False]
    assert script("[tool_serial_mode(), serial_mode()]") == ["CLOSE", "CLOSE"]
