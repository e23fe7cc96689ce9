"""Programs with the expected place of a finding marked: `x = «0»12`."""

from __future__ import annotations

from elitescript.language.compiler import check_unit
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.options import Options
from elitescript.language.text.source import SourceFile

Range = tuple[int, int, int, int]


def unmarked(text: str) -> tuple[str, list[Range]]:
    """The text without its marks, and the (line, column, end line, end column) of each."""
    ranges = []
    while "«" in text:
        start = text.index("«")
        text = text[:start] + text[start + 1 :]
        end = text.index("»", start)
        text = text[:end] + text[end + 1 :]
        ranges.append((*_place(text, start), *_place(text, end)))
    return text, ranges


def findings(text: str, **options: object) -> list[Diagnostic]:
    """All findings about a text."""
    return list(check_unit(SourceFile("f.script", text), Options(**options)))  # type: ignore[arg-type]


def codes(text: str, **options: object) -> list[str]:
    """Codes and lines of all findings, as `E104 2`."""
    return [f"{finding.code} {finding.line}" for finding in findings(text, **options)]


def range_of(finding: Diagnostic) -> Range:
    return finding.line, finding.column, finding.end_line, finding.end_column


def check_marks(code: str, text: str, **options: object) -> list[Diagnostic]:
    """Assert that the findings are of one code and cover exactly the marked places."""
    plain, ranges = unmarked(text)
    found = findings(plain, **options)
    assert [(finding.code, range_of(finding)) for finding in found] == [(code, place) for place in ranges]
    return found


def _place(text: str, offset: int) -> tuple[int, int]:
    return text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset)
