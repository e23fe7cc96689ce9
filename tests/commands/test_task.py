from __future__ import annotations

from typing import Any


def test_pause_and_halt_reach_the_program(call: Any, robot: Any) -> None:
    call("pause")
    call("halt")
    assert robot.asked == ["pause", "halt"]


def test_halt_works_in_a_secondary_program(call: Any, robot: Any) -> None:
    robot.is_secondary = True
    call("halt")
    assert robot.asked == ["halt"]
