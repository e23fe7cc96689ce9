"""A stream that never blocks its writer, so that a slow terminal does not delay a robot."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Final

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.cli.output.writable import Writable


WAITING_MAX: Final = 50_000
"""Limit of texts that wait; further ones are dropped and counted."""
CHARACTERS_MAX: Final = 64_000_000
"""Limit of their characters."""
BYTES_AT_ONCE: Final = 1 << 16
"""Texts are written in pieces of about this size: what is urgent waits for no more."""
BACKLOG: Final = 100
"""Texts that wait where the reader is slow; fewer have only not been looked at yet."""
CLOSE_TIMEOUT_S: Final = 2.0


def missing_line(count: int) -> str:
    """Return the line in the place of dropped texts."""
    return f"({count} texts are missing here: they came faster than they could be printed)\n"


class StateText(str):
    """A text that keeps its place among its kind."""

    __slots__ = ()


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
        self._urgent: deque[str] = deque()
        """What goes before them."""
        self._news = threading.Event()
        self._missing = 0
        self._taken = self._given = 0
        """Characters of texts that were queued, and that the thread has taken: each counts for itself."""
        self._is_closing = False
        self._is_broken = False
        self._thread = threading.Thread(target=self._run, name="terminal", daemon=True)
        self._thread.start()

    def write(self, text: str) -> int:
        """Queue a text."""
        if len(self._texts) >= WAITING_MAX or self._taken - self._given + len(text) > CHARACTERS_MAX:
            self._missing += 1
            return len(text)
        self._note_missing()
        self._texts.append(text)
        self._taken += len(text)
        return len(text)

    def write_state(self, text: str, *, overtakes: bool) -> None:
        """Queue a text about a state; no other one overtakes it.

        Args:
            text: it.
            overtakes: whether it goes before the texts that wait, where the reader is slow.
        """
        if overtakes and len(self._texts) > BACKLOG and not self._has_state:
            self._urgent.append(text)
        else:
            self.write(StateText(text))

    @property
    def _has_state(self) -> bool:
        return any(type(text) is StateText for text in self._texts.copy())

    def _note_missing(self) -> None:
        if self._missing:
            self._texts.append(self._missing_text(self._missing))
            self._missing = 0

    def flush(self) -> None:
        """Let the thread write the queued texts."""
        if self._texts or self._urgent:
            self._news.set()

    def close(self) -> None:
        """Write the queued texts, for a limited time."""
        self._note_missing()
        self._is_closing = True
        self._news.set()
        self._thread.join(CLOSE_TIMEOUT_S)

    def _run(self) -> None:
        while not self._is_closing or self._texts or self._urgent:
            self._news.wait()
            self._news.clear()
            self._write_all()

    def _write_all(self) -> None:
        while self._urgent or self._texts:
            text = self._next_piece()
            if self._is_broken:
                continue
            try:
                self._target.write(text)
                self._target.flush()
            except (OSError, ValueError, KeyboardInterrupt):
                # What the command does without a reader is decided by the stream; the writer of a text never waits.
                self._is_broken = True

    def _next_piece(self) -> str:
        parts: list[str] = []
        size = 0
        while size < BYTES_AT_ONCE and (self._urgent or self._texts):
            is_urgent = bool(self._urgent)
            parts.append((self._urgent if is_urgent else self._texts).popleft())
            size += len(parts[-1])
            self._given += 0 if is_urgent else len(parts[-1])
        return "".join(parts)


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
