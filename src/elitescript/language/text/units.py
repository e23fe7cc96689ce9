"""Splits a stream of bytes into units, and determines the kind of each.

Port 30001 takes text without lengths or separators. A unit begins with `def name`
or `sec name(` at the start of a line and ends with the next `end` at the start of a line; outside
units each statement is a unit of its own, a *line unit*.
"""

from __future__ import annotations

import re
from copy import copy
from functools import cache
from typing import Final

from elitescript.language.diagnostics import Diagnostic, diagnostic
from elitescript.language.limits import MAX_UNIT_BYTES
from elitescript.language.options import LINE, PROGRAM, SECONDARY
from elitescript.language.text.lexer import name_pattern, structure_pattern
from elitescript.language.text.strings import string_end_pattern
from elitescript.records import record
from elitescript.said import Said, counted, said

SILENCE_S: Final = 0.1
"""After this long without a byte, an `end` counts although no line feed follows it. *Assumed.*"""
SILENT_LINE_MAX: Final = 8 * 1024
"""Bytes of a line that silence ends; a longer one needs its line feed. *Assumed*: otherwise each
byte of a slow client would cause a new scan of the whole line."""


@record
class Unit:
    """A complete unit of a stream.

    Attributes:
        kind: `program`, `secondary` or `line`.
        text: its lines, with LF between them.
        first_line: number of its first line in the stream, from 1.
        damaged: some bytes were not UTF-8 and were replaced.
        reads: what its first line with such bytes is in GBK; empty if it is no likely text in it.
    """

    kind: str
    text: str
    first_line: int
    damaged: bool = False
    reads: str = ""


@record
class DiscardedText:
    """Text that was discarded.

    Attributes:
        problems: the reasons; lines count from the first line of the refused text.
        first_line: number of that line in the stream, from 1.
    """

    problems: tuple[Diagnostic, ...]
    first_line: int


@cache
def _opener(name: str) -> re.Pattern[str]:
    return re.compile(rf"(?P<word>def)[ \t]|(?P<sec>sec)[ \t]+{name}[ \t]*\(")


@cache
def _plain() -> re.Pattern[bytes]:
    """Empty lines, and indented ASCII ones without strings, comments and backslashes whose brackets are closed."""
    other = rb"[^'\"#\\()\[\]{}\n\x80-\xff]*+"
    lists = rb"(?:\[" + other + rb"\]" + other + rb")*+"
    line = rb"(?:[ \t]" + other + lists + rb"(?:\(" + other + lists + rb"\)" + other + lists + rb")*+)?\n"
    return re.compile(rb"(?:" + line + rb")*+")


@cache
def _closer() -> re.Pattern[str]:
    return re.compile(r"end[ \t\f]*(?:;[ \t\f]*)?(?:#.*)?")


