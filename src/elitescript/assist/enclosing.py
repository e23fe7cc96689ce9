"""Finds the blocks, functions and scopes around a place, also on lines without code."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.language.scopes import Scope
from elitescript.language.text.rewriting import BlockEnd
from elitescript.records import NamedTuple


class Block(NamedTuple):
    """A block around a place.

    Attributes:
        word: its keyword.
        line: of its header, from 1.
        column: of its header, from 1.
        has_end: it has an `end`.
        end_line: last line that can belong to it, its `end` included.
    """

    word: str
    line: int
    column: int
    has_end: bool
    end_line: int


def blocks_around(document: Document, line: int, column: int) -> tuple[Block, ...]:
    """Return the blocks whose bodies hold a place, or could if something were written there; outer ones first."""
    found = []
    for end in document.translation.ends:
        first = end.opener.line
        if first < line <= _last_line(document, end) and (
            line <= end.last.last_line or end.has_end or column > _column(document, first)
        ):
            column_of_header = _column(document, first)
            found.append(Block(end.word, first, column_of_header, end.has_end, _last_line(document, end)))
    return tuple(sorted(found, key=lambda block: (block.line, -block.end_line)))


def scope_at(document: Document, line: int, column: int) -> Scope:
    """Return the innermost scope that holds a place; the header of a function belongs to it."""
    scopes = _function_scopes(document)
    scope = document.symbols.body
    for block in blocks_around(document, line, column):
        scope = scopes.get(block.line, scope)
    inner: Scope | None = scopes.get(line, scope)
    while inner is not None:
        scope = inner
        inner = next((child for child in scope.children if _is_inside(document, child, line, column)), None)
    return scope


def _is_inside(document: Document, scope: Scope, line: int, column: int) -> bool:
    """Return whether a place is inside a lambda or comprehension."""
    if scope.kind not in ("lambda", "comprehension"):
        return False
    first_line, first, last_line, end = document.symbols.range_of(scope.node)
    return (first_line, first) <= (line, column) <= (last_line, end)


def _function_scopes(document: Document) -> dict[int, Scope]:
    """Return the scopes of functions and classes by the line of their header."""
    return {
        scope.node.lineno: scope  # type: ignore[attr-defined]
        for scope in document.symbols.scopes
        if scope.kind in ("function", "class")
    }


def indentation_step(document: Document) -> int:
    """Return the width of one level of indentation: that of the first block, else two."""
    for end in document.translation.ends:
        if end.opener.last_line < end.last.line:
            lines = document.translation.lines
            body = next((line for line in lines if line.start > end.opener.start), None)
            if body is not None and body.column > end.opener.column:
                return body.column - end.opener.column
    return 2


def _last_line(document: Document, end: BlockEnd) -> int:
    if end.follower is None:
        return document.line_count
    return end.follower.line if end.has_end else end.follower.line - 1


def _column(document: Document, line: int) -> int:
    row = document.line(line)
    return len(row) - len(row.lstrip()) + 1
