"""Rewrites a text and keeps the author's positions.

A `Draft` collects findings and replacements while the text is examined. It never adds or
removes a line. `PositionMap` maps a position in the rewritten text to the author's.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator

from elitescript.language.diagnostics import Diagnostic, Edit, Fix, Severity, diagnostic
from elitescript.language.options import Options
from elitescript.language.text.lexer import NAME, Lexed, LogicalLine
from elitescript.language.text.masked import compiled, top_level
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple

_MAX_MATCHES = 50
"""Limit of findings of one rule in one text."""
_MAX_FINDINGS = 300
"""Limit of errors, and of warnings, of one text before it reaches Python's parser."""


class Replacement(NamedTuple):
    """New text for the characters from `start` up to `end` of one physical line."""

    start: int
    end: int
    text: str


class Unfolding(NamedTuple):
    """A text that was written in several lines out of a single one."""

    line: int
    """The author's line."""
    offsets: tuple[int, ...]
    """For each new line, what to add to its columns to get the author's."""

    def to_source(self, line: int, column: int) -> tuple[int, int]:
        offset = self.offsets[min(line, len(self.offsets)) - 1]
        return self.line, max(1, column + offset)


class _Shift(NamedTuple):
    column: int
    """Where the new text starts in the rewritten line, from 0."""
    length: int
    origin: int
    """Where the old text started in the author's line, from 0."""
    old_length: int


class PositionMap:
    """Maps positions in the rewritten text to positions in the author's text.

    Args:
        shifts: by line, the replacements that changed its length, from left to right.
        unfolding: how the text came out of a single line, if it did.
    """

    __slots__ = ("_shifts", "_unfolding")

    def __init__(self, shifts: dict[int, list[_Shift]], unfolding: Unfolding | None) -> None:
        self._shifts = shifts
        self._unfolding = unfolding

    @property
    def is_identity(self) -> bool:
        return not self._shifts and self._unfolding is None

    def moves(self, line: int) -> bool:
        """Return whether places on this line differ."""
        return self._unfolding is not None or line in self._shifts

    def to_source(self, line: int, column: int) -> tuple[int, int]:
        """Return the author's (line, column), from 1; a place inside new text goes to where it was put."""
        shifts = self._shifts.get(line)
        if shifts:
            at = column - 1
            index = bisect_right(shifts, at, key=lambda shift: shift.column) - 1
            if index >= 0:
                shift = shifts[index]
                within = at - shift.column
                if within < shift.length:
                    at = shift.origin + min(within, shift.old_length)
                else:
                    at = shift.origin + shift.old_length + within - shift.length
                column = at + 1
        if self._unfolding:
            return self._unfolding.to_source(line, column)
        return line, column


class BlockEnd(NamedTuple):
    """Where a block ends, and whether an `end` closes it.

    Attributes:
        word: the keyword of its header; empty for a line that only looks like one.
        outer: the keyword of the block around it; empty at the top.
        opener: its header.
        last: its last line.
        follower: the line behind it, which may be its `end`; None at the end of the text.
        has_end: it has an `end` of its own.
    """

    word: str
    outer: str
    opener: LogicalLine
    last: LogicalLine
    follower: LogicalLine | None
    has_end: bool


