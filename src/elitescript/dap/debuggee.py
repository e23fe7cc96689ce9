"""What can be debugged: a program that is launched, or a robot that lives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol, TypeAlias

from elitescript.dap.messages import Arguments
from elitescript.debugger.api import BreakpointState, LineBreakpoint, Place
from elitescript.debugger.session import DebugSession

if TYPE_CHECKING:
    # Few sessions attach.
    from elitescript.services.control.debugging import ServedSession

Session: TypeAlias = "DebugSession | ServedSession"


class Debuggee(Protocol):
    """Something that is debugged, with its texts.

    Attributes:
        name: for people.
        start_method: `launch` or `attach`.
        stop_on_entry: stop before the first statement.
        stops_on_end: stay when the program has ended.
        session: runs it, or speaks to what runs it.
    """

    @property
    def name(self) -> str: ...

    @property
    def start_method(self) -> str: ...

    @property
    def stop_on_entry(self) -> bool: ...

    @property
    def stops_on_end(self) -> bool: ...

    @property
    def session(self) -> Session: ...

    def texts(self) -> list[str]:
        """Return the names of its texts."""

    def text_of(self, name: str) -> str:
        """Return a text by its name."""

    def set_lines(self, source: Arguments, requests: Sequence[LineBreakpoint]) -> tuple[BreakpointState, ...] | None:
        """Replace the breakpoints of one text; None if that is none that can run."""

    def node(self, name: str, line: int) -> str:
        """Return the node of a graphical program to which a line of a text belongs; empty: it belongs to none."""

    def located(self, source: Arguments, line: int) -> tuple[str, int] | None:
        """Return the name of the text, and the line there, that a line of a `Source` of a client is."""

    def places(self, source: Arguments, line: int, end_line: int) -> tuple[Place, ...]:
        """Return the statements that begin in lines of a text, the last line included."""
