"""Single facts that several ports show in their own form, so that they agree.

Numbers of joint and tool modes are *documented* by the vendor's SDK; which of them belongs to which robot mode is
*assumed*.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.snapshot import Snapshot

POWERED: Final = frozenset(
    {RobotMode.POWER_ON, RobotMode.BOOTING, RobotMode.IDLE, RobotMode.BACK_DRIVE, RobotMode.RUNNING}
)
"""Booting is what the joints do between power and idle."""
EMERGENCY_STOPS: Final = frozenset({SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP})

JOINT_POWER_OFF: Final = 239
JOINT_MODES: Final[dict[RobotMode, int]] = {
    RobotMode.NO_CONTROLLER: 245,
    RobotMode.DISCONNECTED: 245,
    RobotMode.CONFIRM_SAFETY: JOINT_POWER_OFF,
    RobotMode.BOOTING: 247,
    RobotMode.POWER_OFF: JOINT_POWER_OFF,
    RobotMode.POWER_ON: 246,
    RobotMode.IDLE: 255,
    RobotMode.BACK_DRIVE: 238,
    RobotMode.RUNNING: 253,
    RobotMode.UPDATING: 249,
}
JOINT_MODES_OF_SAFETY: Final[dict[SafetyMode, int]] = {SafetyMode.VIOLATION: 251, SafetyMode.FAULT: 252}
"""What the joints show whatever the robot mode is."""

TOOL_MODES: Final[dict[RobotMode, int]] = {
    RobotMode.NO_CONTROLLER: 245,
    RobotMode.DISCONNECTED: 245,
    RobotMode.CONFIRM_SAFETY: 239,
    RobotMode.BOOTING: 247,
    RobotMode.POWER_OFF: 239,
    RobotMode.POWER_ON: 247,
    RobotMode.IDLE: 255,
    RobotMode.BACK_DRIVE: 253,
    RobotMode.RUNNING: 253,
    RobotMode.UPDATING: 249,
}


def is_powered(snapshot: Snapshot) -> bool:
    """Whether the arm has power; its brakes may be closed."""
    return snapshot.robot.robot_mode in POWERED


def is_emergency_stopped(snapshot: Snapshot) -> bool:
    """Whether an emergency stop holds the arm."""
    return snapshot.robot.safety_mode in EMERGENCY_STOPS


def is_protectively_stopped(snapshot: Snapshot) -> bool:
    """Whether a protective stop holds the arm."""
    return snapshot.robot.safety_mode is SafetyMode.PROTECTIVE_STOP


def is_program_running(snapshot: Snapshot) -> bool:
    """Whether a program runs and is not paused."""
    return snapshot.robot.task_state is TaskState.PLAYING


def joint_mode(snapshot: Snapshot) -> int:
    """Mode of every joint."""
    shown = JOINT_MODES_OF_SAFETY.get(snapshot.robot.safety_mode)
    return JOINT_MODES[snapshot.robot.robot_mode] if shown is None else shown


def tool_mode(snapshot: Snapshot) -> int:
    """Mode of the tool's electronics."""
    return TOOL_MODES[snapshot.robot.robot_mode]


def digital_levels(snapshot: Snapshot, direction: str) -> tuple[bool, ...]:
    """Levels in the order of the ports' bit words: 0 to 15 standard, 16 to 23 configurable, 24 on tool.

    Args:
        snapshot: of a tick.
        direction: `in` or `out`.
    """
    families = ("standard_digital", "configurable_digital", "tool_digital")
    return tuple(bool(level) for name in families for level in snapshot.signals[f"{name}_{direction}"])
