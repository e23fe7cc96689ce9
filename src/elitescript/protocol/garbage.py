"""Bytes on a script port that cannot be script, such as a message of another protocol: told once for each burst."""

from __future__ import annotations

from typing import Final

REPORT_TICKS: Final = 250
"""A burst that does not end is told this often, 1 s. *Assumed.*"""
SHOWN_CHARACTERS: Final = 16

_BLANK: Final = "\t\n\f\r"
_DAMAGED: Final = "\ufffd"
"""Stands for bytes that are not UTF-8."""


def is_garbage(line: str) -> bool:
    """Whether a line outside programs is no text: it has a NUL, or begins with what is no character of a text."""
    start = line.lstrip(_BLANK + " ")[:1]
    return "\0" in line or start == _DAMAGED or "" < start < " " or start == "\x7f"


class Burst:
    """Garbage that has come in without a pause."""

    __slots__ = ("_begin", "_lines", "_next_report_at", "_size")

    def __init__(self) -> None:
        self._size = 0
        self._lines = 0
        self._begin = ""
        self._next_report_at = 0

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to tell."""
        return not self._lines

    def add(self, line: str, tick: int) -> None:
        """Another line of it."""
        if not self._lines:
            self._begin = line[:SHOWN_CHARACTERS]
            self._next_report_at = tick + REPORT_TICKS
        self._lines += 1
        self._size += len(line)

    def is_due(self, tick: int) -> bool:
        """Whether it lasts so long that it is to be told before its end."""
        return bool(self._lines) and tick >= self._next_report_at

    def take(self, origin: str) -> str:
        """What to say about it; it begins anew."""
        lines = "1 line" if self._lines == 1 else f"{self._lines} lines"
        characters = "1 character" if self._size == 1 else f"{self._size} characters"
        text = (
            f"{origin} sent {characters} in {lines} that are no script, beginning with {self._begin!a}; they were "
            "thrown away. Does that client speak another protocol?"
        )
        self._size = self._lines = 0
        return text
