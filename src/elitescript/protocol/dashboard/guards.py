"""States in which the dashboard shell accepts a command, and its refusals in the others, with their remedies.

All of it is *assumed*: clients know only the replies of success.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.snapshot import Snapshot
from elitescript.records import NamedTuple

EMERGENCY: Final = frozenset({SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP})
BROKEN: Final = frozenset({SafetyMode.VIOLATION, SafetyMode.FAULT})
ALL_MODES: Final = frozenset(RobotMode)
ALL_SAFETY: Final = frozenset(SafetyMode)
ALL_TASKS: Final = frozenset(TaskState)
HAS_ARM: Final = ALL_MODES - {
    RobotMode.NO_CONTROLLER,
    RobotMode.DISCONNECTED,
    RobotMode.CONFIRM_SAFETY,
    RobotMode.UPDATING,
    RobotMode.WAITING_CALIBRATION,
}
MAY_POWER: Final = ALL_SAFETY - EMERGENCY - BROKEN
MAY_MOVE: Final = frozenset({SafetyMode.NORMAL, SafetyMode.REDUCED})

WHY_TASK: Final[dict[TaskState, str]] = {
    TaskState.PLAYING: "a task is running; stop it first",
    TaskState.PAUSED: "a task is paused; stop it first",
    TaskState.STOPPED: "no task is running",
    TaskState.UNKNOWN: "the state of the task is not known",
}
REMEDY_OF_MODE: Final[dict[RobotMode, str]] = {
    RobotMode.POWER_OFF: "power on first (robotControl -on)",
    RobotMode.POWER_ON: "wait until it is IDLE",
    RobotMode.BOOTING: "wait until it is IDLE",
    RobotMode.IDLE: "release the brakes first (brakeRelease)",
}
REMEDY_OF_SAFETY: Final[dict[SafetyMode, str]] = {
    SafetyMode.PROTECTIVE_STOP: "remove its cause, then unlock it (unlockProtectiveStop)",
    SafetyMode.RECOVERY: "move the arm back inside its limits first",
    SafetyMode.SAFEGUARD_STOP: "close the safeguard first",
    SafetyMode.SYSTEM_EMERGENCY_STOP: "release the emergency stop of the cell first",
    SafetyMode.ROBOT_EMERGENCY_STOP: "release the emergency stop first",
    SafetyMode.VIOLATION: "restart the safety system first (safety -r)",
    SafetyMode.FAULT: "restart the safety system first (safety -r)",
}
"""How to leave a state in which a command is refused."""
LOCAL: Final = "the robot is under local control; switch it to remote control first (remoteControl -on)"

_SAFETY_NAMES: Final = {SafetyMode.UNDEFINED: "UNDEFINED_SAFETY_MODE"}


class Guard(NamedTuple):
    """States in which a command is accepted."""

    failure: str
    """Begin of the text of a refusal."""
    is_remote_only: bool = True
    modes: frozenset[RobotMode] = ALL_MODES
    safety: frozenset[SafetyMode] = ALL_SAFETY
    tasks: frozenset[TaskState] = ALL_TASKS

    def refusal(self, snapshot: Snapshot) -> str:
        """Return why the command is refused now; empty if it is accepted."""
        robot = snapshot.robot
        return self.refusal_in(robot.robot_mode, robot.safety_mode, robot.task_state, is_remote=snapshot.is_remote)

    def refusal_in(self, mode: RobotMode, safety: SafetyMode, task: TaskState, *, is_remote: bool = True) -> str:
        """Return why the command is refused in these states; empty if it is accepted."""
        if self.is_remote_only and not is_remote:
            return f"{self.failure}: {LOCAL}"
        if safety not in self.safety:
            why = f"safety status is {safety_name(safety)}"
            return f"{self.failure}: {_with_remedy(why, REMEDY_OF_SAFETY.get(safety))}"
        if mode not in self.modes:
            return f"{self.failure}: {_with_remedy(f'robotMode is {mode.name}', REMEDY_OF_MODE.get(mode))}"
        if task not in self.tasks:
            return f"{self.failure}: {WHY_TASK[task]}"
        return ""


def _with_remedy(why: str, remedy: str | None) -> str:
    return f"{why}; {remedy}" if remedy else why


def safety_name(mode: SafetyMode) -> str:
    """Return the name of a safety mode on this port."""
    return _SAFETY_NAMES.get(mode, mode.name)
