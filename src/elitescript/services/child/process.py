"""One child process: started with nothing but one socket, read, killed."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

import elitescript
from elitescript.codec.values import CodecError
from elitescript.environment import stop_signals
from elitescript.environment.process import HASH_SEED
from elitescript.observer import COVERAGE_VARIABLE
from elitescript.said import said
from elitescript.services.child.frames import QUESTION, READ_BYTES, UP_MAX, FrameReader, frame

PYTHON: Final = (sys.executable, "-P", "-s", "-m")
"""The beginning of command lines; then comes what is run."""
COMMAND: Final = (*PYTHON, "elitescript.services.child")
"""The command line; then comes the number of the child's socket, and of the file of its coverage if there is one."""
LOG_MAX: Final = 1 << 16
"""Bytes of its output that are kept; what is older is thrown away."""
BACKLOG_MAX: Final = 64 * 1024 * 1024
"""Bytes that may wait for a child that does not read."""
LOG_PAUSE_S: Final = 0.01
"""Between two reads of its output: one that floods it waits, and takes no time of others."""
REAP_S: Final = 2.0
GONE_S: Final = 0.005
"""How long a killed process is waited for at once; then it is looked for again so often."""
_SCHEDULER_CLOCK: Final = 2
"""Kind of clock that counts what the scheduler has given to a process, in user and system mode."""

_TRACE_BEGIN: Final = b"most recent call first"
_LANGUAGE: Final = f"{os.sep}elitescript{os.sep}language{os.sep}"
"""In the names of the files that compile programs."""
_TRACE_LINE: Final = re.compile(r'^  File "([^"]*)", line (\d+) in ', re.MULTILINE)


