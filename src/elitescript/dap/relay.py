"""Passes messages between one client and the process that debugs (`dap.worker`).

Every request gets exactly one answer, whatever that process does: what it has not answered in time, or when it ends, is
answered here with an error, and an answer that comes later is dropped. No I/O in here; times are given.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.dap.framing import Decoder, Malformed, framed
from elitescript.dap.messages import (
    CANCELLED,
    ENDED,
    MALFORMED,
    Arguments,
    Message,
    RequestError,
    error_response,
    event,
    response,
    shown,
)
from elitescript.records import NamedTuple

ANSWER_S: Final = 10.0
"""Time for an answer; then it is an error (*assumed*: longer than anything that is asked of a stopped program)."""
END_S: Final = 1.0
"""Time for the answer to `disconnect` and `terminate`; then the process is killed."""
PAUSE_S: Final = 2.0
"""Time from `pause` to a stop; then the client is told that a call does not return."""
PENDING_MAX: Final = 1000
"""Requests that wait for an answer; more are refused."""

CRASHED: Final = 1
"""Exit code of a debugged program whose process crashed: as of `elitescript run`."""

_OPENING: Final = ("launch", "attach")
_CLOSING: Final = ("disconnect", "terminate")


class WorkerLink(Protocol):
    """The process that debugs, as the relay sees it."""

    def send(self, message: Message) -> None:
        """Send a message; never waits."""

    def kill(self) -> None:
        """End it at once; nothing of it is reported any more."""


class _Pending(NamedTuple):
    """A request that is not answered yet."""

    seq: int
    command: str
    deadline_s: float | None


class Relay:
    """Connects one client with one process that debugs.

    Args:
        write: sends bytes to the client.
        start: starts the process; called for the first request. Raises OSError.

    Attributes:
        is_over: whether the session is over: the client has disconnected, or its input has ended.
    """

    __slots__ = (
        "_decoder",
        "_has_session",
        "_is_terminated",
        "_last",
        "_pause_deadline_s",
        "_pending",
        "_sequence",
        "_start",
        "_worker",
        "_worker_end",
        "_write",
        "is_over",
    )

    def __init__(self, write: Callable[[bytes], object], start: Callable[[], WorkerLink]) -> None:
        self._write = write
        self._start = start
        self._decoder = Decoder()
        self._worker: WorkerLink | None = None
        self._worker_end = ""
        """Why there is no process any more; empty while there is one, and before."""
        self._pending: dict[int, _Pending] = {}
        """Requests under way, by the number that they have between relay and process."""
        self._last = 0
        self._sequence = 0
        self._has_session = False
        self._is_terminated = False
        self._pause_deadline_s: float | None = None
        self.is_over = False

    # ---------------------------------------------------------------- client

    def receive(self, data: bytes, now_s: float) -> None:
        """Take bytes of the client; an end of its input is `close`."""
        for message in self._decoder.feed(data):
            if self.is_over:
                return
            if isinstance(message, Malformed):
                self._send(error_response(0, "", RequestError(MALFORMED, f"no message: {message.text}")))
            else:
                self._receive(message, now_s)

    def close(self) -> None:
        """End the session because the client is gone."""
        self.is_over = True
        self._drop_worker()

    def _receive(self, message: Message, now_s: float) -> None:
        seq, kind, command = message.get("seq"), message.get("type"), message.get("command")
        number = seq if isinstance(seq, int) and not isinstance(seq, bool) and 0 <= seq < 1 << 53 else 0
        name = command if isinstance(command, str) else ""
        try:
            if number == 0 or number != seq:
                raise RequestError(MALFORMED, f"seq must be a whole number above 0, got {shown(seq)}")
            if kind != "request":
                raise RequestError(MALFORMED, f"type must be 'request', got {shown(kind)}")
            if not name or name != command:
                raise RequestError(MALFORMED, f"command must be a text, got {shown(command)}")
            if name == "cancel":
                self._cancel(number, Arguments(message.get("arguments"), name))
            else:
                self._pass_on(number, name, message.get("arguments"), now_s)
        except RequestError as error:
            self._send(error_response(number, name, error))

    def _pass_on(self, seq: int, command: str, arguments: Any, now_s: float) -> None:
        if self._worker is None:
            if self._worker_end or command in _CLOSING:
                self._answer_alone(seq, command)
                return
            try:
                self._worker = self._start()
            except OSError as error:
                raise RequestError(ENDED, f"Python cannot be started: {error}", is_shown=True) from None
        if len(self._pending) >= PENDING_MAX and command not in _CLOSING:
            raise RequestError(ENDED, f"{PENDING_MAX} requests wait for an answer; one more is refused")
        self._last += 1
        wait_s = END_S if command in _CLOSING else ANSWER_S
        self._pending[self._last] = _Pending(seq, command, now_s + wait_s)
        if command == "pause":
            self._pause_deadline_s = now_s + PAUSE_S
        self._worker.send({"seq": self._last, "type": "request", "command": command, "arguments": arguments})

    def _answer_alone(self, seq: int, command: str) -> None:
        """Answer a request for which there is no process."""
        if command not in _CLOSING:
            raise RequestError(ENDED, f"the debug session is over: {self._worker_end}")
        self._send(response(seq, command))
        self.is_over = self.is_over or command == "disconnect"

    def _cancel(self, seq: int, arguments: Arguments) -> None:
        """Answer a request with an error now; what it does goes on unless the process can stop it."""
        if arguments.has("requestId"):
            wanted = arguments.number("requestId")
            for number, pending in self._pending.items():
                if pending.seq == wanted and pending.command not in (*_OPENING, *_CLOSING):
                    del self._pending[number]
                    self._send(error_response(wanted, pending.command, RequestError(CANCELLED, "cancelled")))
                    break
        self._send(response(seq, "cancel"))

    # ---------------------------------------------------------------- process

    def worker_sent(self, message: Message) -> None:
        """Take a message of the process."""
        if self.is_over:
            return
        if message["type"] == "response":
            pending = self._pending.pop(message["request_seq"], None)
            if pending is not None:
                if pending.command == "disconnect":
                    self._fail_pending("the client has disconnected")
                    self._drop_worker()
                self._send({**message, "request_seq": pending.seq})
                self.is_over = pending.command == "disconnect"
            return
        name = message["event"]
        if name == "initialized":
            # From here on the client decides when the answer to its launch can come.
            self._has_session = True
            for number, pending in self._pending.items():
                if pending.command in _OPENING:
                    self._pending[number] = pending._replace(deadline_s=None)
        elif name in ("stopped", "terminated"):
            self._pause_deadline_s = None
            self._is_terminated = self._is_terminated or name == "terminated"
        elif name == "process":
            self._is_terminated = False
        self._send(message)

    def worker_ended(self, reason: str) -> None:
        """Report that the process has ended by itself."""
        self._drop_worker()
        self._worker_end = reason
        self._end_session(reason, CRASHED)

    # ---------------------------------------------------------------- time

    def deadline_s(self) -> float | None:
        """Return when `pass_time` must be called next; None for never."""
        times = [pending.deadline_s for pending in self._pending.values() if pending.deadline_s is not None]
        if self._pause_deadline_s is not None:
            times.append(self._pause_deadline_s)
        return min(times, default=None)

    def pass_time(self, now_s: float) -> None:
        """Answer what has waited too long."""
        if self._pause_deadline_s is not None and now_s >= self._pause_deadline_s:
            self._pause_deadline_s = None
            text = "no checkpoint since `pause`: a single call of the program does not return; `disconnect` ends it\n"
            self._send(event("output", {"category": "important", "output": text}))
        overdue = [
            (number, pending)
            for number, pending in self._pending.items()
            if pending.deadline_s is not None and now_s >= pending.deadline_s
        ]
        for number, pending in overdue:
            self._pending.pop(number, None)
            if pending.command not in _CLOSING:
                text = f"no answer in {ANSWER_S:g} s: the process that debugs is busy; `disconnect` ends it"
                self._send(error_response(pending.seq, pending.command, RequestError(ENDED, text)))
                continue
            self._drop_worker()
            self._worker_end = "it did not answer and was killed"
            if pending.command == "terminate":
                self._send(response(pending.seq, pending.command))
                self._end_session("the process did not answer and was killed", 0)
            else:
                self._fail_pending("the client has disconnected")
                self._send(response(pending.seq, pending.command))
                self.is_over = True
            return

    # ---------------------------------------------------------------- inner

    def _end_session(self, reason: str, exit_code: int) -> None:
        """Answer everything, and report the end once."""
        if not self.is_over:
            self._send(event("output", {"category": "important", "output": f"elitescript dap: {reason}\n"}))
        closing = [pending for pending in self._pending.values() if pending.command in _CLOSING]
        self._pending = {number: one for number, one in self._pending.items() if one.command not in _CLOSING}
        self._fail_pending(reason)
        if self._has_session and not self._is_terminated:
            self._is_terminated = True
            self._send(event("exited", {"exitCode": exit_code}))
            self._send(event("terminated"))
        for pending in closing:
            self._send(response(pending.seq, pending.command))
            self.is_over = self.is_over or pending.command == "disconnect"

    def _fail_pending(self, reason: str) -> None:
        pending, self._pending = self._pending, {}
        for one in pending.values():
            self._send(error_response(one.seq, one.command, RequestError(ENDED, reason)))

    def _drop_worker(self) -> None:
        worker, self._worker = self._worker, None
        self._pause_deadline_s = None
        if worker is not None:
            worker.kill()

    def _send(self, message: Message) -> None:
        self._sequence += 1
        self._write(framed({"seq": self._sequence, **message}))
