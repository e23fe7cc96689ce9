"""Modes of joints and tool."""

from __future__ import annotations

import pytest

from elitescript.messages.enums import POWERED, RobotMode, SafetyMode
from elitescript.protocol.device_modes import joint_mode, tool_mode
from tests.protocol.snapshots import robot_state


@pytest.mark.parametrize("mode", RobotMode)
@pytest.mark.parametrize("safety", SafetyMode)
def test_every_pair_of_modes_has_its_numbers(mode: RobotMode, safety: SafetyMode) -> None:
    state = robot_state(robot_mode=mode, safety_mode=safety)
    assert 235 <= joint_mode(state) <= 255
    assert tool_mode(state) in (239, 245, 247, 249, 253)


def test_a_running_robot_has_running_joints_and_tool() -> None:
    state = robot_state(robot_mode=RobotMode.RUNNING)
    assert (joint_mode(state), tool_mode(state)) == (253, 253)


def test_joints_with_brakes_idle_while_the_tool_runs() -> None:
    state = robot_state(robot_mode=RobotMode.IDLE)
    assert (joint_mode(state), tool_mode(state)) == (255, 253)


def test_without_power_nothing_runs_and_nothing_is_broken() -> None:
    state = robot_state(robot_mode=RobotMode.POWER_OFF, safety_mode=SafetyMode.FAULT)
    assert (joint_mode(state), tool_mode(state)) == (239, 239)


@pytest.mark.parametrize(("safety", "number"), [(SafetyMode.VIOLATION, 251), (SafetyMode.FAULT, 252)])
def test_a_fault_shows_in_the_joints(safety: SafetyMode, number: int) -> None:
    assert joint_mode(robot_state(safety_mode=safety)) == number


def test_power_goes_from_power_on_to_running() -> None:
    assert {mode.name for mode in RobotMode if mode in POWERED} == {
        "POWER_ON",
        "BOOTING",
        "IDLE",
        "BACK_DRIVE",
        "RUNNING",
    }