class ChildProcess:
    """Starts one child, and exchanges messages with it.

    Args:
        on_message: receives letter and text of every message.
        on_end: called once, with the reason, when nothing more can come.
        command: to run instead of `COMMAND`; none of its coverage is kept.

    Raises:
        OSError: it cannot be started.
    """

    __slots__ = (
        "_backlog",
        "_is_over",
        "_is_watched",
        "_log",
        "_log_fd",
        "_loop",
        "_on_end",
        "_on_message",
        "_process",
        "_reader",
        "_socket",
    )

    def __init__(
        self,
        on_message: Callable[[str, bytes], None],
        on_end: Callable[[str], None],
        *,
        command: tuple[str, ...] = (),
    ) -> None:
        self._loop = asyncio.get_running_loop()
        self._on_message = on_message
        self._on_end = on_end
        self._reader = FrameReader(UP_MAX)
        self._backlog = bytearray()
        self._log = bytearray()
        self._is_over = False
        self._socket, theirs = socket.socketpair()
        given = [theirs.fileno()]
        try:
            if not command and (folder := os.environ.get(COVERAGE_VARIABLE)):
                from elitescript.services.coverage import coverage_descriptor

                given.append(coverage_descriptor(folder))
            # What ends this process by a signal to its group, or its service, is no end of the child.
            with stop_signals.held_back():
                self._process = subprocess.Popen(
                    [*(command or COMMAND), *map(str, given)],
                    pass_fds=given,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    bufsize=0,
                    env=child_environment(),
                    cwd="/",
                )
        except BaseException:
            self._socket.close()
            raise
        finally:
            theirs.close()
            for descriptor in given[1:]:
                os.close(descriptor)
        self._socket.setblocking(False)
        assert self._process.stdout is not None
        self._log_fd = self._process.stdout.fileno()
        os.set_blocking(self._log_fd, False)
        self._is_watched = False
        self.watch(True)
        self._loop.add_reader(self._log_fd, self._log_readable)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def log(self) -> str:
        """The end of what it has written to its output."""
        return self._log.decode("utf-8", "replace")

    def watch(self, is_watched: bool) -> None:
        """Have the event loop read what it sends, or leave that to `read`."""
        if is_watched != self._is_watched and not self._is_over:
            self._is_watched = is_watched
            if is_watched:
                self._loop.add_reader(self._socket, self.read)
            else:
                self._loop.remove_reader(self._socket)

    def send(self, letter: str, content: str | bytes) -> None:
        """Send a message; never waits."""
        if self._is_over:
            return
        data = frame(letter, content)
        if not self._backlog:
            try:
                data = data[self._socket.send(data) :]
            except BlockingIOError:
                pass
            except OSError as error:
                self._over(said("it is gone: {strerror}", strerror=error.strerror))
                return
            if not data:
                return
            self._loop.add_writer(self._socket, self._writable)
        self._backlog += data
        if len(self._backlog) > BACKLOG_MAX:
            self._over("it does not read what it is sent")

    def worked_s(self) -> float | None:
        """Return the processor time that it has used so far, s; None if that is not known here."""
        return processor_time_s(self._process.pid)

    def is_runnable(self) -> bool:
        """Return whether it runs, or waits for a processor; False if that is not known here."""
        return is_runnable(self._process.pid)

    def ask_where(self) -> None:
        """Have it write to its output where its program is."""
        with suppress(ProcessLookupError):
            self._process.send_signal(signal.SIGUSR1)

    def where(self) -> tuple[str, int] | None:
        """Return the name and line of the program text that it was in when asked; None if that is not known (yet)."""
        for name, line in self._trace():
            # Texts of programs are the only ones that are no files.
            if not name.endswith(".py") and not name.startswith("<frozen") and len(line) < 8:
                return name[:200], int(line)
        return None

    @property
    def is_compiling(self) -> bool:
        """Whether it was compiling a program when asked where it is."""
        return any(_LANGUAGE in name for name, _ in self._trace())

    def _trace(self) -> list[tuple[str, str]]:
        """Return the file and line of every call that it was in when asked, the innermost first."""
        _, found, trace = bytes(self._log).rpartition(_TRACE_BEGIN)
        return _TRACE_LINE.findall(trace.decode("utf-8", "replace")) if found else []

    def kill(self) -> None:
        """End it at once; what it leaves behind is cleared away as soon as it is gone, which much memory delays."""
        self._release()
        self._process.kill()
        self._reap()

    async def gone(self) -> None:
        """Return when a killed child is gone, which nothing but a fault of the computer can hold up for long."""
        for _ in range(round(REAP_S / GONE_S)):
            if self._process.poll() is not None:
                return
            await asyncio.sleep(GONE_S)

    # ---------------------------------------------------------------- inner

    def read(self) -> None:
        """Read what it has sent; never waits."""
        if self._is_over:
            return
        try:
            data = self._socket.recv(READ_BYTES)
        except BlockingIOError:
            return
        except OSError as error:
            self._over(said("it is gone: {strerror}", strerror=error.strerror))
            return
        if not data:
            self._over("it has ended")
            return
        questions = 0
        try:
            for letter, text in self._reader.feed(data):
                questions += letter == QUESTION
                if questions > 1:
                    raise CodecError("a question before the answer to the one before")
                if self._is_over:
                    return
                self._on_message(letter, text)
        except CodecError as error:
            self._over(said("what it says is no message: {error}", error=error))

    def _writable(self) -> None:
        try:
            del self._backlog[: self._socket.send(self._backlog)]
        except BlockingIOError:
            return
        except OSError as error:
            self._over(said("it is gone: {strerror}", strerror=error.strerror))
            return
        if not self._backlog:
            self._loop.remove_writer(self._socket)

    def _log_readable(self) -> None:
        try:
            data = os.read(self._log_fd, LOG_MAX)
        except BlockingIOError:
            return
        if not data:
            self._loop.remove_reader(self._log_fd)
            return
        self._log += data
        if len(self._log) > LOG_MAX:
            del self._log[: len(self._log) - LOG_MAX]
            self._loop.remove_reader(self._log_fd)
            self._loop.call_later(LOG_PAUSE_S, self._read_log_on)

    def _read_log_on(self) -> None:
        if not self._is_over:
            self._loop.add_reader(self._log_fd, self._log_readable)

    def _reap(self) -> None:
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(GONE_S)
            return
        if not self._loop.is_closed():
            self._loop.call_later(GONE_S, self._reap_later)

    def _reap_later(self) -> None:
        if self._process.poll() is None:
            self._loop.call_later(GONE_S, self._reap_later)

    def _over(self, reason: str) -> None:
        if self._is_over:
            return
        self._release()
        with suppress(subprocess.TimeoutExpired):
            # Its socket is closed a moment before it is gone.
            self._process.wait(0.02)
        code = self._process.returncode
        if code is not None and code < 0:
            reason = said("{reason} (killed by signal {code})", reason=reason, code=-code)
        elif code not in (None, 0, 1):
            reason = said("{reason} (exit code {code})", reason=reason, code=code)
        self._on_end(reason)

    def _release(self) -> None:
        if self._is_over:
            return
        self._is_over = True
        self._loop.remove_reader(self._socket)
        self._loop.remove_writer(self._socket)
        self._loop.remove_reader(self._log_fd)
        self._socket.close()
        with suppress(OSError):
            # What it wrote last says why.
            self._log += os.read(self._log_fd, LOG_MAX)
        assert self._process.stdout is not None
        self._process.stdout.close()


def processor_time_s(pid: int) -> float | None:
    """Return the processor time of all threads of a process, s; None if it has gone, or that is not known here.

    Linux has a clock for every process, whose number is the complement of the process' with the kind of the clock in
    the lowest three bits (`clock_getcpuclockid(3)`).
    """
    if sys.platform != "linux":
        return None
    try:
        return time.clock_gettime((~pid << 3) | _SCHEDULER_CLOCK)
    except OSError:
        return None


def is_runnable(pid: int) -> bool:
    """Return whether the first thread of a process runs, or waits for a processor.

    False if it has gone, or that is not known here: Linux shows it behind the name, in brackets, in `stat`.
    """
    try:
        shown = Path(f"/proc/{pid}/stat").read_bytes()
    except OSError:
        return False
    return shown.rpartition(b")")[2].split()[:1] == [b"R"]


def child_environment() -> dict[str, str]:
    """Return the environment of a child: nothing but what Python needs to start."""
    environment = {"PYTHONHASHSEED": HASH_SEED, "PYTHONUTF8": "1"}
    package = Path(elitescript.__file__).resolve().parent
    if "site-packages" not in package.parts:
        # Not installed: a working copy is found through this path alone.
        environment["PYTHONPATH"] = str(package.parent)
    for name in ("PYTHONHOME", "LD_LIBRARY_PATH"):
        if name in os.environ:
            environment[name] = os.environ[name]
    return environment