class Draft:
    """A text under examination.

    Attributes:
        lexed: strings, comments and logical lines of the text that is being rewritten.
        diagnostics: findings so far, in places of the author's text.
        broken: logical lines that Python's parser must not see; they become placeholders.
        dropped: logical lines that become blank.
        ends: where blocks end whose body has lines of its own, in the order of their ends.
        headers: for each logical line that opens a block or a further clause of one,
            the index of its colon in `code(line)`; the length of the code if the colon is missing.
        marks: (line, column) of each `$ LINE`, as the author wrote it.
        secondaries: lines of `sec` headers.
    """

    __slots__ = (
        "_counts",
        "_replacements",
        "broken",
        "diagnostics",
        "dropped",
        "ends",
        "headers",
        "lexed",
        "marks",
        "options",
        "secondaries",
        "source",
        "unfolding",
    )

    def __init__(self, source: SourceFile, lexed: Lexed, options: Options, unfolding: Unfolding | None = None) -> None:
        self.source = source
        self.lexed = lexed
        self.options = options
        self.unfolding = unfolding
        self.diagnostics: list[Diagnostic] = []
        self._counts = dict.fromkeys(Severity, 0)
        self.broken: set[LogicalLine] = set()
        self.dropped: set[LogicalLine] = set()
        self.ends: list[BlockEnd] = []
        self.headers: dict[LogicalLine, int] = {}
        self.marks: set[tuple[int, int]] = set()
        self.secondaries: set[int] = set()
        self._replacements: list[Replacement] = []

    def place(self, offset: int) -> tuple[int, int]:
        """Return the author's (line, column) of an offset into the text."""
        line, column = self.lexed.place(offset)
        if self.unfolding:
            return self.unfolding.to_source(line, column)
        return line, column

    def code(self, line: LogicalLine) -> str:
        """Return the masked text of a logical line."""
        return self.lexed.masked[line.start : line.end]

    def report(
        self,
        code: str,
        start: int,
        end: int,
        text: str,
        hint: str = "",
        fix: Fix | None = None,
        severity: Severity | None = None,
    ) -> None:
        """Add a finding about the characters from `start` up to `end`, within `_MAX_FINDINGS`."""
        line, column = self.place(start)
        end_line, end_column = self.place(end)
        found = diagnostic(
            code, line, column, text, end_line=end_line, end_column=end_column, hint=hint, fix=fix, severity=severity
        )
        self._counts[found.severity] += 1
        if self._counts[found.severity] <= _MAX_FINDINGS:
            self.diagnostics.append(found)

    def tolerated(self) -> Severity:
        """Return the severity of what only this implementation accepts."""
        return Severity.ERROR if self.options.strict else Severity.WARNING

    def edit(self, start: int, end: int, text: str) -> Edit:
        """Return an edit of the author's text, for a fix."""
        return Edit(*self.place(start), *self.place(end), text)

    def replace(self, start: int, end: int, text: str) -> None:
        """Replace the characters from `start` up to `end` in the text for Python."""
        self._replacements.append(Replacement(start, end, text))

    def blank(self, start: int, end: int) -> None:
        """Replace characters of one line by blanks in the text for Python."""
        self.replace(start, end, " " * (end - start))

    def hide(self, line: LogicalLine, start: int, end: int) -> None:
        """Hide characters from Python; if they span a line end, the whole logical line."""
        if "\n" in self.lexed.text[start:end]:
            self.broken.add(line)
        else:
            self.blank(start, end)

    def is_visible(self, line: LogicalLine) -> bool:
        """Return whether Python reads the line as it is."""
        return not line.broken and line not in self.broken and line not in self.dropped

    def statements(self, line: LogicalLine) -> Iterator[tuple[int, int, str]]:
        """Yield (start, end, first word) of the header and of each simple statement of a visible line."""
        code = self.code(line)
        pieces = []
        begin = 0
        colon = self.headers.get(line, -1)
        if colon >= 0:
            pieces.append((0, min(colon, len(code))))
            begin = colon + 1
        for cut in (*top_level(code, ";", begin), len(code)):
            pieces.append((begin, cut))
            begin = cut + 1
        for begin, end in pieces:
            piece = code[begin:end]
            stripped = piece.strip()
            if stripped and self.is_visible(line):
                start = line.start + begin + len(piece) - len(piece.lstrip())
                word = compiled(NAME).match(stripped)
                yield start, start + len(stripped), word.group() if word else ""

    def find(self, pattern: str) -> Iterator[tuple[LogicalLine, re.Match[str]]]:
        """Yield at most `_MAX_MATCHES` matches of a pattern in the code of visible lines."""
        lines = self.lexed.lines
        left = _MAX_MATCHES
        for found in compiled(pattern).finditer(self.lexed.masked):
            index = bisect_right(lines, found.start(), key=lambda line: line.start) - 1
            if index >= 0 and found.start() < lines[index].end and self.is_visible(lines[index]):
                yield lines[index], found
                left -= 1
                if not left:
                    return

    def finish(self) -> tuple[str, PositionMap]:
        """Return the rewritten text and its position map. Replacements must not overlap."""
        text = self.lexed.text
        if not self._replacements:
            return text, PositionMap({}, self.unfolding)
        parts = []
        shifts: dict[int, list[_Shift]] = {}
        moved: dict[int, int] = {}
        position = 0
        for start, end, new in sorted(self._replacements):
            if start < position:
                continue
            parts.append(text[position:start])
            parts.append(new)
            position = end
            if len(new) != end - start:
                line, column = self.lexed.place(start)
                shift = _Shift(column - 1 + moved.get(line, 0), len(new), column - 1, end - start)
                shifts.setdefault(line, []).append(shift)
                moved[line] = moved.get(line, 0) + len(new) - (end - start)
        parts.append(text[position:])
        return "".join(parts), PositionMap(shifts, self.unfolding)
