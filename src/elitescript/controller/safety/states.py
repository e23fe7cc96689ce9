"""The safety state machine as a table: actions allowed in each state, and the states they lead to.

`TRANSITIONS` and `REFUSALS` together have a row for every state and every action. A result of None means the state that
the inputs require at that moment (`SafetyInputs.mode`).

Evidence: names and numbers of the states are *documented* (vendor's SDK), and so is that they are seen by clients;
that a protective stop can be unlocked, and that the safety system can be restarted, is *documented* too (dashboard and
primary interface). Effects of a stop on task and power, and precedence of states, are *assumed*: they follow the
stop categories of IEC 60204-1 as collaborative arms apply them. A restart takes the power of the arm in every state,
also in `NORMAL` (*assumed*: the board that starts anew is the one that switches it), and ends a task; clients wait for
`NORMAL` alone, which comes at once unless an input still asks for a stop.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.controller.modes import SWITCH_ON
from elitescript.errors import ScriptStateError
from elitescript.messages.enums import SafetyMode
from elitescript.messages.timing import ticks_for
from elitescript.records import NamedTuple
from elitescript.said import said

UNLOCK_AFTER_S: Final = 5.0
"""Time from a protective stop until it can be unlocked (*assumed*; clients wait as long for it)."""

NORMAL, REDUCED, RECOVERY = SafetyMode.NORMAL, SafetyMode.REDUCED, SafetyMode.RECOVERY
PROTECTIVE, SAFEGUARD = SafetyMode.PROTECTIVE_STOP, SafetyMode.SAFEGUARD_STOP
ROBOT_STOP, SYSTEM_STOP = SafetyMode.ROBOT_EMERGENCY_STOP, SafetyMode.SYSTEM_EMERGENCY_STOP
VIOLATION, FAULT = SafetyMode.VIOLATION, SafetyMode.FAULT

MODES: Final = (NORMAL, REDUCED, RECOVERY, SAFEGUARD, PROTECTIVE, SYSTEM_STOP, ROBOT_STOP, VIOLATION, FAULT)
"""Simulated states, the strongest last."""

MOVING_MODES: Final = (NORMAL, REDUCED, RECOVERY)
"""States in which the arm may move."""

_STOPS: Final = (SAFEGUARD, PROTECTIVE)


class SafetyEffect(NamedTuple):
    """Effect of entering a state on arm, task and power."""

    arm: str
    task: str
    """`runs`, `is paused` or `is stopped`."""
    is_power_kept: bool
    code: str = ""
    """Alarm of the stopped task: a row of `errors.CODES`."""
    class_name: str = ""


EFFECTS: Final[dict[SafetyMode, SafetyEffect]] = {
    NORMAL: SafetyEffect("moves", "runs", True),
    REDUCED: SafetyEffect("moves, slowed down to the reduced limits", "runs", True),
    RECOVERY: SafetyEffect("moves, slowed down to the reduced limits; limits of position do not count", "runs", True),
    SAFEGUARD: SafetyEffect("brakes and holds its place (category 2)", "is paused", True),
    PROTECTIVE: SafetyEffect("brakes and holds its place (category 2)", "is stopped", True, "R140", "ProtectiveStop"),
    SYSTEM_STOP: SafetyEffect(
        "brakes, then its power goes off (category 1)", "is stopped", False, "R141", "EmergencyStop"
    ),
    ROBOT_STOP: SafetyEffect(
        "brakes, then its power goes off (category 1)", "is stopped", False, "R141", "EmergencyStop"
    ),
    VIOLATION: SafetyEffect("brakes, then its power goes off", "is stopped", False, "R142", "SafetyViolation"),
    FAULT: SafetyEffect("brakes, then its power goes off", "is stopped", False, "R142", "SafetyFault"),
}
"""Power that the real arm cuts at once (category 0) also goes off at standstill here, for the mechanical brakes are not
modelled (*assumed*)."""


class SafetyInputs:
    """Conditions that require a state for as long as they last."""

    __slots__ = ("emergency_stop", "is_outside", "reduced_mode", "safeguard_stop", "system_emergency_stop")

    def __init__(
        self,
        *,
        emergency_stop: bool = False,
        system_emergency_stop: bool = False,
        safeguard_stop: bool = False,
        is_outside: bool = False,
        reduced_mode: bool = False,
    ) -> None:
        self.emergency_stop = emergency_stop
        self.system_emergency_stop = system_emergency_stop
        self.safeguard_stop = safeguard_stop
        self.is_outside = is_outside
        """The arm is outside its limits of position."""
        self.reduced_mode = reduced_mode

    @property
    def mode(self) -> SafetyMode:
        """The strongest state that is required."""
        if self.emergency_stop:
            return ROBOT_STOP
        if self.system_emergency_stop:
            return SYSTEM_STOP
        if self.safeguard_stop:
            return SAFEGUARD
        if self.is_outside:
            return RECOVERY
        return REDUCED if self.reduced_mode else NORMAL


def _from(modes: tuple[SafetyMode, ...], after: SafetyMode | None) -> dict[SafetyMode, SafetyMode | None]:
    """Return a row that leads from `modes` to `after` and keeps every other state."""
    return {mode: after if mode in modes else mode for mode in MODES}


_ROWS: Final[dict[str, dict[SafetyMode, SafetyMode | None]]] = {
    "press_emergency_stop": _from((*MOVING_MODES, *_STOPS, SYSTEM_STOP), ROBOT_STOP),
    "release_emergency_stop": _from((ROBOT_STOP,), None),
    "press_system_stop": _from((*MOVING_MODES, *_STOPS), SYSTEM_STOP),
    "release_system_stop": _from((SYSTEM_STOP,), None),
    "open_safeguard": _from(MOVING_MODES, SAFEGUARD),
    "close_safeguard": _from((SAFEGUARD,), None),
    "ask_for_reduced": _from((NORMAL,), REDUCED),
    "end_reduced": _from((REDUCED,), None),
    "find_outside": _from((NORMAL, REDUCED), RECOVERY),
    "come_inside": _from((RECOVERY,), None),
    "stop_protectively": _from((*MOVING_MODES, SAFEGUARD), PROTECTIVE),
    "violate": _from(MODES[:-1], VIOLATION),
    "fail": _from(MODES, FAULT),
    "restart_safety": _from(MODES, None),
    "unlock_protective_stop": {PROTECTIVE: None},
    "power_on": {mode: mode for mode in (*MOVING_MODES, *_STOPS)},
    "move": {mode: mode for mode in MOVING_MODES},
    "start_task": {mode: mode for mode in (*MOVING_MODES, SAFEGUARD)},
    "resume_task": {mode: mode for mode in MOVING_MODES},
}

ACTIONS: Final = tuple(_ROWS)

INPUT_ACTIONS: Final = {
    "emergency_stop": ("press_emergency_stop", "release_emergency_stop"),
    "system_emergency_stop": ("press_system_stop", "release_system_stop"),
    "safeguard_stop": ("open_safeguard", "close_safeguard"),
}
"""Actions of a signal that becomes true, and false."""

ASKED_FROM_OUTSIDE: Final = ("stop_protectively", "unlock_protective_stop", "violate", "fail", "restart_safety")
"""Actions that a request may name; the others follow from signals, arm and task."""

TRANSITIONS: Final[dict[tuple[SafetyMode, str], SafetyMode | None]] = {
    (mode, action): after for action, row in _ROWS.items() for mode, after in row.items()
}

WHAT_TO_DO: Final[dict[SafetyMode, str]] = {
    SAFEGUARD: "the safeguard is open; close it (signal safeguard_stop to False)",
    PROTECTIVE: "the arm is in protective stop; remove its cause, then unlock it (unlock_protective_stop), "
    f"from {UNLOCK_AFTER_S:g} s after the stop on",
    SYSTEM_STOP: "the emergency stop of the cell is pressed; release it (signal system_emergency_stop to False), then "
    f"{SWITCH_ON}",
    ROBOT_STOP: f"the emergency stop is pressed; release it (signal emergency_stop to False), then {SWITCH_ON}",
    VIOLATION: f"a safety limit was violated; restart the safety system (restart_safety), then {SWITCH_ON}",
    FAULT: f"the safety system has a fault; restart it (restart_safety), then {SWITCH_ON}",
}
"""Reason why the arm may not move, and the way back."""

RESTART_HINTS: Final = (
    "look for the cause before the arm is switched on again",
    "release the stop, or restart the safety system after a violation or a fault",
    f"{SWITCH_ON}; then start the program again, from its first line",
)
"""Hints after a stop that has switched the power off."""

_NOT_LOCKED: Final = "there is no protective stop to unlock"


def _refusal(mode: SafetyMode, action: str) -> str:
    what_to_do = WHAT_TO_DO.get(mode, said("the safety mode is {mode}", mode=mode.name))
    return f"{_NOT_LOCKED}; {what_to_do}" if action == "unlock_protective_stop" else what_to_do


REFUSALS: Final[dict[tuple[SafetyMode, str], str]] = {
    (mode, action): _refusal(mode, action) for mode in MODES for action in ACTIONS if (mode, action) not in TRANSITIONS
}


class Safety:
    """Holds the safety state of one robot.

    Args:
        on_change: called with the states before and after a change.

    Attributes:
        inputs: present conditions.
        mode: the state.
        since_tick: tick of its last change.
    """

    __slots__ = ("_on_change", "inputs", "mode", "since_tick")

    def __init__(self, on_change: Callable[[SafetyMode, SafetyMode], None]) -> None:
        self._on_change = on_change
        self.since_tick = 0
        self.inputs = SafetyInputs()
        self.mode = NORMAL

    @property
    def may_move(self) -> bool:
        """Whether the arm may move."""
        return self.mode in MOVING_MODES

    def refusal(self, action: str) -> str:
        """Return why an action is refused in this state; empty if it is not."""
        return REFUSALS.get((self.mode, action), "")

    def check(self, action: str) -> None:
        """Check that this state allows an action.

        Raises:
            ScriptStateError: it does not; the text names the remedy.
        """
        why = self.refusal(action)
        if why:
            raise ScriptStateError(
                said("cannot {action}: {why}", action=action.replace("_", " "), why=why), code="R115"
            )

    def apply(self, action: str, tick: int, *, is_standing: bool = True) -> None:
        """Make one step of the table at a tick.

        Args:
            action: one of `ACTIONS`.
            tick: the present one.
            is_standing: whether the arm has come to rest.

        Raises:
            ScriptStateError: not in the table, or too early; nothing has changed.
        """
        self.check(action)
        if action == "unlock_protective_stop":
            self._check_unlock(tick, is_standing)
        before = self.mode
        after = TRANSITIONS[before, action]
        after = self.inputs.mode if after is None else after
        if after is before:
            return
        self.mode = after
        self.since_tick = tick
        self._on_change(before, after)

    def _check_unlock(self, tick: int, is_standing: bool) -> None:
        left = self.since_tick + ticks_for(UNLOCK_AFTER_S) - tick
        if not is_standing:
            raise ScriptStateError("cannot unlock protective stop: the arm still brakes", code="R115")
        if left > 0:
            raise ScriptStateError(
                said(
                    "cannot unlock protective stop: that is possible {unlock_after_s:g} s after the stop, in "
                    "{left:.3f} s",
                    unlock_after_s=UNLOCK_AFTER_S,
                    left=left * 0.004,
                ),
                code="R115",
                value=(tick - self.since_tick) * 0.004,
                limit=f">= {UNLOCK_AFTER_S:g}",
                unit="s",
                hint="look for the cause of the stop first",
            )
