from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.machine import WriteSignal

KINDS = [("boolean", "bool", True), ("integer", "int", -(2**31)), ("float", "float", 2.5)]


@pytest.mark.parametrize(("kind", "short", "value"), KINDS)
def test_input_registers_are_read(call: Any, robot: Any, kind: str, short: str, value: Any) -> None:
    robot.machine.image[f"input_{short}_register", 5] = value
    assert call(f"read_input_{kind}_register", 5) == value
    assert type(call(f"read_input_{kind}_register", 6)) is type(value)


@pytest.mark.parametrize(("kind", "short", "value"), KINDS)
def test_output_registers_are_written_and_read_back(call: Any, robot: Any, kind: str, short: str, value: Any) -> None:
    call(f"write_output_{kind}_register", 47, value)
    assert robot.asked == [WriteSignal(f"output_{short}_register", 47, value)]
    assert call(f"read_output_{kind}_register", 47) == value
    assert call(f"read_input_{kind}_register", 47) == type(value)()


def test_ints_stand_for_floats_and_bools(call: Any, robot: Any) -> None:
    call("write_output_float_register", 0, 3)
    call("write_output_boolean_register", 0, 3)
    call("write_output_integer_register", 0, True)
    assert [type(request.value) for request in robot.asked] == [float, bool, int]
    assert robot.asked[1].value is True
