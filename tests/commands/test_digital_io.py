from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.machine import WriteSignal


@pytest.mark.parametrize("kind", ["standard", "configurable"])
def test_outputs_are_set_and_read_back(call: Any, robot: Any, kind: str) -> None:
    call(f"set_{kind}_digital_out", 3, 1)
    call(f"set_{kind}_digital_out", 4, False)
    assert robot.asked == [
        WriteSignal(f"{kind}_digital_out", 3, True),
        WriteSignal(f"{kind}_digital_out", 4, False),
    ]
    assert call(f"get_{kind}_digital_out", 3) is True
    assert call(f"get_{kind}_digital_out", 4) is False


@pytest.mark.parametrize("kind", ["standard", "configurable"])
def test_inputs_are_read(call: Any, robot: Any, kind: str) -> None:
    robot.machine.image[f"{kind}_digital_in", 7] = True
    assert call(f"get_{kind}_digital_in", 7) is True
    assert call(f"get_{kind}_digital_in", 6) is False
    assert call(f"get_{kind}_digital_out", 7) is False
