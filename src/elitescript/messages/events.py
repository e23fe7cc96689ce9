"""What happened, in the order in which it happened.

Every event carries the tick at which it happened. The list of events of a run is its meaning: two runs
with the same events did the same.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.motion import MotionRequest, TrackCircular, TrackLinear
from elitescript.messages.signals import Value
from elitescript.messages.yielding import YieldRequest


@dataclass(frozen=True, slots=True)
class TextMessage:
    """`textmsg`: a line for the robot's log."""

    tick: int
    text: str
    thread: str
    line: int
    level: str = "info"


@dataclass(frozen=True, slots=True)
class Printed:
    """`print`: text for the task log and the terminal."""

    tick: int
    text: str
    thread: str
    line: int


@dataclass(frozen=True, slots=True)
class Popup:
    """A message window."""

    tick: int
    text: str
    title: str
    level: str
    """`info`, `warning` or `error`."""
    is_blocking: bool
    is_confirmed_at_once: bool
    """Nobody is there to press the button, so the program goes on."""
    thread: str
    line: int


@dataclass(frozen=True, slots=True)
class Warned:
    """Something that goes on, but not as the program asked."""

    tick: int
    text: str
    thread: str = ""
    line: int = 0
    code: str = ""
    """Row of `errors.CODES`, when `check` knows the same finding."""
    hint: str = ""
    """What to do about it."""
    column: int = 0
    """From 1, in characters; 0 if unknown."""
    severity: str = "warning"
    """`error` for a finding that `check` calls an error, though the program starts."""

    def __str__(self) -> str:
        """Place, severity, code, text and hint in one line."""
        place = f"line {self.line}" + (f", column {self.column}" if self.column else "") if self.line else ""
        kind = f"{self.severity} {self.code}" if self.code else "" if self.severity == "warning" else self.severity
        words = ": ".join(part for part in (place, kind, self.text) if part)
        return f"{words} ({self.hint})" if self.hint else words


@dataclass(frozen=True, slots=True)
class DeviceNoted:
    """A virtual device beside the robot has something to say."""

    tick: int
    device: str
    text: str
    is_warning: bool = False


@dataclass(frozen=True, slots=True)
class Alarm:
    """An error that stopped the program."""

    tick: int
    code: str
    class_name: str
    text: str
    line: int
    column: int
    thread: str
    source_line: str = ""
    details: dict[str, Any] = field(default_factory=dict)
    """`command`, `argument`, `value`, `limit`, `unit`, `hint`, as far as they apply."""


@dataclass(frozen=True, slots=True)
class SignalChanged:
    """A point of the signal image has a new value."""

    tick: int
    name: str
    value: Value
    by: str = "program"
    """What changed it: `program`, `client`, `device`, `wire`, `schedule` or `fault`."""
    line: int = 0
    """Line of the program; 0 if it was not the program."""


@dataclass(frozen=True, slots=True)
class ChannelActivity:
    """A connection to the outside was opened or closed, or carried data."""

    tick: int
    channel: str
    """Name of the connection as the program, or the world file, calls it."""
    kind: str
    """`socket`, `rpc`, `modbus` or `serial`."""
    what: str
    """`open`, `sent`, `received`, `closed`, `refused` or `timeout`."""
    data: str = ""
    """What was carried, as text; a long one is cut."""
    line: int = 0
    """Line of the program; 0 if no statement of it caused this."""
    thread: str = ""


@dataclass(frozen=True, slots=True)
class MotionStarted:
    """The arm begins what was asked for: at once, at the begin of a blend, or when it has come to rest before.

    A line of a `movep` chain that runs already is told of when it is accepted.
    """

    tick: int
    request: MotionRequest
    line: int
    thread: str
    duration_s: float
    """Duration at full speed; 0 when the arm is already there. Of `speedj` the time until its speeds are reached; 0
    of `speedl` and `servoj`, where it is not known."""


@dataclass(frozen=True, slots=True)
class MotionEnded:
    """The arm stands still again, at its target or because it was stopped; or another motion has taken over.

    A move that ends because the next one is blended with it is complete.
    """

    tick: int
    is_complete: bool


@dataclass(frozen=True, slots=True)
class TrackingStarted:
    """The arm goes along with a conveyor, besides its moves."""

    tick: int
    request: TrackLinear | TrackCircular
    line: int
    thread: str


@dataclass(frozen=True, slots=True)
class TrackingEnded:
    """The arm does not go along with a conveyor any more, and comes to rest."""

    tick: int


@dataclass(frozen=True, slots=True)
class TaskStateChanged:
    """A program started, paused, went on or ended."""

    tick: int
    state: TaskState
    name: str


@dataclass(frozen=True, slots=True)
class RobotModeChanged:
    """Power or brakes changed."""

    tick: int
    mode: RobotMode


@dataclass(frozen=True, slots=True)
class SafetyModeChanged:
    """The safety system changed its mind."""

    tick: int
    mode: SafetyMode
    reason: str = ""


@dataclass(frozen=True, slots=True)
class LineMarked:
    """A `$ LINE` mark was passed."""

    tick: int
    number: int
    label: str


@dataclass(frozen=True, slots=True)
class YieldingChanged:
    """Force mode or hand guiding began, changed or is asked to end; the end of a program says nothing more."""

    tick: int
    request: YieldRequest
    line: int
    """0 if an input asked for it."""
    thread: str


Event = (
    TextMessage
    | Printed
    | Popup
    | Warned
    | DeviceNoted
    | Alarm
    | SignalChanged
    | ChannelActivity
    | MotionStarted
    | MotionEnded
    | TrackingStarted
    | TrackingEnded
    | TaskStateChanged
    | RobotModeChanged
    | SafetyModeChanged
    | LineMarked
    | YieldingChanged
)
