"""Lays out the text of a program: indentation, `end`s, blanks; what runs, and in which line, stays the same.

No line is added or removed, but empty ones at the end of the text: so alarms, breakpoints, coverage and the numbers
that people have written down stay true. The text of strings, comments and `$ LINE` marks stays as it is. What somebody
has laid out over several lines keeps its inside.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

from elitescript.assist.document import Document
from elitescript.assist.spacing import spaced
from elitescript.language.diagnostics import Diagnostic, Edit
from elitescript.language.parser import Parsed
from elitescript.language.text.flat import INDENT
from elitescript.language.text.lexer import STRING_FILL, LogicalLine, indentation_width
from elitescript.language.text.source import BOM
from elitescript.lint.program import Span
from elitescript.records import NamedTuple

_BLANKS: Final = " \t\f"
_COMMENT_GAP: Final = 2
"""Least number of blanks between code and the comment behind it."""
_BESIDE_LAYOUT: Final = "W210"
"""About the inside of a string, which layout does not touch."""


class Formatted(NamedTuple):
    """What became of a text.

    Attributes:
        text: laid out; the same text if it cannot be read, or is left as it is.
        problems: the errors that keep it from being read, in the order of the text.
        is_left: the pendant has written it, and such texts are not asked to be formatted.
        changed_line: the first line that would run in another way, 0 for none; then the text is left as it is. Such a
            line is a mistake of this module.
    """

    text: str
    problems: tuple[Diagnostic, ...] = ()
    is_left: bool = False
    changed_line: int = 0


def formatted(text: str, name: str = "", *, pendant: bool = False) -> Formatted:
    """Lay out a text. Line ends and a byte order mark stay as they are.

    Args:
        text: as it stands in the file.
        name: of the file, for the problems.
        pendant: whether to format a text that the pendant has written, too.
    """
    document = Document(name, text)
    if problems := tuple(problem for problem in document.parsed.diagnostics if problem.is_error):
        return Formatted(text, problems)
    if not pendant and is_generated(document.parsed):
        return Formatted(text, is_left=True)
    rows = _Layout(document, None).rows()
    if line := _changed_line(document, rows):
        return Formatted(text, changed_line=line)
    mark = BOM if text.startswith(BOM) else ""
    ends = _line_end().findall(text)
    del rows[_last_row(rows) :]
    if not rows:
        return Formatted(mark)
    if len(ends) < len(rows):
        ends.append(ends[0] if ends else "\n")
    return Formatted(mark + "".join(row + end for row, end in zip(rows, ends, strict=False)))


def format_edits(document: Document, span: Span | None = None, *, pendant: bool = False) -> tuple[Edit, ...]:
    """Return the edits that lay out a document, or the lines of it that a span touches.

    They all refer to the text as it is, do not overlap, and come in its order. A block keeps its indentation unless the
    span holds all of it. There are none if the text cannot be read, if the pendant has written it and `pendant` is
    not set, or if a line would run in another way.
    """
    if document.parsed.has_errors or (not pendant and is_generated(document.parsed)):
        return ()
    within = None
    if span is not None:
        # A selection of whole lines ends at the start of the line below them.
        is_line_start = span.end_column == 1 and span.end_line > span.line
        within = (span.line, span.end_line - is_line_start)
    edits = []
    rows = _Layout(document, within).rows()
    if _changed_line(document, rows):
        return ()
    for number, (old, new) in enumerate(zip(document.source.lines, rows, strict=True), 1):
        if old != new:
            edits.append(_row_edit(number, old, new))
    if within is None:
        last, end = _last_row(rows), document.line_count
        end_column = len(document.line(end)) + 1
        if last == end:
            edits.append(Edit(end, end_column, end, end_column, "\n"))
        elif (end, end_column) > (last + 1, 1):
            edits = [edit for edit in edits if edit.line <= last]
            edits.append(Edit(last + 1, 1, end, end_column, ""))
    return tuple(edits)


def _changed_line(document: Document, rows: Sequence[str]) -> int:
    """Return the first line that would run in another way in the new rows; 0 if none does."""
    if document.source.lines == tuple(rows):
        return 0
    after = Document(document.source.name, "\n".join(rows)).parsed
    if after.has_errors:
        return next(problem.line for problem in after.diagnostics if problem.is_error)
    return _difference(document.parsed.tree, after.tree)


def _difference(one: ast.AST, other: ast.AST) -> int:
    """Return the line where two trees begin to differ, but for columns; 0 if they do not."""
    line = 1
    pending: list[tuple[Any, Any]] = [(one, other)]
    while pending:
        a, b = pending.pop()
        if type(a) is not type(b):
            return line
        if isinstance(a, ast.AST):
            line = getattr(a, "lineno", line)
            if line != getattr(b, "lineno", line):
                return line
            pending += [(getattr(a, field, None), getattr(b, field, None)) for field in reversed(a._fields)]
        elif isinstance(a, list):
            if len(a) != len(b):
                return line
            pending += zip(reversed(a), reversed(b), strict=True)
        elif a != b:
            return line
    return 0


def _last_row(rows: Sequence[str]) -> int:
    """Return the number of the last row that is to stay: blank ones at the end go, but not behind a backslash."""
    last = len(rows)
    while last and not rows[last - 1] and not (last > 1 and rows[last - 2].endswith("\\")):
        last -= 1
    return last


def is_generated(parsed: Parsed) -> bool:
    """Return whether the pendant has written a text: it has marks of its program tree. *Assumed*: people write none."""
    return parsed.has_line_marks or any(
        line.word == "labelmsg" and _old_mark().match(parsed.source.text, line.start) is not None
        for line in parsed.translation.lines
    )


@cache
def _line_end() -> re.Pattern[str]:
    return re.compile(r"\r\n|\r|\n")


@cache
def _old_mark() -> re.Pattern[str]:
    return re.compile(r"labelmsg\(\d+, ?[\"']")


def _row_edit(number: int, old: str, new: str) -> Edit:
    """Return the shortest edit that makes `new` of the line `old`."""
    most = min(len(old), len(new))
    head = next((index for index in range(most) if old[index] != new[index]), most)
    most -= head
    tail = next((index for index in range(most) if old[-1 - index] != new[-1 - index]), most)
    return Edit(number, head + 1, number, len(old) - tail + 1, new[head : len(new) - tail])


class _Level:
    """An indentation that lines have in common."""

    __slots__ = ("blanks", "column", "end", "first", "outer")

    def __init__(self, outer: _Level | None, column: int, first: int) -> None:
        self.outer = outer
        self.column = column
        self.blanks = ""
        """The blanks that its lines shall begin with."""
        self.first = first
        """Its first physical line."""
        self.end = first
        """Its last physical line; those of the blocks inside it are between."""


class _Trailing(NamedTuple):
    """A comment behind code, or one that goes on with such a comment in the line below it."""

    row: int
    column: int
    """Where it stood, from 0."""
    gap: int
    """Blanks between the code and it, as they were."""
    code: str
    """The code before it, laid out."""
    text: str


class _Layout:
    """Lays out the rows of a text that Python can read.

    Args:
        document: the text.
        within: the first and the last line to change; None for all.
    """

    __slots__ = ("_is_split", "_levels", "_lines", "_masked", "_rows", "_text", "_trailing", "document", "within")

    def __init__(self, document: Document, within: tuple[int, int] | None) -> None:
        self.document = document
        self.within = within
        self._text = document.source.text
        self._masked = document.translation.masked
        self._lines: Sequence[LogicalLine] = document.translation.lines
        self._levels: list[_Level] = []
        """The level of each logical line."""
        self._rows = list(document.source.lines)
        self._is_split = self._has_split_indentation()
        """Rows keep their indentation."""
        self._trailing: list[_Trailing] = []

    def rows(self) -> list[str]:
        """Return the lines of the text, laid out, as many as there were."""
        self._read_levels()
        old = self.document.source.lines
        headers = {line.line for line in self.document.translation.headers}
        kept = {problem.line for problem in self.document.translation.diagnostics if problem.code != _BESIDE_LAYOUT}
        done = 0
        for index, line in enumerate(self._lines):
            self._between(done + 1, line.line, index)
            is_header = line.line in headers
            if line.line == line.last_line:
                self._row(line, self._levels[index], is_header, line.line in kept)
            else:
                is_kept = not kept.isdisjoint(range(line.line, line.last_line + 1))
                self._several(line, self._levels[index], is_header, is_kept)
            done = line.last_line
        self._between(done + 1, len(old) + 1, len(self._lines))
        self._place_trailing()
        if self.within is not None:
            first, last = self.within
            return [new if first <= n <= last else old[n - 1] for n, new in enumerate(self._rows, 1)]
        return self._rows

    # Indentation

    def _read_levels(self) -> None:
        last_row = len(self._rows)
        level = _Level(None, 0, 1)
        level.end = last_row
        found = [level]
        for line in self._lines:
            while level.outer is not None and line.column < level.column:
                level.end = line.line - 1
                level = level.outer
            if line.column > level.column:
                level = _Level(level, line.column, line.line)
                found.append(level)
            self._levels.append(level)
            inner: _Level | None = level
            while inner is not None and inner.end < line.last_line:
                inner.end = line.last_line
                inner = inner.outer
        for level in found:
            if level.outer is None:
                continue
            is_whole = self.within is None or (self.within[0] <= level.first and level.end <= self.within[1])
            if is_whole:
                level.blanks = level.outer.blanks + INDENT
            else:
                row = self._rows[level.first - 1]
                level.blanks = row[: len(row) - len(row.lstrip(_BLANKS))].rpartition("\f")[2]

    def _has_split_indentation(self) -> bool:
        """Return whether a line begins with a backslash, so that its indentation is that of another line."""
        if "\\\n" not in self._text:
            return False
        starts, ends = self.document.source_starts, [line.last_line for line in self._lines]
        return any(
            self._text[starts[line.line - 2] : starts[line.line - 1]].strip(_BLANKS + "\n") == "\\"
            for line, before in zip(self._lines, [0, *ends], strict=False)
            if line.line - 1 > before
        )

    # Rows between logical lines

    def _between(self, first: int, end: int, index: int) -> None:
        """Lay out comments and blank rows before logical line `index`: rows `first` up to `end`, not included."""
        old = self.document.source.lines
        for number in range(first, end):
            row = old[number - 1]
            text = row.strip(_BLANKS)
            if not text.startswith("#"):
                # A backslash alone may begin the statement below it.
                self._rows[number - 1] = row if text else ""
                continue
            column = indentation_width(row[: row.index("#")])
            before = self._trailing[-1] if self._trailing else None
            if before is not None and before.row == number - 1 and before.column == column:
                # It goes on with the comment behind the code above it.
                self._trailing.append(_Trailing(number, column, column, "", text))
            elif self._is_split:
                self._rows[number - 1] = row.rstrip(_BLANKS)
            else:
                self._rows[number - 1] = self._comment_level(index, column).blanks + text

    def _comment_level(self, index: int, column: int) -> _Level:
        """Return the level of a comment before logical line `index`: not less than that of the line."""
        following = self._levels[index] if index < len(self._levels) else None
        if index == 0:
            return following or _Level(None, 0, 1)
        level = self._levels[index - 1]
        if following is not None and following.column > level.column:
            return following
        least = following.column if following is not None else 0
        while level.outer is not None and level.outer.column >= max(column, least):
            level = level.outer
        return level

    # Logical lines

    def _blanks(self, line: LogicalLine, level: _Level) -> tuple[str, int]:
        """Return the blanks that a line is to begin with, and the column at which it begins in its row as it is."""
        if not self._is_split:
            return level.blanks, line.column
        own = self._text[self.document.source_starts[line.line - 1] : line.start]
        return own, indentation_width(own)

    def _row(self, line: LogicalLine, level: _Level, is_header: bool, is_kept: bool) -> None:
        """Lay out a logical line in one row."""
        text, end = self._text, line.end
        row_start = self.document.source_starts[line.line - 1]
        stop = row_start + len(self.document.source.lines[line.line - 1])
        code = text[line.start : end]
        rest = text[end:stop].strip(_BLANKS)
        new, _ = self._blanks(line, level)
        if is_kept:
            new += code
        else:
            new += spaced(code, self._masked[line.start : end], is_header)
        if not rest:
            self._rows[line.line - 1] = new
        elif rest[0] != "#":
            self._rows[line.line - 1] = new + text[end:stop]
        else:
            before = text[row_start : text.index("#", end)]
            column = len(before.expandtabs()) if "\t" in before else len(before)
            gap = column - len(before.rstrip(_BLANKS).expandtabs())
            self._trailing.append(_Trailing(line.line, column, gap, new, rest))

    def _several(self, line: LogicalLine, level: _Level, is_header: bool, is_kept: bool) -> None:
        """Lay out a logical line in several rows: its beginning, and the indentation of the others."""
        masked, starts = self._masked, self.document.source_starts
        stop = starts[line.line] - 1
        split = self._inside(line, stop)
        moved = 0
        head = self._text[line.start : split]
        if not is_kept:
            new = spaced(head, masked[line.start : split], is_header)
            moved = len(new) - len(head)
            head = new
        tail = self._text[split:stop]
        blanks, column = self._blanks(line, level)
        self._rows[line.line - 1] = blanks + head + self._without_end_blanks(tail, stop)
        shift = indentation_width(blanks) - column
        deltas: dict[int, int] = {}
        self._note_brackets(line.start, split, stop, column, shift + moved, deltas)
        for number in range(line.line + 1, line.last_line + 1):
            start = starts[number - 1]
            if masked[start - 1] == STRING_FILL:
                continue
            row = self.document.source.lines[number - 1]
            stop = start + len(row)
            text = row.lstrip(_BLANKS)
            width = indentation_width(row[: len(row) - len(text)])
            delta = deltas.get(width, shift)
            code = start + len(row) - len(text)
            text = self._without_end_blanks(text, stop)
            self._rows[number - 1] = " " * max(0, width + delta) + text if text else ""
            self._note_brackets(code, code, stop, width, delta, deltas)

    def _inside(self, line: LogicalLine, stop: int) -> int:
        """Return the offset behind the outermost bracket that is open at the end of the first row, or of its code."""
        masked = self._masked
        open_at = []
        for offset in range(line.start, stop):
            character = masked[offset]
            if character in "([{":
                open_at.append(offset)
            elif character in ")]}":
                open_at.pop()
        if open_at:
            return open_at[0] + 1
        return line.start + len(masked[line.start : stop].rstrip(_BLANKS))

    def _note_brackets(
        self, start: int, split: int, stop: int, column: int, delta: int, deltas: dict[int, int]
    ) -> None:
        """Note how far the column behind each bracket of a row moves; rows below may be aligned with it."""
        masked = self._masked
        for offset in range(max(start, split - 1), stop):
            if masked[offset] in "([{":
                deltas[column + offset - start + 1] = delta

    def _without_end_blanks(self, text: str, stop: int) -> str:
        """Return the end of a row without blanks, unless they belong to a string."""
        masked = self._masked
        return text if stop < len(masked) and masked[stop] == STRING_FILL else text.rstrip(_BLANKS)

    # Comments behind code

    def _place_trailing(self) -> None:
        """Put comments behind their code; those that stood in one column below each other stay in one."""
        group: list[_Trailing] = []
        for comment in self._trailing:
            if group and (comment.row != group[-1].row + 1 or comment.column != group[-1].column):
                self._place_group(group)
                group = []
            group.append(comment)
        if group:
            self._place_group(group)

    def _place_group(self, group: list[_Trailing]) -> None:
        with_code = [comment for comment in group if comment.code]
        gap = max(_COMMENT_GAP, min(comment.gap for comment in with_code))
        column = max(len(comment.code) for comment in with_code) + gap
        for comment in group:
            self._rows[comment.row - 1] = comment.code.ljust(column) + comment.text
