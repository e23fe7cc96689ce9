"""What comes in from outside at a tick: everything that a session does to a robot.

A session is the sequence of (tick, inputs). The journal records it, `replay` feeds it back. Each input carries what
it needs and nothing live; `origin` names who sent it, such as `primary#3`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from elitescript.messages.machine import MachineRequest

WORLD: Final = "world"
"""Origin of what the devices beside a robot do to its signals, followed by `:` and the kind of device."""

RESTART: Final = "restart"
"""Origin of the inputs that give a fresh robot the state of the one before it."""

UNIT_KINDS: Final = ("program", "secondary", "line")
"""What a unit of script text is."""


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class Do:
    """A request to the machine."""

    origin: str
    request: MachineRequest
    is_answered: bool = False
    """Whether the robot is to reply what came of it; if not, a refusal is a warning alone."""


@dataclass(frozen=True, slots=True)
class LoadTask:
    """Load a task of the task folder."""

    origin: str
    path: str


@dataclass(frozen=True, slots=True)
class LoadConfiguration:
    """Load a configuration of the configuration folder."""

    origin: str
    path: str


@dataclass(frozen=True, slots=True)
class PlayTask:
    """Start the loaded task, or go on with a paused one."""

    origin: str


@dataclass(frozen=True, slots=True)
class SetVariable:
    """Give a program variable a value while no task runs; the text is a literal."""

    origin: str
    name: str
    value: str


@dataclass(frozen=True, slots=True)
class GetVariable:
    """Ask for the value of a program variable."""

    origin: str
    name: str


@dataclass(frozen=True, slots=True)
class ShowPopup:
    """Open a message window."""

    origin: str
    text: str


@dataclass(frozen=True, slots=True)
class ClosePopup:
    """Close the message window; a thread that waits for it goes on."""

    origin: str


@dataclass(frozen=True, slots=True)
class AddLog:
    """A line for the robot's log."""

    origin: str
    text: str
    is_warning: bool = False
    """Whether something was refused or lost."""


@dataclass(frozen=True, slots=True)
class SetRemote:
    """Switch between remote and local control."""

    origin: str
    is_remote: bool


@dataclass(frozen=True, slots=True)
class Reboot:
    """Stop the arm and start the controller anew: the arm is off, nothing runs."""

    origin: str


@dataclass(frozen=True, slots=True)
class Interpret:
    """A line for interpreter mode."""

    origin: str
    text: str
    problem: str = ""
    """Why it cannot be a statement, whatever it says; empty if it can. The text is its beginning then."""


@dataclass(frozen=True, slots=True)
class InterpreterWord:
    """A word for interpreter mode that does not wait its turn, such as `skipbuffer`."""

    origin: str
    word: str


@dataclass(frozen=True, slots=True)
class Query:
    """A function call of the query port."""

    origin: str
    ident: str
    text: str


@dataclass(frozen=True, slots=True)
class VariablesArrived:
    """A client has sent these RTSI inputs; their values come as `Do(WriteSignal)`. For the watchdog."""

    origin: str
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Lag:
    """How far robot time is behind the wall clock from this tick on, while missed ticks are made up for.

    What has arrived by then came over a longer time than the ticks take that are made up for: a peer that sends often
    enough may seem silent in them.
    """

    origin: str
    ticks: int
    """0: it is not behind any more."""


@dataclass(frozen=True, slots=True)
class ChannelOpened:
    """The end of an attempt to connect."""

    channel: int
    is_open: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class ChannelData:
    """Bytes for a script."""

    channel: int
    data: bytes


@dataclass(frozen=True, slots=True)
class ChannelCredit:
    """So many bytes that the script sent have left: as many more may follow; see `outputs.CHANNEL_WINDOW`."""

    channel: int
    size: int


@dataclass(frozen=True, slots=True)
class ChannelClosed:
    """The peer has closed, or the connection broke. Nothing of this channel comes any more."""

    channel: int
    reason: str = ""


@dataclass(frozen=True, slots=True)
class AddFault:
    """Something goes wrong on channels from now on, or nothing any more; see `devices.channels.faults`."""

    origin: str
    text: str
    """The fault as `fault_text` writes it; empty to end all faults."""


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
)
