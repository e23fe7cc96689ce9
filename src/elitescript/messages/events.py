"""Events of a robot, in the order in which they happened; each carries its tick.

Two runs with the same events did the same. All have `tick`, `t` (s) and `line` (0 if no line has caused it).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.messages.motion import MotionRequest, TrackCircular, TrackLinear
from elitescript.messages.signals import Value, point_names
from elitescript.messages.timing import seconds
from elitescript.messages.yielding import YieldRequest
from elitescript.records import field, record


class Happened:
    """What all events have in common."""

    __slots__ = ()

    if TYPE_CHECKING:
        # Of each event, as a field; nothing is written on this class.
        @property
        def tick(self) -> int: ...

    @property
    def t(self) -> float:
        """Robot time, s, as `--json` has it."""
        return seconds(self.tick)

    @property
    def line(self) -> int:
        """Line of the program; 0 if none has caused it."""
        return 0


@record
class TextMessage(Happened):
    """`textmsg`: a line for the robot's log."""

    tick: int
    text: str
    thread: str
    line: int
    level: str = "info"
    """Severity."""


@record
class Printed(Happened):
    """`print`: text for the task log and the terminal."""

    tick: int
    text: str
    thread: str
    line: int


@record
class Popup(Happened):
    """A message window."""

    tick: int
    text: str
    title: str
    """Of the window."""
    level: str
    """`info`, `warning` or `error`."""
    is_blocking: bool
    """Whether the thread waits until the button is pressed."""
    is_confirmed_at_once: bool
    """Whether the program goes on at once, because nothing can press the button."""
    thread: str
    line: int


UNDELIVERED: Final = "W270"
"""Code of warnings about data that a program sent and that did not arrive."""
BARRED: Final = "W274"
"""Code of warnings about connections that the options of the robot do not let through."""

SOURCES: Final = {
    "N280": "end",
    "N290": "device",
    "R110": "limit",
    "R130": "end",
    "R140": "limit",
    "R141": "limit",
    "R142": "limit",
    "W273": "contact",
    "W280": "end",
    "W293": "device",
    UNDELIVERED: "end",
}
"""What has found a warning or alarm, by its code; `run` for all others. See `findings.Finding.source`."""


@record
class Warned(Happened):
    """A warning: the program goes on, but not as it asked."""

    tick: int
    text: str
    thread: str = ""
    line: int = 0
    code: str = ""
    """Row of `errors.CODES`, when `check` has the same finding."""
    hint: str = ""
    """What to do about it."""
    column: int = 0
    """From 1, in characters; 0 if unknown."""
    severity: str = "warning"
    """`error` for a finding that `check` calls an error, though the program starts; `note` for what a sound program
    may have too."""
    is_exception: bool = False
    """Whether an exception has ended a secondary program, or kept one from starting."""

    @property
    def source(self) -> str:
        """What has found it: `run`, `contact`, `device`, `limit` or `end`."""
        return SOURCES.get(self.code, "run")

    def __str__(self) -> str:
        """Place, severity, code, text and hint in one line."""
        place = f"line {self.line}" + (f", column {self.column}" if self.column else "") if self.line else ""
        kind = f"{self.severity} {self.code}" if self.code else "" if self.severity == "warning" else self.severity
        words = ": ".join(part for part in (place, kind, self.text) if part)
        return f"{words} ({self.hint})" if self.hint else words


@record
class DeviceNoted(Happened):
    """A virtual device beside the robot, or a fault, has reported something."""

    tick: int
    device: str
    """Its name; `fault` for a fault that acts."""
    text: str
    is_warning: bool = False
    """Whether something went wrong."""


@record
class Alarm(Happened):
    """An error that stopped the program."""

    tick: int
    code: str
    """Row of `errors.CODES`, such as `R101`."""
    class_name: str
    """Name of the exception."""
    text: str
    line: int
    column: int
    """Column of that line, from 1; 0 if it is not known."""
    thread: str
    source_line: str = ""
    """Text of that line."""
    details: dict[str, Any] = field(default_factory=dict)
    """`command`, `argument`, `value`, `limit`, `unit`, `hint`, as far as they apply; `node`: of a graphical program."""


@record
class SignalChanged(Happened):
    """A point of the signal image has a new value."""

    tick: int
    name: str
    """Such as `standard_digital_out[0]`; see [signals](signals.md)."""
    value: Value
    """The new one."""
    by: str = "program"
    """What changed it. `program`: a statement, or the start or end of the program that an output is tied to; `client`:
    RTSI, MODBUS or dashboard clients, `ctl`, or Python between two ticks; `device`: one of the world beside the robot;
    `wire`: one of its wires; `schedule`: one of its schedules, `robot.at`, and levels at the start of a served robot;
    `fault`: a fault."""
    line: int = 0
    """Line of the statement; 0 if none has caused it."""


