"""Robot modes as a table: power and brakes of the arm.

`TRANSITIONS` has every step between modes, `STEPS` those of powering up with the time spent in each mode before.

Evidence: modes and their order are *documented* (vendor's SDK: power on ends in idle, releasing the brakes in running;
clients wait 30 s for each). The durations of the steps are *assumed*.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Final

from elitescript.errors import ArmNotReadyError, ScriptStateError, UsageError
from elitescript.messages.enums import RobotMode
from elitescript.messages.timing import ticks_for
from elitescript.records import record
from elitescript.said import said

OFF, ON, BOOTING = RobotMode.POWER_OFF, RobotMode.POWER_ON, RobotMode.BOOTING
IDLE, RUNNING = RobotMode.IDLE, RobotMode.RUNNING

TRANSITIONS: Final[dict[tuple[RobotMode, str], RobotMode]] = {
    (OFF, "power_on"): ON,
    (ON, "boot"): BOOTING,
    (BOOTING, "initialise"): IDLE,
    (IDLE, "release_brakes"): RUNNING,
    (RUNNING, "engage_brakes"): IDLE,
    (ON, "power_off"): OFF,
    (BOOTING, "power_off"): OFF,
    (IDLE, "power_off"): OFF,
    (RUNNING, "power_off"): OFF,
}

WHY_NOT_READY: Final[dict[RobotMode, str]] = {
    OFF: "the arm is switched off",
    ON: "the arm is being switched on",
    BOOTING: "the arm is being switched on",
    IDLE: "the brakes are engaged",
}

SWITCH_ON: Final = "power on and release the brakes"
"""Hint for an arm without power; a front end may add how it is done there."""


@record
class PowerTimes:
    """Durations of powering up, s (*assumed*: clients wait much longer, real arms take seconds)."""

    power_on_s: float = 0.4
    """From the command until the joints boot."""
    boot_s: float = 0.8
    """Until they are idle."""
    release_s: float = 1.0
    """From the command until the brakes are open."""

    def __post_init__(self) -> None:
        for value in (self.power_on_s, self.boot_s, self.release_s):
            if not (isfinite(value) and value >= 0.0):
                raise UsageError(f"times of powering on must be >= 0 s, got {value!r}")


AT_ONCE: Final = PowerTimes(0.0, 0.0, 0.0)
REALISTIC: Final = PowerTimes()

STEPS: Final[dict[RobotMode, tuple[str, Callable[[PowerTimes], float]]]] = {
    OFF: ("power_on", lambda _: 0.0),
    ON: ("boot", lambda times: times.power_on_s),
    BOOTING: ("initialise", lambda times: times.boot_s),
    IDLE: ("release_brakes", lambda times: times.release_s),
}
"""Next step of powering up, and after what time in the mode."""

_WAY_UP: Final = (OFF, ON, BOOTING, IDLE, RUNNING)


class Power:
    """Mode of one robot.

    Args:
        on_change: called with every new mode.
        mode: at the start.
        times: durations of powering up.
    """

    __slots__ = ("_goal", "_on_change", "_since_tick", "_times", "is_going_off", "mode")

    def __init__(
        self, on_change: Callable[[RobotMode], None], mode: RobotMode = RUNNING, times: PowerTimes = AT_ONCE
    ) -> None:
        self._on_change = on_change
        self._times = times
        self._goal: RobotMode | None = None
        self._since_tick = 0
        self.is_going_off = False
        self.mode = mode

    @property
    def next_tick(self) -> int | None:
        """Tick of the next step of powering up; None if there is none."""
        if self._goal is None:
            return None
        return self._since_tick + ticks_for(STEPS[self.mode][1](self._times))

    def require_ready(self) -> None:
        """Check that the arm can move.

        Raises:
            ArmNotReadyError: the arm is off, goes off, or its brakes are engaged.
        """
        why = WHY_NOT_READY.get(OFF if self.is_going_off else self.mode)
        if why is not None:
            raise ArmNotReadyError(said("the arm cannot move: {why}", why=why), code="R115", hint=SWITCH_ON)

    def go_up(self, goal: RobotMode, tick: int) -> None:
        """Power on, and for the goal `RUNNING` release the brakes, where necessary.

        Args:
            goal: `IDLE` or `RUNNING`.
            tick: the present one.
        """
        self.is_going_off = False
        if _WAY_UP.index(self.mode) >= _WAY_UP.index(goal):
            return
        if self._goal is None:
            self._since_tick = tick
        if self._goal is not RUNNING:
            self._goal = goal
        self.go_on(tick)

    def go_on(self, tick: int) -> None:
        """Make the steps that are due."""
        while self._goal is not None and (due := self.next_tick) is not None and due <= tick:
            self._since_tick = due
            self.apply(STEPS[self.mode][0])
            if self.mode is self._goal:
                self._goal = None

    def go_off(self) -> None:
        """Power off at the next standstill."""
        self._goal = None
        self.is_going_off = True

    def settle(self, is_moving: bool) -> None:
        """Power off if that was asked for and the arm stands still."""
        if self.is_going_off and not is_moving:
            self.is_going_off = False
            if self.mode is not OFF:
                self.apply("power_off")

    def apply(self, action: str) -> None:
        """Make one step of the table.

        Raises:
            ScriptStateError: the table does not have it.
        """
        after = TRANSITIONS.get((self.mode, action))
        if after is None:
            raise ScriptStateError(
                said("cannot {action} while the robot is {mode}", action=action.replace("_", " "), mode=self.mode.name)
            )
        self.mode = after
        self._on_change(after)
