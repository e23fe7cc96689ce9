"""Stepping through a program: one debugged run for each worker process. Plain values in and out."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, Final, cast

from elitescript.debugger.api import Change, Frame, LineBreakpoint, Output, Scope, Stop, Variable
from elitescript.debugger.session import DebugSession
from elitescript.debugger.source import ProgramSource
from elitescript.debugger.values import more
from elitescript.errors import DebugError, UsageError
from elitescript.kernel.options import Number, Whole, accepted
from elitescript.language.text.source import SourceFile
from elitescript.mcp.runs import options_of, source_of_request, start_values, until_of, with_nodes, world_of

FRAMES_MAX: Final = 20
VARIABLES_MAX: Final = 100
OUTPUTS_MAX: Final = 50
CHANGES_MAX: Final = 200
TEXT_MAX: Final = 500
"""Characters of a message."""
TIME: Final = Number(0.0, 1e9, "s")
NUMBER: Final = Whole(1)
"""Of lines and threads."""
THREAD_STEPS: Final = {
    "next": DebugSession.next,
    "in": DebugSession.step_in,
    "out": DebugSession.step_out,
    "back": DebugSession.step_back,
}
"""Moves of one thread."""
RUNS: Final = {"continue": DebugSession.resume, "reverse": DebugSession.reverse}
"""Moves of the whole run."""

GOES_WITH: Final = {"thread": tuple(THREAD_STEPS), "time_s": ("to_time",), "line": ("last_pass",)}
"""Arguments that belong to some moves alone."""


class Steps:
    """The debugged run of a worker."""

    def __init__(self) -> None:
        self._session: DebugSession | None = None
        self._outputs: list[Output] = []
        self._source = SourceFile("", "")

    def start(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Begin to debug a program; stop before its first statement."""
        levels, presets = start_values(request)
        until_s = until_of(request)
        self._source = source_of_request(request)
        debugged = ProgramSource(
            request["name"],
            text=request["text"],
            source=self._source,
            world=partial(world_of, request),
            levels=levels,
            presets=presets,
            until_s=until_s,
            **options_of(request),
        )
        self._session = DebugSession(debugged, self._outputs.append, forks=False)
        return self._stopped(self._session.start(stop_on_entry=True))

    def go(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Let the run go on or back; return where it stops."""
        session, how = self._debugged, request["how"]
        for name, fitting in GOES_WITH.items():
            if request.get(name) is not None and how not in fitting:
                raise UsageError(f"{name} goes with {', '.join(fitting)}, not with {how}")
        try:
            if how in THREAD_STEPS:
                return self._stopped(THREAD_STEPS[how](session, _thread(request, session)))
            if how in RUNS:
                return self._stopped(RUNS[how](session))
            if how == "to_time":
                return self._stopped(session.run_to_time(_given(request, "time_s", TIME)))
            if how == "last_pass":
                return self._stopped(session.last_pass(_given(request, "line", NUMBER)))
        except DebugError as error:
            raise UsageError(str(error)) from error
        ways = ", ".join((*THREAD_STEPS, *RUNS, "to_time", "last_pass"))
        raise UsageError(f"how: {how!r} is none of {ways}")

    def breakpoints(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Replace the breakpoints of lines; return where they are."""
        wanted = [
            LineBreakpoint(accepted(NUMBER, item["line"], "line"), condition=item.get("condition") or "")
            for item in request["lines"]
        ]
        try:
            states = self._debugged.set_breakpoints(wanted)
        except DebugError as error:
            raise UsageError(str(error)) from error
        rows = [{"line": state.line, "set": state.verified, "why": state.message} for state in states]
        return {"breakpoints": with_nodes(rows, self._source)}

    def evaluate(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Return the value of an expression at the present stop; nothing is changed."""
        session = self._debugged
        try:
            frames = session.stack(_thread(request, session))
            found = session.evaluate(request["expression"], frames[0].id if frames else 0)
        except DebugError as error:
            raise UsageError(str(error)) from error
        return {"value": found.value, "type": found.type}

    def history(self, request: Mapping[str, Any]) -> dict[str, Any]:
        """Return every change of a variable or signal so far."""
        try:
            changes = self._debugged.history(request["name"], function=request.get("function") or "")
        except DebugError as error:
            raise UsageError(str(error)) from error
        return {
            "changes": [_change(change) for change in changes[-CHANGES_MAX:]],
            "changes_left_out": max(0, len(changes) - CHANGES_MAX),
        }

    @property
    def _debugged(self) -> DebugSession:
        if self._session is None:
            raise UsageError("no program is debugged here")
        return self._session

    def _stopped(self, stop: Stop) -> dict[str, Any]:
        """Return a stop with everything that there is to see."""
        session = self._debugged
        said, self._outputs[:] = self._outputs[-OUTPUTS_MAX:], []
        state, threads = session.state(), session.threads()
        thread = stop.thread or (threads[0].id if threads else 0)
        frames = session.stack(thread)[:FRAMES_MAX] if thread else ()
        scopes = session.scopes(frames[0].id if frames else 0)
        found = {
            "reason": stop.reason,
            "text": stop.text,
            "time_s": stop.time_s,
            "thread": thread,
            "result": stop.result,
            "threads": [
                {
                    "id": item.id,
                    "name": item.name,
                    "line": item.line,
                    "waits_for": item.waits_for,
                    "because": item.because,
                }
                for item in threads
            ],
            "stack": [_frame(frame) for frame in frames],
            "variables": {scope.name: self._values(scope) for scope in scopes},
            "joints": list(state.joints),
            "tcp_pose": list(state.tcp_pose),
            "output": [{"t": item.time_s, "line": item.line, "text": _short(item.text)} for item in said],
        }
        return cast("dict[str, Any]", with_nodes(found, self._source))

    def _values(self, scope: Scope) -> dict[str, str]:
        found: tuple[Variable, ...] = self._debugged.variables(scope.reference, count=VARIABLES_MAX)
        left_out = scope.count - len(found)
        return {variable.name: variable.value for variable in found} | ({"…": more(left_out)} if left_out else {})


def _given(request: Mapping[str, Any], name: str, kind: Number | Whole) -> Any:
    if request.get(name) is None:
        raise UsageError(f"{name} must be given for {request['how']!r}")
    return accepted(kind, request[name], name)


def _thread(request: Mapping[str, Any], session: DebugSession) -> int:
    """Return the thread that a request names; the one that stopped if it names none."""
    thread = request.get("thread")
    return session.stop.thread or 1 if thread is None else int(accepted(NUMBER, thread, "thread"))


def _frame(frame: Frame) -> dict[str, Any]:
    return {"function": frame.name, "line": frame.line}


def _change(change: Change) -> dict[str, Any]:
    return {
        "t": change.time_s,
        "line": change.line,
        "by": change.thread_name,
        "old": change.old,
        "new": change.new,
    }


def _short(text: str) -> str:
    return text if len(text) <= TEXT_MAX else f"{text[:TEXT_MAX]}{more(len(text) - TEXT_MAX)}"