class UnitSplitter:
    """Cuts the bytes of one connection into units.

    Feed it with `receive`, call `silence` when `SILENCE_S` have passed without a byte, and `close`
    when the peer has closed its side. It holds one unfinished unit of at most `max_bytes`.
    """

    __slots__ = (
        "_after_cr",
        "_damaged",
        "_first_line",
        "_kind",
        "_line_number",
        "_lines",
        "_lost_bytes",
        "_lost_from",
        "_max_bytes",
        "_overflow",
        "_partial",
        "_reads",
        "_size",
        "_skip_line",
        "_tracker",
    )
    _reads: str

    def __init__(self, max_bytes: int = MAX_UNIT_BYTES) -> None:
        self._max_bytes = max_bytes
        self._partial = bytearray()
        self._after_cr = False
        self._line_number = 1
        self._tracker = _LineTracker()
        self._size = 0
        self._first_line = 1
        self._overflow = False
        self._skip_line = False
        self._lost_bytes = self._lost_from = 0
        """Size so far of a text that is too long, and its first line."""
        self._reset()

    @property
    def is_in_program(self) -> bool:
        """Whether a program has begun and not ended."""
        return self._kind in (PROGRAM, SECONDARY)

    @property
    def pending(self) -> bool:
        """Whether text waits for more bytes, for silence or for the end of the stream."""
        return bool(self._partial or self._kind or self._lost_bytes)

    def receive(self, data: bytes) -> list[Unit | DiscardedText]:
        """Take bytes and return what they complete, in order."""
        found: list[Unit | DiscardedText] = []
        if self._after_cr and data:
            data = data[1:] if data[0] == 0x0A else data
            self._after_cr = False
        self._after_cr = data.endswith(b"\r")
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        at = 0
        while True:
            at = self._take_plainly(data, at)
            end = data.find(b"\n", at)
            if end < 0:
                break
            self._append(data[at:end], found)
            at = end + 1
            if not self._skip_line:
                line = self._decode(bytes(self._partial))
                size = len(self._partial) + 1
                self._partial.clear()
                self._take(line, size, found)
            else:
                self._lost_bytes += 1
                if not self._overflow:
                    self._refuse_lost(found)
            self._skip_line = False
            self._line_number += 1
        self._append(data[at:], found)
        return found

    def silence(self) -> list[Unit | DiscardedText]:
        """Return what looks complete, after `SILENCE_S` without a byte."""
        found: list[Unit | DiscardedText] = []
        self._refuse_lost(found)
        if len(self._partial) > SILENT_LINE_MAX:
            return found
        line = self._decode(bytes(self._partial), peek=True)
        if self._kind in (PROGRAM, SECONDARY):
            # Also when a bracket or a string is still open: the text is faulty, and is reported now.
            last = line if self._partial else self._lines[-1]
            if _closer().fullmatch(last):
                self._take_partial(found)
                if self._kind:
                    self._deliver(found)
        elif self._kind or line.strip():
            if not self._partial:
                self._deliver(found)
            elif not _opener(name_pattern(line)).match(line):
                tracker = copy(self._tracker)
                tracker.advance(line)
                if not tracker.inside:
                    self._take_partial(found)
                    if self._kind:
                        self._deliver(found)
        return found

    def drop_line(self) -> str:
        """Discard a line unit that is not complete, and return its text; a program is kept."""
        if self._kind in (PROGRAM, SECONDARY):
            return ""
        text = "\n".join([*self._lines, self._decode(bytes(self._partial), peek=True)])
        self._partial.clear()
        self._reset()
        return text

    def close(self) -> list[Unit | DiscardedText]:
        """Return what is complete and refuse the rest, as the peer has closed its side."""
        found: list[Unit | DiscardedText] = []
        self._take_partial(found)
        if self._kind == LINE:
            self._deliver(found)
        elif self._kind:
            if _closer().fullmatch(self._lines[-1]):
                self._deliver(found)
            else:
                self._refuse(found, "the connection was closed")
        self._refuse_lost(found)
        self._overflow = False
        return found

    # Lines

    def _take_plainly(self, data: bytes, at: int) -> int:
        """Take lines of a program in which nothing begins or ends, as most are: the same as `_take`, but all at once.

        Args:
            data: with LF as line ends.
            at: where the next line begins.

        Returns:
            Where the first line begins that was not taken.
        """
        if self._partial or self._overflow or self._skip_line or not self.is_in_program or self._tracker.inside:
            return at
        found = _plain().match(data, at)
        end = at if found is None else found.end()
        if end == at or self._size + end - at - 1 > self._max_bytes:
            return at
        lines = data[at : end - 1].decode("ascii").split("\n")
        self._lines += lines
        self._size += end - at
        self._line_number += len(lines)
        return end

    def _append(self, row: bytes, found: list[Unit | DiscardedText]) -> None:
        if self._skip_line:
            self._lost_bytes += len(row)
            return
        self._partial += row
        if self._size + len(self._partial) > self._max_bytes:
            self._overflowed()
            self._skip_line = True

    def _decode(self, row: bytes, peek: bool = False) -> str:
        if self._line_number == 1:
            row = row.removeprefix(b"\xef\xbb\xbf")
        try:
            return row.decode("utf-8")
        except UnicodeDecodeError:
            from elitescript.text_encoding import as_gbk

            if not peek:
                self._damaged = True
                if not self._reads:
                    self._reads = as_gbk(row) or ""
            return row.decode("utf-8", "replace")

    def _take_partial(self, found: list[Unit | DiscardedText]) -> None:
        if self._partial:
            line = self._decode(bytes(self._partial))
            size = len(self._partial)
            self._partial.clear()
            self._take(line, size, found)

    def _take(self, line: str, size: int, found: list[Unit | DiscardedText]) -> None:
        """Take one whole line."""
        opener = _opener(name_pattern(line)).match(line) if line[:1] in "ds" else None
        if opener and not self._tracker.quote:
            # Even inside brackets: `def` cannot stand there, so one was never closed.
            if self._kind in (PROGRAM, SECONDARY):
                self._refuse(found, said("line {line_number} begins another one", line_number=self._line_number))
            elif self._kind:
                self._deliver(found)
            self._refuse_lost(found)
            self._overflow = False
            self._begin(PROGRAM if opener["word"] else SECONDARY)
            self._add(line, size)
        elif self._overflow:
            self._lost_bytes += size
            if _closer().fullmatch(line):
                self._overflow = False
                self._refuse_lost(found)
        elif self._kind in (PROGRAM, SECONDARY):
            closes = not self._tracker.inside and _closer().fullmatch(line)
            self._add(line, size)
            if closes:
                self._deliver(found)
        else:
            if not self._kind:
                if line.strip(" \t\f")[:1] in ("", "#"):
                    self._damaged, self._reads = False, ""
                    return
                self._begin(LINE)
            self._add(line, size)
            if not self._tracker.inside:
                self._deliver(found)

    def _begin(self, kind: str) -> None:
        self._kind = kind
        self._first_line = self._line_number
        self._tracker.reset()

    def _add(self, line: str, size: int) -> None:
        self._lines.append(line)
        self._size += size
        self._tracker.advance(line)

    # Ends

    def _deliver(self, found: list[Unit | DiscardedText]) -> None:
        found.append(Unit(self._kind, "\n".join(self._lines), self._first_line, self._damaged, self._reads))
        self._reset()

    def _refuse(self, found: list[Unit | DiscardedText], reason: str) -> None:
        last = len(self._lines)
        text = said(
            "this program has no `end`: {reason} after {lines}",
            reason=Said(reason),
            lines=counted(last, "line", "lines"),
        )
        hint = "close it with `end` at the start of a line, and a line feed behind it"
        problem = diagnostic("E102", 1, 1, text, end_column=len(self._lines[0]) + 1, hint=hint)
        found.append(DiscardedText((problem,), self._first_line))
        self._reset()

    def _overflowed(self) -> None:
        """Throw away a text that is too long; its end, or the first silence, shows how long."""
        self._lost_bytes = self._size + len(self._partial)
        self._lost_from = self._first_line if self._kind else self._line_number
        self._overflow = self._kind in (PROGRAM, SECONDARY)
        self._partial.clear()
        self._reset()

    def _refuse_lost(self, found: list[Unit | DiscardedText]) -> None:
        """Refuse a text that was too long, if there is one."""
        if self._lost_bytes:
            text = said(
                "the text has {lost_bytes:,} bytes, at most {max_bytes:,} are read",
                lost_bytes=self._lost_bytes,
                max_bytes=self._max_bytes,
            )
            hint = "close programs with `end` at the start of a line; read long lists of points from a file"
            found.append(DiscardedText((diagnostic("E102", 1, 1, text, hint=hint),), self._lost_from))
            self._lost_bytes = 0

    def _reset(self) -> None:
        self._kind = ""
        self._lines: list[str] = []
        self._size = 0
        self._damaged = False
        self._reads = ""
        self._tracker.reset()


