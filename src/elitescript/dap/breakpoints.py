"""The breakpoints that a client has set: kept over restarts, under numbers of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from elitescript.dap.client import ClientSettings
from elitescript.dap.messages import Body
from elitescript.debugger.api import (
    STEP,
    BreakpointState,
    DataBreakpoint,
    FunctionBreakpoint,
    LineBreakpoint,
    Stop,
)
from elitescript.debugger.session import DebugSession
from elitescript.records import replace

Request = TypeVar("Request", LineBreakpoint, FunctionBreakpoint, DataBreakpoint)


class Breakpoints:
    """Gives each breakpoint a number that stays the same when others come and go, and over restarts.

    Attributes:
        filters: of exceptions.
    """

    __slots__ = ("_last", "_numbers", "_requests", "filters")

    def __init__(self) -> None:
        self._requests: dict[type, list[tuple[int, Any]]] = {}
        """What was asked for, by kind, with numbers."""
        self._numbers: dict[type, dict[int, int]] = {}
        """Our numbers by those of the debugged run, by kind."""
        self._last = 0
        self.filters: list[str] = []

    def set(
        self, session: DebugSession, client: ClientSettings, kind: type[Request], requests: Sequence[Request]
    ) -> list[Body]:
        """Replace the breakpoints of a kind; return what the client is told of each."""
        known = list(self._requests.get(kind, ()))
        numbered = []
        for request in requests:
            place = next((at for at, (_, one) in enumerate(known) if one == request), None)
            if place is None:
                self._last += 1
                numbered.append((self._last, request))
            else:
                numbered.append(known.pop(place))
        self._requests[kind] = numbered
        return self._apply(session, client, kind)

    def renew(self, session: DebugSession, client: ClientSettings) -> list[Body]:
        """Set everything again, for a new run; return what the client is told of each."""
        self._numbers.clear()
        return [body for kind in self._requests for body in self._apply(session, client, kind)]

    def numbers(self, hits: Sequence[int]) -> list[int]:
        """Return our numbers of the breakpoints of a run."""
        known = {theirs: ours for numbers in self._numbers.values() for theirs, ours in numbers.items()}
        return sorted(known[hit] for hit in hits if hit in known)

    def step_into(self, session: DebugSession, thread: int, name: str) -> Stop:
        """Go on to the begin of a function that the present statement of a thread calls, or to its next statement."""
        requests = [request for _, request in self._requests.get(FunctionBreakpoint, ())]
        *_, wanted = session.set_function_breakpoints([*requests, FunctionBreakpoint(name)])
        try:
            stop = session.next(thread)
            while stop.hits == (wanted.id,) and stop.thread != thread:
                # Another thread has called it.
                stop = session.next(thread)
        finally:
            states = session.set_function_breakpoints(requests)
            self._note(FunctionBreakpoint, states)
        return replace(stop, reason=STEP, hits=()) if stop.hits == (wanted.id,) else stop

    def _note(self, kind: type, states: Sequence[BreakpointState]) -> None:
        numbers = [number for number, _ in self._requests.get(kind, ())]
        self._numbers[kind] = {state.id: number for number, state in zip(numbers, states, strict=True)}

    def _apply(self, session: DebugSession, client: ClientSettings, kind: type) -> list[Body]:
        numbered = self._requests[kind]
        requests = [request for _, request in numbered]
        if kind is LineBreakpoint:
            states = session.set_breakpoints(requests)
        elif kind is FunctionBreakpoint:
            states = session.set_function_breakpoints(requests)
        else:
            states = session.set_data_breakpoints(requests)
        self._note(kind, states)
        return [_body(number, state, client) for (number, _), state in zip(numbered, states, strict=True)]


def _body(number: int, state: BreakpointState, client: ClientSettings) -> Body:
    body: Body = {"id": number, "verified": state.verified}
    if state.message:
        body["message"] = state.message
    body.update(client.place(state.line, state.column, state.end_line, state.end_column))
    return body
