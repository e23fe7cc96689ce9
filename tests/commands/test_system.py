from __future__ import annotations

from typing import Any

import pytest

from elitescript.messages.machine import PowerDown, WriteSignal


@pytest.mark.parametrize(("time_s", "ticks"), [(0, 0), (0.004, 1), (0.0041, 2), (0.1, 25), (1, 250), (True, 250)])
def test_sleep_waits_whole_control_periods(call: Any, robot: Any, time_s: float, ticks: int) -> None:
    call("sleep", time_s)
    assert robot.asked == [("wait_ticks", ticks)]


def test_sync_waits_one_control_period(call: Any, robot: Any) -> None:
    call("sync")
    assert robot.asked == [("wait_ticks", 1)]


def test_step_time_and_clock(call: Any, robot: Any) -> None:
    assert call("get_steptime") == 0.004
    robot.machine.tick = 500
    assert call("controller_timestamp") == 1704067202.0


def test_flags_are_written_and_read(call: Any, robot: Any) -> None:
    assert call("get_flag", 31) is False
    call("set_flag", 31, 1)
    assert robot.asked == [WriteSignal("flag", 31, True)]
    assert call("get_flag", 31) is True


def test_powerdown_and_task_path(call: Any, robot: Any) -> None:
    call("powerdown")
    assert robot.asked == [PowerDown(), "halt"]
    assert call("get_task_path") == "/tasks/"
