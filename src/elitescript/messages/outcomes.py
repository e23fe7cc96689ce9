"""Outcomes of requests, as a `Reply` carries them."""

from __future__ import annotations

from elitescript.messages.enums import DiscardReason
from elitescript.records import record


@record
class Done:
    """The request was carried out."""


@record
class Refused:
    """The request was not carried out."""

    reason: str


@record
class ShownValue:
    """The value that was asked for."""

    text: str
    """As `repr` writes it."""


@record
class RegistersRead:
    """Registers, read right after the request has written others."""

    values: tuple[int, ...]
    """0 to 65535 each."""


@record
class StatementAccepted:
    """A statement of interpreter mode will run."""

    number: int
    """From 1 in each program."""
    text: str


@record
class StatementDiscarded:
    """A statement of interpreter mode will not run."""

    reason: DiscardReason
    text: str
    trace: str = ""
    """Why and where it does not compile."""


@record
class StatementNumber:
    """The number that a word of interpreter mode asks for."""

    word: str
    number: int


@record
class SessionState:
    """Whether a session of interpreter mode runs."""

    is_running: bool


@record
class QueryFailed:
    """The query has no value."""

    is_compiled: bool
    """False if it does not compile; True if it raised an exception, is not allowed or took too long."""
    why: str = ""
    """The reason, which the port does not send; empty if the robot was restarted or too many wait."""


@record
class Debugged:
    """The answer to a request of a debugger, or something that happens while it is attached."""

    text: str
    """A JSON object."""


InterpreterOutcome = StatementAccepted | StatementDiscarded | StatementNumber | SessionState
"""Outcome of a line of interpreter mode."""

Outcome = (
    Done
    | Refused
    | ShownValue
    | RegistersRead
    | StatementAccepted
    | StatementDiscarded
    | StatementNumber
    | SessionState
    | QueryFailed
    | Debugged
)
