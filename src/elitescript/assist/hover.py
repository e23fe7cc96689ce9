"""Explains what stands at a place: a command, an argument, a name, a number, a signal."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.lint.program import Span
from elitescript.records import record


@record
class Hover:
    """An explanation.

    Attributes:
        span: what it is about.
        markdown: the text.
    """

    span: Span
    markdown: str


def hover(document: Document, line: int, column: int, last_run: LastRun | None = None) -> Hover | None:
    """Return what is known of the text at a place; None if that is nothing. Never raises."""
    return None
