from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.machine import ResetInputActions, SetInputAction


@pytest.mark.parametrize(
    ("kind", "signal"),
    [
        ("configurable_digital", "configurable_digital_in"),
        ("standard_digital", "standard_digital_in"),
        ("tool_digital", "tool_digital_in"),
        ("gp_boolean", "input_bool_register"),
    ],
)
@pytest.mark.parametrize(("action", "is_freedrive"), [("freedrive", True), ("default", False)])
def test_inputs_are_bound(call: Any, robot: Any, kind: str, signal: str, action: str, is_freedrive: bool) -> None:
    call(f"set_{kind}_input_action", 3, action)
    assert robot.asked == [SetInputAction(signal, 3, is_freedrive)]


def test_all_inputs_are_unbound(call: Any, robot: Any) -> None:
    call("set_input_actions_to_default")
    assert robot.asked == [ResetInputActions()]
