"""What libraries report on their own: warnings and errors of `logging`, exceptions that nothing has caught.

Without a handler Python writes them to stderr as they are, between the lines of a command, and as often as they come.
"""

from __future__ import annotations

import logging
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

AGAIN_S: Final = 10.0
"""A line that is repeated is written again after so long, with how often it came."""
KINDS_MAX: Final = 100
"""Kinds of lines that are counted separately."""


class LibraryLines(logging.Handler):
    """Passes on each line once in a while.

    Args:
        say: takes a text; may be called from any thread.
        clock: wall time, s.
    """

    def __init__(self, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__(logging.WARNING)
        self._say = say
        self._clock = clock
        self._said: dict[str, tuple[float, int]] = {}
        """By line, without what it is about: when it was written, and how often it came since."""

    def emit(self, record: logging.LogRecord) -> None:
        """Take a record of `logging`."""
        try:
            text = record.getMessage()
        except (TypeError, ValueError):
            text = str(record.msg)
        error = record.exc_info[1] if record.exc_info else None
        self.take(f"{record.name}: {record.msg}", f"{record.name}: {text}", error)

    def take(self, key: str, text: str, error: BaseException | None = None) -> None:
        """Take a line.

        Args:
            key: the same for lines that differ in what they are about only.
            text: the line.
            error: that was not caught; None if there is none.
        """
        now, (at, count) = self._clock(), self._said.get(key, (-AGAIN_S, 0))
        if now - at < AGAIN_S:
            self._said[key] = at, count + 1
            return
        if len(self._said) >= KINDS_MAX:
            self._said.clear()
        self._said[key] = now, 0
        more = f" ({count} times more since then)" if count else ""
        if error is not None:
            text = f"internal error, please report it: {text}\n{''.join(traceback.format_exception(error)).rstrip()}"
        self._say(text + more)


@contextmanager
def library_lines(say: Callable[[str], None]) -> Iterator[None]:
    """Have lines of libraries go to `say` while the body runs."""
    lines = LibraryLines(say)

    def unraisable(found: sys.UnraisableHookArgs) -> None:
        lines.take(f"unraisable {found.exc_type.__name__}", found.err_msg or "exception ignored", found.exc_value)

    def in_thread(found: threading.ExceptHookArgs) -> None:
        lines.take(f"thread {found.exc_type.__name__}", "a thread has ended", found.exc_value)

    root = logging.getLogger()
    before = sys.unraisablehook, threading.excepthook
    root.addHandler(lines)
    sys.unraisablehook, threading.excepthook = unraisable, in_thread
    try:
        yield
    finally:
        sys.unraisablehook, threading.excepthook = before
        root.removeHandler(lines)
