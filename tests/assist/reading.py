"""Helpers of the tests: texts with marked places."""

from __future__ import annotations

from elitescript.assist.document import Document, Settings
from elitescript.lint.program import Span

MARK = "¦"


def marked(text: str, settings: Settings | None = None) -> tuple[Document, int, int]:
    """Return a document and the place that is marked in its text."""
    before, _, after = text.partition(MARK)
    line = before.count("\n") + 1
    column = len(before) - before.rfind("\n")
    return Document("cell.script", before + after, 1, settings), line, column


def cut(document: Document, span: Span) -> str:
    """Return `line:text` of a range on one line."""
    assert span.line == span.end_line
    return f"{span.line}:{document.line(span.line)[span.column - 1 : span.end_column - 1]}"


def places(document: Document, spans: list[Span] | tuple[Span, ...]) -> list[str]:
    """Return `line:column` of ranges."""
    del document
    return [f"{span.line}:{span.column}" for span in spans]
