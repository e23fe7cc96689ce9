"""Inputs of a robot from outside, at a tick.

A session is the sequence of (tick, inputs): the journal records it, `replay` feeds it back. An input is plain data;
`origin` names its sender, such as `primary#3`.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.enums import ChannelError
from elitescript.messages.faults import ChannelFault
from elitescript.messages.machine import DisturbInput, MachineRequest
from elitescript.records import record

WORLD: Final = "world"
"""Origin of signal changes by devices beside a robot, followed by `:` and the kind of device."""

RESTART: Final = "restart"
"""Origin of the inputs that give a restarted robot the state of the one before it."""

UNIT_KINDS: Final = ("program", "secondary", "line")
"""Kinds of a unit of script text."""


@record
class RunUnit:
    """A unit of script text: a program replaces the running one, a secondary program runs beside it."""

    origin: str
    kind: str
    """One of `UNIT_KINDS`."""
    text: str
    first_line: int = 1
    """Number of its first line where it came from."""

    def __post_init__(self) -> None:
        if self.kind not in UNIT_KINDS:
            raise ValueError(f"a unit is one of {', '.join(UNIT_KINDS)}, not {self.kind[:40]!r}")


@record
class Do:
    """A request to the machine."""

    origin: str
    request: MachineRequest
    is_answered: bool = False
    """Whether the robot replies with the outcome; if not, a refusal is only a warning."""


@record
class LoadTask:
    """Load a task of the task folder."""

    origin: str
    path: str


@record
class LoadConfiguration:
    """Load a configuration of the configuration folder."""

    origin: str
    path: str


@record
class PlayTask:
    """Start the loaded task, or go on with a paused one."""

    origin: str


@record
class SetVariable:
    """Give a program variable a value while no task runs; the text is a literal."""

    origin: str
    name: str
    value: str


@record
class GetVariable:
    """Ask for the value of a program variable."""

    origin: str
    name: str


@record
class ShowPopup:
    """Open a message window."""

    origin: str
    text: str


@record
class ClosePopup:
    """Close the message window; a thread that waits for it goes on."""

    origin: str


@record
class AddLog:
    """A line for the robot's log."""

    origin: str
    text: str
    is_warning: bool = False
    """Whether something was refused or lost."""


@record
class SetRemote:
    """Switch between remote and local control."""

    origin: str
    is_remote: bool


@record
class Reboot:
    """Stop the arm and start the controller anew: the arm is off, nothing runs."""

    origin: str


@record
class Compiled:
    """A text that the robot has given away to be compiled has come back."""

    origin: str
    number: int
    """Of the text, as the robot has numbered it."""
    failure: str = ""
    """Why there is no result; empty if there is one."""


@record
class Interpret:
    """A line for interpreter mode."""

    origin: str
    text: str
    problem: str = ""
    """Why it cannot be a statement, empty if it can. With a problem, `text` is the beginning of the line only."""


@record
class InterpreterWord:
    """A word for interpreter mode that is handled at once, such as `skipbuffer`."""

    origin: str
    word: str


@record
class Query:
    """A function call of the query port."""

    origin: str
    text: str


@record
class VariablesArrived:
    """Report to the watchdog that a client has sent these RTSI inputs; their values come as `Do(WriteSignal)`."""

    origin: str
    names: tuple[str, ...]


@record
class Lag:
    """How far robot time is behind the wall clock from this tick on, while missed ticks are made up for.

    These ticks take less time than they stand for, so that a peer that sends often enough may seem silent in them.
    """

    origin: str
    ticks: int
    """0 when it has caught up."""


@record
class ChannelOpened:
    """Result of an attempt to connect."""

    channel: int
    is_open: bool
    reason: str = ""
    """Why it is not open, in words."""
    error: ChannelError = ChannelError.OTHER
    """The same as a number."""


@record
class ChannelData:
    """Bytes for a script."""

    channel: int
    data: bytes


@record
class ChannelCredit:
    """Bytes of the script that were sent: as many more may follow; see `outputs.CHANNEL_WINDOW`."""

    channel: int
    size: int


@record
class ChannelClosed:
    """The peer has closed, or the connection broke; the last event of this channel."""

    channel: int
    reason: str = ""
    """Why it broke, in words; empty if the peer has closed."""
    error: ChannelError = ChannelError.RESET
    """The same as a number."""


@record
class AddFault:
    """Add a fault of channels or of an input, from this tick on or later."""

    origin: str
    fault: ChannelFault | DisturbInput


@record
class EndFaults:
    """End all faults of channels and inputs."""

    origin: str


@record
class Debug:
    """A request of a debugger; see `debugger.living` for the texts. `Debugged` answers it, or `Refused`.

    What a debugger asks for acts on programs like any input, so a journal has it, and a replay stops where the session
    has stopped.
    """

    origin: str
    session: str
    """Origin of the debugger; replies to it tell what happens while it is attached."""
    text: str
    """A JSON object."""


ChannelEvent = ChannelOpened | ChannelData | ChannelCredit | ChannelClosed

Input = (
    RunUnit
    | Do
    | LoadTask
    | LoadConfiguration
    | PlayTask
    | SetVariable
    | GetVariable
    | ShowPopup
    | ClosePopup
    | AddLog
    | SetRemote
    | Reboot
    | Compiled
    | Interpret
    | InterpreterWord
    | Query
    | VariablesArrived
    | Lag
    | ChannelOpened
    | ChannelData
    | ChannelCredit
    | ChannelClosed
    | AddFault
    | EndFaults
    | Debug
)
