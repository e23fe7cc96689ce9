"""Findings about a text: place, problem, hint and repair."""

from __future__ import annotations

from enum import StrEnum
from typing import Any, Final

from elitescript.errors import CODES
from elitescript.records import NamedTuple, record
from elitescript.said import parts_of
from elitescript.shown import shown

LINE_SHOWN: Final = 160
"""Characters of a line that are shown with a finding."""


LINE_KEPT: Final = 1000
"""Characters of a line that an alarm keeps."""


class Outdated(Exception):
    """The text that is looked at has changed meanwhile, so that what is found in it is of no use."""


class Severity(StrEnum):
    """Severity of a finding. An error keeps the program from starting; a note is no problem, only worth knowing."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Edit(NamedTuple):
    """Replace the text from (line, column) up to, not including, (end_line, end_column).

    Lines and columns count from 1, columns in characters.
    """

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class Fix(NamedTuple):
    """A repair that a tool can make.

    `safe`: the repaired text certainly means what the author meant.
    """

    title: str
    edits: tuple[Edit, ...]
    safe: bool


@record
class Diagnostic:
    """A finding.

    Lines and columns count from 1, columns in characters; the end is exclusive. `hint` is
    empty when there is nothing to advise.
    """

    code: str
    severity: Severity
    line: int
    column: int
    end_line: int
    end_column: int
    text: str
    hint: str = ""
    fix: Fix | None = None

    @property
    def is_error(self) -> bool:
        return self.severity is Severity.ERROR

    @property
    def keeps_from_starting(self) -> bool:
        """Whether the program cannot start. What contradicts the catalogue (E3xx) is raised, and may be caught."""
        return self.is_error and not self.code.startswith("E3")

    def __str__(self) -> str:
        return f"line {self.line}, column {self.column}: {self.severity} {self.code}: {self.text}"


def diagnostic(
    code: str,
    line: int,
    column: int,
    text: str,
    *,
    end_line: int | None = None,
    end_column: int | None = None,
    hint: str = "",
    fix: Fix | None = None,
    severity: Severity | None = None,
) -> Diagnostic:
    """Make a `Diagnostic` whose severity is that of its row in `errors.CODES`.

    Without an end it covers one character.
    """
    if severity is None:
        severity = Severity(CODES[code].severity)
    if end_line is None:
        end_line = line
    if end_column is None:
        end_column = column + 1
    return Diagnostic(code, severity, line, column, end_line, end_column, text, hint, fix)


def in_order(diagnostics: tuple[Diagnostic, ...] | list[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Sort by place in the text; at the same place errors come first."""
    return tuple(sorted(diagnostics, key=lambda d: (d.line, d.column, d.severity, d.code)))


def render(diagnostic: Diagnostic, place: str, line: str) -> str:
    """Format a finding as text: place, message, the line with a caret under it, the hint; nothing in it acts.

    Args:
        diagnostic: the finding.
        place: where it is, as `SourceFile.where` returns it.
        line: the line of the text in which the finding begins.
    """
    rows = [f"{place}: {diagnostic.severity} {diagnostic.code}: {shown(diagnostic.text)}"]
    if line.strip():
        around, cut = excerpt(line.rstrip(), diagnostic.column)
        rows.append(f"    {shown(around)}")
        rows.append(f"    {_carets(diagnostic, around, cut)}")
    if diagnostic.hint:
        rows.append(f"hint: {shown(diagnostic.hint)}")
    return "\n".join(rows)


def to_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """Return the `problem` object that the command line prints with `--json`."""
    return {
        "type": "problem",
        "severity": str(diagnostic.severity),
        "code": diagnostic.code,
        "line": diagnostic.line,
        "column": diagnostic.column,
        "text": diagnostic.text,
        "hint": diagnostic.hint,
        **parts_of(diagnostic.text),
        **parts_of(diagnostic.hint, "hint_"),
    }


def excerpt(line: str, column: int) -> tuple[str, int]:
    """Return what is shown of a line around a column, and by how many characters places in it move to the left."""
    if len(line) <= LINE_SHOWN:
        return line, 0
    start = max(0, min(column - 1 - LINE_SHOWN // 2, len(line) - LINE_SHOWN))
    end = start + LINE_SHOWN
    before, after = "..." if start else "", "..." if end < len(line) else ""
    return f"{before}{line[start:end]}{after}", start - len(before)


def line_kept(line: str, column: int) -> str:
    """Return what an alarm keeps of the line in which it came: of a very long one, what is around a column.

    What was cut off is dots; columns count in the whole line, and stand under no such excerpt but one of its beginning.
    """
    if len(line) <= LINE_KEPT:
        return line
    if column < LINE_KEPT:
        return f"{line[:LINE_KEPT]}..."
    return excerpt(line, column)[0]


def _carets(diagnostic: Diagnostic, line: str, cut: int) -> str:
    start = diagnostic.column - 1 - cut
    end = min(diagnostic.end_column - 1 - cut, len(line)) if diagnostic.end_line == diagnostic.line else len(line)
    width = max(1, sum(map(_cells, shown(line[start:end]))))
    return "".join("\t" if c == "\t" else " " * _cells(c) for c in shown(line[:start])) + "^" * width


def _cells(character: str) -> int:
    """Return the terminal cells of one character: two for wide East Asian ones."""
    if character.isascii():
        return 1
    import unicodedata

    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
