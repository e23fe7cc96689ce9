"""The two logs of interpreter mode: what clients sent and got as replies, and what was executed.

There are two, for what was received or discarded and for what was executed under which number: *documented* (manual
2.14, interpreter mode). Their names, their form and how long they grow are *assumed*.
"""

from __future__ import annotations

from typing import Final

from elitescript.errors import ScriptError
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.runtime.environment import Files
from elitescript.shown import encodable

RECEIVED_NAME: Final = "interpreter_received.log"
EXECUTION_NAME: Final = "interpreter_executed.log"
OLD_SUFFIX: Final = ".1"
"""Behind the name of the log before this one."""
SIZE_MAX: Final = 1 << 20
"""Bytes of a file; then it becomes the old one, and a new one begins."""
DELAY_TICKS: Final = TICKS_PER_S // 10
"""After so long, what happened is in the file."""
PENDING_MAX: Final = 1 << 16
"""Characters that wait to be written; more are written at the end of their tick."""


class LogFile:
    """Writes one log.

    Args:
        files: the task folder.
        name: of the file in it.
    """

    __slots__ = ("_files", "_lines", "_name", "_size", "_tick", "_waits_since")

    def __init__(self, files: Files, name: str) -> None:
        self._files = files
        self._name = name
        self._lines: list[str] = []
        self._size = 0
        self._tick = self._waits_since = 0

    @property
    def is_waiting(self) -> bool:
        """Whether lines wait to be written."""
        return bool(self._lines)

    def begin_tick(self, tick: int) -> None:
        """Begin a tick: what is added from now on happens in it."""
        self._tick = tick

    def add(self, text: str) -> None:
        """Add a line."""
        if not self._lines:
            self._waits_since = self._tick
        line = f"{seconds(self._tick):10.3f} s  {' '.join(text.splitlines())}\n"
        self._lines.append(line)
        self._size += len(line)

    def end_tick(self) -> None:
        """Write what has waited long enough.

        Raises:
            OSError: it cannot be written; it is lost.
            ScriptError: the same.
        """
        if self._lines and (self._size >= PENDING_MAX or self._tick - self._waits_since >= DELAY_TICKS):
            data = encodable("".join(self._lines)).encode()
            self._lines.clear()
            self._size = 0
            self._write(data)

    def _write(self, data: bytes) -> None:
        files, name = self._files, self._name
        if files.kind(name) == "file" and files.size(name) >= SIZE_MAX:
            with files.open(name, "rb", None, None) as old:
                content = old.read()
            with files.open(name + OLD_SUFFIX, "wb", None, None) as older:
                older.write(content)
            files.remove(name)
        with files.open(name, "ab", None, None) as file:
            file.write(data)


class InterpreterLogs:
    """Holds both logs.

    Args:
        files: the task folder.

    Attributes:
        received: every line that came, and the replies.
        execution: every statement when it begins and when it is over, with its number.
    """

    __slots__ = ("_failures", "execution", "received")

    def __init__(self, files: Files) -> None:
        self.received = LogFile(files, RECEIVED_NAME)
        self.execution = LogFile(files, EXECUTION_NAME)
        self._failures: dict[LogFile, str] = {}

    @property
    def is_waiting(self) -> bool:
        """Whether lines wait to be written."""
        return self.received.is_waiting or self.execution.is_waiting

    def begin_tick(self, tick: int) -> None:
        """Begin a tick."""
        self.received.begin_tick(tick)
        self.execution.begin_tick(tick)

    def end_tick(self) -> str:
        """End a tick: write what is due; return why something could not be written, if that is news."""
        for log in (self.received, self.execution):
            try:
                log.end_tick()
            except (OSError, ScriptError) as error:
                why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
                is_news = why not in self._failures.values()
                self._failures[log] = why
                if is_news:
                    return f"a log of interpreter mode cannot be written: {why}"
        return ""
