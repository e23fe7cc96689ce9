"""Observations: what the machine and the runtime have seen that is no event of a run, for its observers.

The place that knows a fact makes an observation only where the fact is rare, so a run in which it does not happen pays
nothing. `findings.observing` says which observer takes which.
"""

from __future__ import annotations

from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.records import record


@record
class ChannelLeft:
    """A program has ended and has not read all that a channel has received."""

    tick: int
    channel: str
    """Name of the channel for users."""
    kind: str
    """`socket` or `serial`."""
    data: bytes
    """What is left."""
    line: int
    """Line of the statement that has opened it."""
    thread: str


@record
class MotionLeft:
    """A program ends while a motion, force mode or the tracking of a conveyor is under way."""

    tick: int
    command: str
    """That asked for it, such as `servoj`."""
    line: int
    """Of that command; 0 if unknown."""
    thread: str
    left_rad: float = 0.0
    """Largest way of a joint that is left to the target, rad; 0 without a target."""
    speed_rad_per_s: float = 0.0
    """Speed of the fastest joint, rad/s."""


@record
class OddAnswer:
    """A question of `socket_get_var` got an answer that may not be to it, a line of another form, or none."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str
    question: str
    """As it was sent, without its line end."""
    earlier: str
    """What had arrived before the question was sent and was not read."""
    odd: str | None
    """The first line of another form, which was passed over; None if there was none."""
    is_late: bool
    """Whether no line of the form came in time."""


@record
class NumbersDropped:
    """A list in parentheses had more numbers than were asked for, or something in it was no number."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str
    text: str
    """The list as it came, without its parentheses."""
    asked: int
    came: int
    """Fields of the list."""
    read: int
    """Those that the program gets."""


@record
class ReadingEnded:
    """A reading ended by its timeout although data was there."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str
    data: bytes
    lacks: str
    """What kept it from ending: `prefix`, `suffix`, `parenthesis`, or `count`."""
    wanted: str
    """The mark that did not come; of a count, what came of how much."""
    waited_s: float


@record
class ReadingResumed:
    """A reading behind one that ended early has brought its data."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str


@record
class PeerClosed:
    """A program uses a connection that its peer has closed, for the first time since."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str
    done: str
    """`read` or `sent`."""
    reason: str
    """Of the close; empty if the peer has just closed."""


@record
class OtherServer:
    """A name that is open was opened for another server: the connection stays as it is."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str
    place: str
    """Address and port that the name stands for."""
    wanted: str
    """Address and port that were given."""


@record
class TextBeyondAscii:
    """A text was sent that has characters beyond ASCII."""

    tick: int
    channel: str
    kind: str
    line: int
    thread: str
    text: str


@record
class SignalPulsed:
    """A program has changed an output, register or flag twice in one tick: nothing outside has seen the first level."""

    tick: int
    signal: str
    line: int
    """Of the second change."""
    thread: str
    first_line: int
    unseen: Value
    value: Value
    """The level after the second change."""
    is_back: bool
    """Whether that is the level before the first one."""
    is_cleanup: bool
    """Whether the second change stands in a block of `except` or `finally`."""


@record
class InputMissed:
    """A digital input has changed more than once between two looks of a line that polls it."""

    tick: int
    signal: str
    line: int
    thread: str
    changes: int
    step_ticks: int
    """Between two looks of the line."""


@record
class ModbusReadEarly:
    """A program has read a MODBUS signal before its first answer."""

    tick: int
    signal: str
    line: int
    thread: str
    value: str
    """What the program got."""
    age_ticks: int
    """Since the signal was added."""


@record
class ModbusReadAgain:
    """A line that has read a MODBUS signal before its first answer has read it after that."""

    tick: int
    signal: str
    line: int
    thread: str


@record
class ModbusReplaced:
    """A program has set a MODBUS signal anew before the value that it had set was sent."""

    tick: int
    signal: str
    line: int
    thread: str
    unsent: str
    value: str
    held_ticks: int
    """How long the value that was not sent had been set."""
    frequency_hz: int
    sets: int
    """How often the signal was set before."""
    span_ticks: int
    """Since it was first set."""
    is_back: bool
    """Whether the new value is the one before that which was not sent."""


@record
class RegisterCut:
    """A value for a register is not in 0 to 65535; its low 16 bits are sent."""

    tick: int
    signal: str
    line: int
    thread: str
    value: int
    sent: int


@record
class ServoStarved:
    """A target of `servoj` came after the arm had come to rest at the one before."""

    tick: int
    line: int
    thread: str
    step_ticks: int
    """Since the target before."""
    t_s: float
    """Time that the call has for its target."""


@record
class EncoderStill:
    """The arm has tracked an encoder that has never counted."""

    tick: int
    line: int
    """That has begun it."""
    thread: str
    encoder: int
    duration_ticks: int
    counting: tuple[int, ...]
    """Encoders that have counted."""


@record
class ForceMetNothing:
    """Force mode has ended, had a force to exert, and nothing has ever pressed against the tool."""

    tick: int
    line: int
    """That has begun it."""
    thread: str
    target: Six
    """N and N m."""
    duration_ticks: int


@record
class CommandRefused:
    """A command has refused a call; the program may catch that."""

    tick: int
    line: int
    thread: str
    command: str
    text: str
    moves: bool
    """Whether it is a command that moves the arm."""


@record
class StoppedAgain:
    """One more of many short moves in a row has begun at rest, where the one before has ended in the same tick."""

    tick: int
    line: int
    thread: str
    stops: int
    way_m: float
    """Between the last two points."""


@record
class OutputBeforePoint:
    """A program has set an output behind a move with a blend radius, before the arm is at its point."""

    tick: int
    signal: str
    line: int
    thread: str
    move_line: int
    left_m: float
    """Way to the point in a straight line."""


Observation = (
    ChannelLeft
    | MotionLeft
    | OddAnswer
    | NumbersDropped
    | ReadingEnded
    | ReadingResumed
    | PeerClosed
    | OtherServer
    | TextBeyondAscii
    | SignalPulsed
    | InputMissed
    | ModbusReadEarly
    | ModbusReadAgain
    | ModbusReplaced
    | RegisterCut
    | ServoStarved
    | EncoderStill
    | ForceMetNothing
    | CommandRefused
    | StoppedAgain
    | OutputBeforePoint
)