class _LineTracker:
    """Follows physical lines one by one."""

    __slots__ = ("continued", "depth", "quote")

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        self.depth = 0
        self.quote = ""
        self.continued = False

    @property
    def inside(self) -> bool:
        """Whether the next physical line belongs to the same logical line."""
        return bool(self.depth or self.quote or self.continued)

    def advance(self, line: str) -> None:
        """Take one physical line, without its line end."""
        self.continued = False
        position = 0
        if self.quote:
            found = string_end_pattern(self.quote).match(line)
            if found is None:
                if len(self.quote) == 1 and not _ends_with_backslash(line):
                    self.quote = ""
                return
            position = found.end()
            self.quote = ""
        search = structure_pattern().search
        while structure := search(line, position):
            mark = structure.group()
            position = structure.end()
            if mark in "([{":
                self.depth += 1
            elif mark in ")]}":
                self.depth = max(0, self.depth - 1)
            elif mark == "#":
                return
            elif mark == "\\":
                self.continued = position == len(line)
            elif found := string_end_pattern(mark).match(line, position):
                position = found.end()
            else:
                # A single quote may be continued by a backslash; else it is a mistake that ends here.
                if len(mark) == 3 or _ends_with_backslash(line):
                    self.quote = mark
                return


def _ends_with_backslash(line: str) -> bool:
    return (len(line) - len(line.rstrip("\\"))) % 2 == 1