@record
class ChannelActivity(Happened):
    """A connection to the outside was opened or closed, or carried data.

    MODBUS TCP signals have an entry when their value or their error changes, not for each request. At most 100 entries
    of one tick are kept; one more counts the rest.
    """

    tick: int
    channel: str
    """Name of the socket as the program calls it; URL of the procedures; `tool`, `box` or the device of a serial port;
    name of a MODBUS signal, or `address:port` of a MODBUS connection and of custom commands on it."""
    kind: str
    """`socket`, `rpc`, `modbus` or `serial`."""
    what: str
    """`open`, `sent`, `received`, `closed`, `refused` or `timeout` (an attempt to connect, a reading, an answer)."""
    data: str = ""
    """What was carried, as text, cut after 200 characters or bytes. Of sockets and serial ports it is UTF-8; other
    bytes and control characters are `\\xNN`. Of remote procedures it is call and result, of MODBUS the values that
    changed, of slaves on a serial port what was asked and answered. With `open` it is where the channel leads to, with
    `closed`, `refused` and `timeout` the reason."""
    line: int = 0
    """Line of the statement that caused it, or that waits for what arrives; 0 if there is none."""
    thread: str = ""
    """Name of its thread; empty if there is none."""


@record
class MotionStarted(Happened):
    """The arm begins a motion: at once, at the begin of a blend, or when it has come to rest before.

    A line of a `movep` chain that runs already has this event when it is accepted.
    """

    tick: int
    request: MotionRequest
    """What was asked for, such as `MoveJ`: a dataclass of `elitescript.messages.motion`."""
    line: int
    thread: str
    duration_s: float
    """Duration at full speed; 0 when the arm is already there. Of `speedj` the time until its speeds are reached; 0
    of `speedl` and `servoj`, where it is not known."""


@record
class MotionEnded(Happened):
    """A motion has ended: at its target, by a stop, or because another motion has taken over.

    A move that ends because the next one is blended with it is complete.
    """

    tick: int
    is_complete: bool
    """Whether it has reached its target."""


@record
class TrackingStarted(Happened):
    """The arm follows a conveyor, besides its moves."""

    tick: int
    request: TrackLinear | TrackCircular
    """What was asked for: a dataclass of `elitescript.messages.motion`."""
    line: int
    thread: str


@record
class TrackingEnded(Happened):
    """The arm no longer follows a conveyor, and comes to rest."""

    tick: int


@record
class TaskStateChanged(Happened):
    """A program started, paused, went on or ended."""

    tick: int
    state: TaskState
    """`PLAYING`, `PAUSED` or `STOPPED`."""
    name: str
    """Of the program."""
    ending: str = ""
    """How it ended: `finished`, `alarm` or `stopped`; empty while it runs."""
    replaced_by: str = ""
    """What began in its place: a program or a line and its client, in words."""


@record
class TaskLoaded(Happened):
    """A task of the task folder was loaded, to be played next."""

    tick: int
    name: str
    """Path of the task in the task folder."""


@record
class RobotModeChanged(Happened):
    """Power or brakes changed."""

    tick: int
    mode: RobotMode
    """The new one."""


@record
class SafetyModeChanged(Happened):
    """The safety system went into another mode."""

    tick: int
    mode: SafetyMode
    """The new one; see [safety](safety.md)."""
    reason: str = ""
    """Why, as far as it is known."""


@record
class LineMarked(Happened):
    """A `$ LINE` mark was passed."""

    tick: int
    number: int
    """Of the node of the program tree."""
    label: str
    """Text of the mark."""


@record
class YieldingChanged(Happened):
    """Force mode or hand guiding began, changed or is asked to end; the end of a program ends both without event."""

    tick: int
    request: YieldRequest
    """What was asked for: a dataclass of `elitescript.messages.yielding`."""
    line: int
    """Line of the statement; 0 if an input asked for it."""
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
    | TaskLoaded
    | RobotModeChanged
    | SafetyModeChanged
    | LineMarked
    | YieldingChanged
)

Change = tuple[int, str, int, Value, str, int]
"""A `SignalChanged` before it is made: tick, family, index, value, `by`, line. A program that writes registers in every
tick makes thousands, of which nothing may ever be read."""


def event_of(change: Event | Change) -> Event:
    """Return the event of a change of a signal; any other event as it is."""
    if not isinstance(change, tuple):
        return change
    tick, family, index, value, by, line = change
    return SignalChanged(tick, point_names(family)[index], value, by, line)


OBSERVED: Final[frozenset[type]] = frozenset()
"""Events that an observer of `findings.observing` takes; a test compares both."""
