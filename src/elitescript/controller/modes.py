"""Robot modes: what the arm's power and brakes are doing, as a table.

The times of powering on and of releasing the brakes belong to the port that asks for them; here is
only which step leads where.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.errors import ScriptStateError
from elitescript.messages.enums import RobotMode

TRANSITIONS: Final[dict[tuple[RobotMode, str], RobotMode]] = {
    (RobotMode.POWER_OFF, "power_on"): RobotMode.IDLE,
    (RobotMode.IDLE, "release_brakes"): RobotMode.RUNNING,
    (RobotMode.RUNNING, "engage_brakes"): RobotMode.IDLE,
    (RobotMode.IDLE, "power_off"): RobotMode.POWER_OFF,
    (RobotMode.RUNNING, "power_off"): RobotMode.POWER_OFF,
}

WHY_NOT_READY: Final[dict[RobotMode, str]] = {
    RobotMode.POWER_OFF: "the arm is switched off",
    RobotMode.IDLE: "the brakes are engaged",
}

SWITCH_ON_HINT: Final = "power on and release the brakes; starting a program does both"


class Power:
    """Mode of one robot."""

    __slots__ = ("_on_change", "is_going_off", "mode")

    def __init__(self, on_change: Callable[[RobotMode], None], mode: RobotMode = RobotMode.RUNNING) -> None:
        self._on_change = on_change
        self.is_going_off = False
        self.mode = mode

    def require_ready(self) -> None:
        """Let a motion pass.

        Raises:
            ScriptStateError: the arm is off, goes off, or its brakes are engaged.
        """
        why = WHY_NOT_READY.get(RobotMode.POWER_OFF if self.is_going_off else self.mode)
        if why is not None:
            raise ScriptStateError(f"the arm cannot move: {why}", code="R115", hint=SWITCH_ON_HINT)

    def go_up(self) -> None:
        """Power on and release the brakes, as far as that is not done."""
        self.is_going_off = False
        if self.mode is RobotMode.POWER_OFF:
            self.apply("power_on")
        if self.mode is RobotMode.IDLE:
            self.apply("release_brakes")

    def go_off(self) -> None:
        """Power off at the next standstill."""
        self.is_going_off = True

    def settle(self, is_moving: bool) -> None:
        """Power off if that is due and the arm stands still."""
        if self.is_going_off and not is_moving:
            self.is_going_off = False
            if self.mode is not RobotMode.POWER_OFF:
                self.apply("power_off")

    def apply(self, action: str) -> None:
        """Make one step of the table.

        Raises:
            ScriptStateError: the table does not have it.
        """
        after = TRANSITIONS.get((self.mode, action))
        if after is None:
            raise ScriptStateError(f"cannot {action.replace('_', ' ')} while the robot is {self.mode.name}")
        self.mode = after
        self._on_change(after)
