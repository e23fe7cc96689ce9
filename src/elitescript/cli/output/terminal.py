"""A stream that never blocks its writer, so that a slow terminal does not delay a robot."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Final

from elitescript.cli.output.writable import Writable

WAITING_MAX: Final = 50_000
"""Limit of texts that wait; further ones are dropped and counted."""
CLOSE_TIMEOUT_S: Final = 2.0


def missing_line(count: int) -> str:
    """Return the line in the place of dropped texts."""
    return f"({count} texts are missing here: they came faster than they could be printed)\n"


class QueuedStream:
    """Passes texts to a thread that writes them in order.

    Args:
        target: the stream.
        missing_text: returns the text in the place of a number of dropped ones.
    """

    def __init__(self, target: Writable, missing_text: Callable[[int], str] = missing_line) -> None:
        self._target = target
        self._missing_text = missing_text
        self._texts: deque[str] = deque()
        self._news = threading.Event()
        self._missing = 0
        self._is_closing = False
        self._is_broken = False
        self._thread = threading.Thread(target=self._run, name="terminal", daemon=True)
        self._thread.start()

    def write(self, text: str) -> int:
        """Queue a text."""
        if len(self._texts) >= WAITING_MAX:
            self._missing += 1
            return len(text)
        self._note_missing()
        self._texts.append(text)
        return len(text)

    def _note_missing(self) -> None:
        if self._missing:
            self._texts.append(self._missing_text(self._missing))
            self._missing = 0

    def flush(self) -> None:
        """Let the thread write the queued texts."""
        if self._texts:
            self._news.set()

    def close(self) -> None:
        """Write the queued texts, for a limited time."""
        self._note_missing()
        self._is_closing = True
        self._news.set()
        self._thread.join(CLOSE_TIMEOUT_S)

    def _run(self) -> None:
        while not self._is_closing or self._texts:
            self._news.wait()
            self._news.clear()
            self._write_all()

    def _write_all(self) -> None:
        while self._texts:
            text = "".join(self._texts.popleft() for _ in range(len(self._texts)))
            if self._is_broken:
                continue
            try:
                self._target.write(text)
                self._target.flush()
            except (OSError, ValueError):
                # The reader has closed the stream; the robot goes on.
                self._is_broken = True


class TaggedStream:
    """Begins every line with a tag.

    Args:
        target: the stream.
        begin: begin of a line that the tag replaces, or "".
        tag: the new begin.
    """

    def __init__(self, target: Writable, begin: str, tag: str) -> None:
        self._target = target
        self._begin = begin
        self._tag = tag
        self._rest = ""

    def write(self, text: str) -> int:
        """Take a text; only whole lines are written."""
        *lines, self._rest = (self._rest + text).split("\n")
        for line in lines:
            self._target.write(f"{self._tag}{line.removeprefix(self._begin)}\n")
        return len(text)

    def flush(self) -> None:
        """Flush the stream."""
        self._target.flush()
