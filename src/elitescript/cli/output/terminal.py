"""A stream that never holds its writer up: a slow terminal must not delay a robot."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Final

from elitescript.cli.output.writable import Writable

WAITING_MAX: Final = 50_000
"""Texts that may wait; what comes after them is left out, and counted."""
CLOSE_TIMEOUT_S: Final = 2.0


def told_to_people(count: int) -> str:
    """Return the line in the place of texts that were left out."""
    return f"({count} texts are missing here: they came faster than they could be printed)\n"


class PatientStream:
    """Hands texts to a thread that writes them, in their order.

    Args:
        target: where they go.
        tell_missing: makes the text that stands in the place of so many others.
    """

    def __init__(self, target: Writable, tell_missing: Callable[[int], str] = told_to_people) -> None:
        self._target = target
        self._tell_missing = tell_missing
        self._texts: deque[str] = deque()
        self._news = threading.Event()
        self._missing = 0
        self._is_closing = False
        self._is_broken = False
        self._thread = threading.Thread(target=self._run, name="terminal", daemon=True)
        self._thread.start()

    def write(self, text: str) -> int:
        """Take a text."""
        if len(self._texts) >= WAITING_MAX:
            self._missing += 1
            return len(text)
        if self._missing:
            self._texts.append(self._tell_missing(self._missing))
            self._missing = 0
        self._texts.append(text)
        return len(text)

    def flush(self) -> None:
        """Have what was written appear soon."""
        if self._texts:
            self._news.set()

    def close(self) -> None:
        """Write what is left, for a limited time."""
        if self._missing:
            self._texts.append(self._tell_missing(self._missing))
            self._missing = 0
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
                # The reader has gone. The robot goes on.
                self._is_broken = True


class TaggedStream:
    """Begins every line in a way of its own.

    Args:
        target: where lines go.
        begin: how a line begins, or "".
        tag: what stands in the place of that.
    """

    def __init__(self, target: Writable, begin: str, tag: str) -> None:
        self._target = target
        self._begin = begin
        self._tag = tag
        self._rest = ""

    def write(self, text: str) -> int:
        """Take a text; only whole lines go on."""
        *lines, self._rest = (self._rest + text).split("\n")
        for line in lines:
            self._target.write(f"{self._tag}{line.removeprefix(self._begin)}\n")
        return len(text)

    def flush(self) -> None:
        """Have the whole lines appear."""
        self._target.flush()
