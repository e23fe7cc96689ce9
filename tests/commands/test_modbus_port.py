"""`read_port_...` and `write_port_...`: what they ask of the machine. What it makes of that: tests/controller."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError
from elitescript.messages.machine import WritePortCoils, WritePortRegisters


def test_a_coil_is_read(call: Any, robot: Any) -> None:
    robot.machine.port_coils[127] = True
    assert call("read_port_bit", 127) is True
    assert call("read_port_bit", 0) is False


@pytest.mark.parametrize(
    ("value", "signed"), [(0, 0), (1, 1), (0x7FFF, 32767), (0x8000, -32768), (0xFFFE, -2), (0xFFFF, -1)]
)
def test_a_register_is_read_signed_or_not(call: Any, robot: Any, value: int, signed: int) -> None:
    robot.machine.port_registers[511] = value
    assert call("read_port_register", 511) == value
    assert call("read_port_register", 511, False) == value
    assert call("read_port_register", 511, True) == signed
    assert call("read_port_register", address=511, is_signed=True) == signed


def test_the_version_is_that_of_the_controller(call: Any) -> None:
    assert [call("read_port_register", address) for address in (63, 64, 65)] == [2, 15, 0]


def test_a_coil_is_written(call: Any, robot: Any) -> None:
    call("write_port_bit", 3, True)
    call("write_port_bit", 127, 0)
    assert robot.asked == [WritePortCoils(3, (True,)), WritePortCoils(127, (False,))]


@pytest.mark.parametrize(("value", "word"), [(0, 0), (100, 100), (65535, 65535), (-1, 65535), (-32768, 32768)])
def test_a_register_is_written_signed_or_not(call: Any, robot: Any, value: int, word: int) -> None:
    call("write_port_register", 256, value)
    assert robot.asked == [WritePortRegisters(256, (word,))]


@pytest.mark.parametrize(
    ("name", "arguments", "text"),
    [
        ("read_port_bit", (128,), "address must be in"),
        ("read_port_bit", (-1,), "address must be in"),
        ("write_port_bit", (128, True), "address must be in"),
        ("read_port_register", (512,), "address must be in"),
        ("read_port_register", (-1,), "address must be in"),
        ("write_port_register", (512, 1), "address must be in"),
        ("write_port_register", (256, 65536), "value must be in"),
        ("write_port_register", (256, -32769), "value must be in"),
    ],
)
def test_what_is_out_of_range_is_refused(
    call: Any, robot: Any, name: str, arguments: tuple[Any, ...], text: str
) -> None:
    with pytest.raises(ArgumentRangeError, match=f"^{name}: {text}"):
        call(name, *arguments)
    assert robot.asked == []
