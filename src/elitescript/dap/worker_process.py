"""The process that debugs, as its parent sees it: started, spoken to, killed."""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
from collections.abc import Callable
from contextlib import suppress
from queue import SimpleQueue
from threading import Thread
from typing import Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.codec.values import CodecError
from elitescript.dap.messages import Message
from elitescript.environment.process import Life, module_command, module_environment, place_in_trace

TRACE_MAX: Final = 1 << 16
"""Bytes of what it wrote last that are read for the reason of its end."""


class WorkerProcess:
    """Starts `dap.worker`, and exchanges messages with it as lines of JSON.

    Args:
        on_message: called with each message, in a thread.
        on_end: called once with the reason when the process has ended by itself, in a thread.

    Raises:
        OSError: it cannot be started.
    """

    __slots__ = ("_errors", "_life", "_on_end", "_on_message", "_outgoing", "_process", "is_killed")

    def __init__(self, on_message: Callable[[Message], None], on_end: Callable[[str], None]) -> None:
        self._on_message = on_message
        self._on_end = on_end
        self._outgoing: SimpleQueue[bytes] = SimpleQueue()
        """Bounded by `relay.PENDING_MAX`."""
        self.is_killed = False
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        # The end of this process closes the pipe, which ends the other one, whatever it does.
        self._life = Life()
        try:
            self._process = subprocess.Popen(
                module_command("elitescript.dap.worker", [self._life.descriptor]),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                bufsize=0,
                env=module_environment(),
                **self._life.options,
            )
        except BaseException:
            self._life.close()
            self._errors.close()
            raise
        self._life.started()
        Thread(target=self._read, daemon=True).start()
        Thread(target=self._write, daemon=True).start()

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def send(self, message: Message) -> None:
        """Send a message; never waits."""
        self._outgoing.put(to_text(message).encode("ascii") + b"\n")

    def kill(self) -> None:
        """End it and its snapshots at once; nothing of it is reported any more."""
        self.is_killed = True
        self._end_group()

    # ---------------------------------------------------------------- inner

    def _read(self) -> None:
        assert self._process.stdout is not None
        fault = ""
        with self._process.stdout as pipe:
            rest = b""
            while not fault and (data := pipe.read(1 << 16)):
                *lines, rest = (rest + data).split(b"\n")
                for line in lines:
                    try:
                        self._on_message(from_text(line))
                    except CodecError as error:
                        fault = f"what it sent is no message: {error}"
        # What is left of it: a process without its output, or its snapshots.
        self._end_group(only_if_alive=not fault)
        code = self._process.wait()
        self._outgoing.put(b"")
        reason = fault or self._reason(code)
        self._life.close()
        self._errors.close()
        if not self.is_killed:
            self._on_end(reason)

    def _write(self) -> None:
        assert self._process.stdin is not None
        with suppress(OSError), self._process.stdin as pipe:
            while data := self._outgoing.get():
                while data:
                    data = data[pipe.write(data) :]
                if hasattr(signal, "SIGURG"):
                    # While its program runs it looks for requests when it gets one.
                    self._process.send_signal(signal.SIGURG)

    def _end_group(self, *, only_if_alive: bool = False) -> None:
        if only_if_alive:
            # Its output closes a moment before it is gone; its exit code says more than that it was killed.
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(0.5)
        with suppress(ProcessLookupError, PermissionError):
            if os.name == "posix":
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()

    def _reason(self, code: int) -> str:
        self._errors.seek(0, os.SEEK_END)
        self._errors.seek(max(0, self._errors.tell() - TRACE_MAX))
        trace = self._errors.read()
        if place := place_in_trace(trace):
            return f"the process that debugs crashed in line {place[1]} of {place[0]} ({_ended(code)})"
        last = trace.decode("utf-8", "replace").strip().rpartition("\n")[2]
        return f"the process that debugs ended ({_ended(code)})" + (f": {last[:300]}" if last else "")


def _ended(code: int) -> str:
    if code >= 0:
        return f"exit code {code}"
    with suppress(ValueError):
        return signal.Signals(-code).name
    return f"signal {-code}"
