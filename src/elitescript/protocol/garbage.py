"""Bytes on a script port that cannot be script, such as a message of another protocol: one report for each burst."""

from __future__ import annotations

from typing import Final

REPORT_TICKS: Final = 250
"""Interval of the reports about a burst that goes on, 1 s. *Assumed.*"""
SHOWN_CHARACTERS: Final = 16

_DAMAGED: Final = "\ufffd"
"""Stands for bytes that are not UTF-8."""
_NO_TEXT: Final = frozenset(map(chr, range(32))) - {"\t", "\n", "\f", "\r"} | {"\x7f"}
_OTHER_PROTOCOLS: Final = ("HTTP/1.0", "HTTP/1.1")
"""Ends of the first line of a request of a web browser."""


def is_garbage(line: str) -> bool:
    """Return whether a line outside programs cannot be script.

    It contains a NUL, or bytes that are not UTF-8 besides control characters, or begins with one of them. Any line of
    text may be script, unless it is the beginning of a request or greeting of another protocol.
    """
    found = _NO_TEXT.intersection(line)
    start = line.strip()[:1]
    if "\0" in found or start == _DAMAGED or start in _NO_TEXT or (found and _DAMAGED in line):
        return True
    return line.startswith("SSH-") or line.rstrip().endswith(_OTHER_PROTOCOLS)


def is_statement(line: str) -> bool:
    """Return whether a line in the middle of garbage may be script: text with a call or an assignment."""
    if _DAMAGED in line or _NO_TEXT.intersection(line) or not ("(" in line or "=" in line):
        return False
    word, colon, _ = line.partition(": ")
    # `User-Agent: browser (system)` is a line of a web browser.
    return not (colon and word.replace("-", "").isalpha())


class GarbageBurst:
    """Consecutive garbage."""

    __slots__ = ("_begin", "_lines", "_next_report_at", "_size")

    def __init__(self) -> None:
        self._size = 0
        self._lines = 0
        self._begin = ""
        self._next_report_at = 0

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to report."""
        return not self._lines

    def takes(self, line: str) -> bool:
        """Return whether a line belongs to it: garbage, and within garbage also text that is no statement."""
        return is_garbage(line) or (not self.is_empty and not is_statement(line))

    def add(self, line: str, tick: int) -> None:
        """Add a line."""
        if not self._lines:
            self._begin = line[:SHOWN_CHARACTERS]
            self._next_report_at = tick + REPORT_TICKS
        self._lines += 1
        self._size += len(line)

    @property
    def report_tick(self) -> int | None:
        """Tick of the next report while it goes on; None if there is nothing to report."""
        return self._next_report_at if self._lines else None

    def is_due(self, tick: int) -> bool:
        """Return whether it is to be reported before its end."""
        return bool(self._lines) and tick >= self._next_report_at

    def take(self, origin: str) -> str:
        """Return the report, and begin a new burst."""
        lines = "1 line" if self._lines == 1 else f"{self._lines} lines"
        characters = "1 character" if self._size == 1 else f"{self._size} characters"
        text = (
            f"{origin} sent {characters} in {lines} that are no script, beginning with {self._begin!a}; they were "
            "thrown away. Does that client speak another protocol?"
        )
        self._size = self._lines = 0
        return text
