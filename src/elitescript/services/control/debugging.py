"""Debugs the programs of a served robot over its `ctl` socket, with the methods of `DebugSession` but for going back.

Requests, answers and events are lines of JSON; see *debug* in `docs/reference/ports.md`, and `debugger.living`.
"""

from __future__ import annotations

import contextlib
import json
import queue
import socket
import threading
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final, TypeVar

from elitescript.debugger import wire
from elitescript.debugger.api import (
    BreakpointState,
    DataBreakpoint,
    DataInfo,
    Frame,
    FunctionBreakpoint,
    LineBreakpoint,
    Output,
    Place,
    Scope,
    State,
    Stop,
    ThreadInfo,
    Variable,
)
from elitescript.debugger.living import LivingDebugger, SourceInfo
from elitescript.debugger.living_breakpoints import digest_of
from elitescript.errors import DebugError, UsageError
from elitescript.untrusted.files import ADDRESS, read_bytes
from elitescript.untrusted.json_text import json_value

Result = TypeVar("Result")

ANSWER_S: Final = 10.0
"""How long an answer is waited for; longer than the server waits for a tick."""


class ServedSession:
    """A debugger of a served robot. Methods may be called from any thread, but not from the two listeners.

    Args:
        path: of the `ctl` socket, or of the file that stands for it.
        on_output: receives what the programs say, in a thread of this object.
        on_event: receives every other event as it arrives, in that thread.

    Raises:
        UsageError: no controller is served there.
    """

    def __init__(
        self,
        path: str | Path,
        on_output: Callable[[Output], None] | None = None,
        on_event: Callable[[str, dict[str, Any]], None] | None = None,
    ) -> None:
        self._on_output = on_output
        self._on_event = on_event
        self._socket, self._token = _connected(Path(path))
        self._lock = threading.Lock()
        self._waiting: deque[queue.SimpleQueue[dict[str, Any]]] = deque()
        self._stops: queue.SimpleQueue[Stop | None] = queue.SimpleQueue()
        self._stop: Stop | None = None
        self._is_open = True
        self._reader = threading.Thread(target=self._read, name="debugged robot", daemon=True)
        self._reader.start()

    # ---------------------------------------------------------------- going on

    def start(self, *, stop_on_entry: bool = False, no_debug: bool = False) -> Stop:
        """Wait for the first stop; with `stop_on_entry` pause what runs, or what runs next."""
        self._ask(LivingDebugger.attach)
        if stop_on_entry and not no_debug:
            self._ask(LivingDebugger.pause)
        return self.wait_for_stop()

    def proceed(self, how: str, thread: int = 0) -> None:
        """Go on without waiting for the next stop.

        Args:
            how: `resume`, `next`, `step_in` or `step_out`.
            thread: that takes the step; not used by `resume`.

        Raises:
            DebugError: the program does not stand, or may not go on.
        """
        while not self._stops.empty():
            self._stops.get()
        self._stop = None
        self._ask(getattr(LivingDebugger, how), **({} if how == "resume" else {"thread": thread}))

    def wait_for_stop(self) -> Stop:
        """Return the next stop that was not returned yet; programs may end and begin before.

        Raises:
            DebugError: the connection has ended.
        """
        stop = self._stops.get()
        if stop is None:
            self._stops.put(None)
            raise DebugError("the connection to the robot has ended")
        return stop

    def resume(self) -> Stop:
        """Go on to the next stop."""
        self.proceed("resume")
        return self.wait_for_stop()

    def next(self, thread: int) -> Stop:
        """Go on until a thread is at its next statement of the same call or of a caller."""
        self.proceed("next", thread)
        return self.wait_for_stop()

    def step_in(self, thread: int) -> Stop:
        """Go on to the next statement of a thread, also in a function that it calls."""
        self.proceed("step_in", thread)
        return self.wait_for_stop()

    def step_out(self, thread: int) -> Stop:
        """Go on until a thread has left its present function."""
        self.proceed("step_out", thread)
        return self.wait_for_stop()

    def pause(self) -> None:
        """Pause the task; if none runs, stop before the first statement of the next program."""
        self._ask(LivingDebugger.pause)

    def close(self, *, leaves_paused: bool = False, terminates: bool = False) -> None:
        """Remove all breakpoints, let a stopped program go on, and hang up.

        Args:
            leaves_paused: let a stopped program stay paused.
            terminates: stop the task.
        """
        with contextlib.suppress(DebugError):
            if terminates:
                self._order("stop")
            self._ask(LivingDebugger.detach, leaves_paused=leaves_paused)
        self._is_open = False
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        if threading.current_thread() is not self._reader:
            self._reader.join(ANSWER_S)
        self._socket.close()

    # ---------------------------------------------------------------- breakpoints

    def set_breakpoints(
        self, requests: Sequence[LineBreakpoint], *, path: str = "", text: str = ""
    ) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of lines in one text.

        Args:
            requests: in their order.
            path: of the file: a program of the task folder by that name has them.
            text: of the file: a program that arrived with the same text has them, too.
        """
        digest = digest_of(text) if text else ""
        return self._ask(LivingDebugger.set_breakpoints, requests=_short(requests), path=path, digest=digest)

    def set_function_breakpoints(self, requests: Sequence[FunctionBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the breakpoints of functions and commands."""
        return self._ask(LivingDebugger.set_function_breakpoints, requests=_short(requests))

    def set_data_breakpoints(self, requests: Sequence[DataBreakpoint]) -> tuple[BreakpointState, ...]:
        """Replace the data breakpoints."""
        return self._ask(LivingDebugger.set_data_breakpoints, requests=_short(requests))

    def set_exception_filters(self, filters: Sequence[str]) -> None:
        """Replace the filters: `alarm`, `warning`."""
        self._ask(LivingDebugger.set_exception_filters, filters=list(filters))

    def breakpoint_locations(
        self, line: int, end_line: int = 0, *, path: str = "", text: str = ""
    ) -> tuple[Place, ...]:
        """Return the statements that begin in lines of a text that is known, the last line included."""
        digest = digest_of(text) if text else ""
        return self._ask(LivingDebugger.breakpoint_locations, line=line, end_line=end_line, path=path, digest=digest)

    def data_breakpoint_info(self, name: str, reference: int = 0, frame: int = 0) -> DataInfo:
        """Return what a data breakpoint can watch."""
        return self._ask(LivingDebugger.data_breakpoint_info, name=name, reference=reference, frame=frame)

    # ---------------------------------------------------------------- looking

    @property
    def stop(self) -> Stop | None:
        """The present stop; None while programs may run."""
        return self._stop

    def threads(self) -> tuple[ThreadInfo, ...]:
        """Return the script threads in the order of their start."""
        return self._ask(LivingDebugger.threads)

    def stack(self, thread: int) -> tuple[Frame, ...]:
        """Return the calls of a thread, the innermost one first."""
        return self._ask(LivingDebugger.stack, thread=thread)

    def scopes(self, frame: int) -> tuple[Scope, ...]:
        """Return the scopes of a frame: `Locals`, `Globals`, `Robot`."""
        return self._ask(LivingDebugger.scopes, frame=frame)

    def variables(self, reference: int, *, kind: str = "", start: int = 0, count: int = 0) -> tuple[Variable, ...]:
        """Return what a scope or a value holds."""
        return self._ask(LivingDebugger.variables, reference=reference, kind=kind, start=start, count=count)

    def evaluate(self, text: str, frame: int = 0, *, may_change: bool = False) -> Variable:
        """Return the value of an expression; with `may_change` it may change the program and the robot."""
        return self._ask(LivingDebugger.evaluate, text=text, frame=frame, may_change=may_change)

    def set_variable(self, reference: int, name: str, text: str) -> Variable:
        """Set a child of a scope or of a value to the value of an expression."""
        return self._ask(LivingDebugger.set_variable, reference=reference, name=name, text=text)

    def set_expression(self, target: str, text: str, frame: int = 0) -> Variable:
        """Assign the value of an expression to a variable, an item or a signal."""
        return self._ask(LivingDebugger.set_expression, target=target, text=text, frame=frame)

    def set_signal(self, name: str, text: str) -> Variable:
        """Set an input, output or register of the robot."""
        return self._ask(LivingDebugger.set_signal, name=name, text=text)

    def state(self) -> State:
        """Return the robot at this moment."""
        return self._ask(LivingDebugger.state)

    def sources(self) -> tuple[SourceInfo, ...]:
        """Return the texts of programs that run or ran last, the newest first."""
        return self._ask(LivingDebugger.sources)

    def source_text(self, name: str) -> str:
        """Return the text of a program, by the name that its frames have."""
        parts: list[str] = []
        size = 1
        while (start := sum(map(len, parts))) < size:
            part = self._ask(LivingDebugger.source_text, name=name, start=start)
            parts.append(part.text)
            size = part.size
            if not part.text:
                break
        return "".join(parts)

    # ---------------------------------------------------------------- internal

    def _ask(self, method: Callable[..., Result], **arguments: Any) -> Result:
        """Have the robot's debugger call a method; return its result."""
        answer = self._order("debug", do=method.__name__, **arguments)
        if not isinstance(answer.get("result"), dict):
            raise DebugError(str(answer.get("text") or "the robot has not answered"))
        result: Result = wire.result_of(method, answer["result"].get("result"))
        return result

    def _order(self, verb: str, **values: Any) -> dict[str, Any]:
        record = {"verb": verb, "arguments": [], "values": values, **({"token": self._token} if self._token else {})}
        answered: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        try:
            with self._lock:
                if not self._is_open:
                    raise DebugError("the connection to the robot has ended")
                self._waiting.append(answered)
                self._socket.sendall(json.dumps(record).encode() + b"\n")
            answer = answered.get(timeout=ANSWER_S)
        except (OSError, queue.Empty):
            raise DebugError("the robot does not answer") from None
        if not answer.get("ok"):
            raise DebugError(str(answer.get("error", "")).removeprefix("debug: "))
        return answer

    def _read(self) -> None:
        with contextlib.suppress(OSError, ValueError), self._socket.makefile("rb") as lines:
            for line in lines:
                message = json_value(line, depth_max=None)
                if "event" in message:
                    with contextlib.suppress(DebugError):
                        self._take_event(str(message.pop("event")), message)
                else:
                    self._waiting.popleft().put(message)
        with self._lock:
            self._is_open = False
            waiting, self._waiting = self._waiting, deque()
        for answered in waiting:
            answered.put({"ok": False, "error": "the connection to the robot has ended"})
        self._stops.put(None)

    def _take_event(self, kind: str, content: dict[str, Any]) -> None:
        if kind == "output":
            if self._on_output is not None:
                self._on_output(wire.read(Output, content.get("output")))
            return
        if kind == "stopped":
            self._stop = wire.read(Stop, content.get("stop"))
            self._stops.put(self._stop)
        elif kind in ("continued", "ended"):
            self._stop = None
        if self._on_event is not None:
            self._on_event(kind, content)


def _short(requests: Sequence[Any]) -> list[dict[str, Any]]:
    """Return breakpoints without what is at its default: a request is one line of limited length."""
    return [{name: value for name, value in wire.written(item).items() if value not in ("", 0)} for item in requests]


def _connected(path: Path) -> tuple[socket.socket, str]:
    """Return a connection to the `ctl` socket, and the token that its requests need.

    Raises:
        UsageError: no controller is served there.
    """
    connection: socket.socket | None = None
    try:
        if hasattr(socket, "AF_UNIX") and path.suffix != ".json":
            connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            connection.connect(str(path))
            return connection, ""
        address = json_value(read_bytes(path, ADDRESS))
        return socket.create_connection(("127.0.0.1", address["port"])), str(address["token"])
    except (OSError, ValueError, KeyError):
        if connection is not None:
            connection.close()
        raise UsageError(f"no controller is served here ({path}); start one with `elitescript serve`") from None
