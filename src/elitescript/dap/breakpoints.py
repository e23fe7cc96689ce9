"""The breakpoints that a client has set: kept over restarts, under numbers of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

from elitescript.dap.client import ClientSettings
from elitescript.dap.debuggee import Debuggee
from elitescript.dap.messages import Body
from elitescript.debugger.api import STEP, BreakpointState, FunctionBreakpoint, Stop
from elitescript.debugger.session import DebugSession
from elitescript.records import replace

LINES: Final = "lines of "
FUNCTIONS: Final = "functions"
DATA: Final = "data"
"""Keys of groups; that of lines is followed by the text's path."""

Apply = Callable[[Debuggee, Sequence[Any]], tuple[BreakpointState, ...] | None]


class Breakpoints:
    """Gives each breakpoint a number that stays the same when others come and go, and over restarts.

    Attributes:
        filters: of exceptions.
    """

    __slots__ = ("_groups", "_last", "filters")

    def __init__(self) -> None:
        self._groups: dict[str, _Group] = {}
        """What replaces each other, by kind and text."""
        self._last = 0
        self.filters: list[str] = []

    def set(
        self, debuggee: Debuggee, client: ClientSettings, key: str, requests: Sequence[Any], apply: Apply
    ) -> list[Body] | None:
        """Replace the breakpoints of a group; return what the client is told of each.

        Args:
            debuggee: what they are for.
            client: that sets them.
            key: of the group.
            requests: records of `debugger.api`.
            apply: sets them; its result is None if they cannot be set at all, and so is this one then.
        """
        group = self._groups.setdefault(key, _Group(apply))
        group.apply = apply
        known, group.rows = group.rows, []
        for request in requests:
            row = next((row for row in known if row.request == request), None)
            if row is None:
                self._last += 1
                row = _Row(self._last, request)
            else:
                known.remove(row)
            group.rows.append(row)
        return group.set(debuggee, client)

    def renew(self, debuggee: Debuggee, client: ClientSettings) -> list[Body]:
        """Set everything again, for a new run; return what the client is told of each."""
        return [body for group in self._groups.values() for body in group.set(debuggee, client) or ()]

    def changed(self, state: BreakpointState, client: ClientSettings) -> list[Body]:
        """Return what the client is told of a breakpoint that has changed."""
        rows = [row for group in self._groups.values() for row in group.rows if row.theirs == state.id]
        return [_body(row.number, state, client) for row in rows]

    def numbers(self, hits: Sequence[int]) -> list[int]:
        """Return our numbers of the breakpoints of a run."""
        return sorted(row.number for group in self._groups.values() for row in group.rows if row.theirs in hits)

    def step_into(self, session: DebugSession, thread: int, name: str) -> Stop:
        """Go on to the begin of a function that the present statement of a thread calls, or to its next statement."""
        group = self._groups.get(FUNCTIONS)
        rows = group.rows if group else []
        requests = [row.request for row in rows]
        *_, wanted = session.set_function_breakpoints([*requests, FunctionBreakpoint(name)], are_known=True)
        try:
            stop = session.next(thread)
            while stop.hits == (wanted.id,) and stop.thread != thread:
                # Another thread has called it.
                stop = session.next(thread)
        finally:
            for row, state in zip(rows, session.set_function_breakpoints(requests, are_known=True), strict=True):
                row.theirs = state.id
        return replace(stop, reason=STEP, hits=()) if stop.hits == (wanted.id,) else stop


class _Row:
    __slots__ = ("number", "request", "theirs")

    def __init__(self, number: int, request: Any) -> None:
        self.number = number
        self.request = request
        self.theirs = 0
        """Number in the debugged run."""


class _Group:
    __slots__ = ("apply", "rows")

    def __init__(self, apply: Apply) -> None:
        self.apply = apply
        self.rows: list[_Row] = []

    def set(self, debuggee: Debuggee, client: ClientSettings) -> list[Body] | None:
        states = self.apply(debuggee, [row.request for row in self.rows])
        if states is None:
            return None
        for row, state in zip(self.rows, states, strict=True):
            row.theirs = state.id
        return [_body(row.number, state, client) for row, state in zip(self.rows, states, strict=True)]


def _body(number: int, state: BreakpointState, client: ClientSettings) -> Body:
    body: Body = {"id": number, "verified": state.verified}
    if state.message:
        body["message"] = state.message
    body.update(client.place(state.line, state.column, state.end_line, state.end_column))
    return body
