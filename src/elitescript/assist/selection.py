"""Widens a selection step by step: name, expression, statement, block, function, text."""

from __future__ import annotations

import ast
import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator

from elitescript.assist.blocks import blocks
from elitescript.assist.document import Document
from elitescript.language.nodes import CHILDREN
from elitescript.lint.program import Span


def selection_ranges(document: Document, places: Iterable[tuple[int, int]]) -> tuple[tuple[Span, ...], ...]:
    """Return for each place (line, column) the ranges around it, from inside out; the last one is the whole text.

    Each range holds the one before it and is larger. Places outside the text are moved into it. Never raises.
    """
    return tuple(_around(document, *document.place(document.offset(*place))) for place in places)


def _around(document: Document, line: int, column: int) -> tuple[Span, ...]:
    place = (line, column)
    candidates = {
        span
        for span in (*_words(document, line), *_statements(document, line), *_nodes(document, place))
        if span[:2] <= place <= span[2:] and span[:2] < span[2:]
    }
    last = document.line_count
    whole = Span(1, 1, last, len(document.line(last)) + 1)
    chain: list[Span] = [whole]
    # From outside in: what is not inside the range before, or is the same, is left out.
    for span in sorted(candidates, key=lambda span: (span[:2], (-span[2], -span[3]))):
        inner = chain[-1]
        if span != inner and inner[:2] <= span[:2] and span[2:] <= inner[2:]:
            chain.append(span)
    return tuple(reversed(chain))


def _words(document: Document, line: int) -> Iterator[Span]:
    row = document.line(line)
    for found in re.finditer(r"\w+", row):
        yield Span(line, found.start() + 1, line, found.end() + 1)
    # What stands in quotes, and a comment, from text that is masked.
    code = document.code_line(line)
    for found in re.finditer('"+', code):
        start, end = found.start(), found.end()
        quotes = row[start:end].lstrip("rRbBuUfF")
        width = 3 if quotes[:3] in ('"""', "'''") else 1
        yield Span(line, end - len(quotes) + 1, line, end + 1)
        yield Span(line, end - len(quotes) + 1 + width, line, end + 1 - width)
    comment = row.find("#", len(code.rstrip()))
    if comment >= 0:
        yield Span(line, comment + 1, line, len(row.rstrip()) + 1)
    yield Span(line, len(row) - len(row.lstrip()) + 1, line, len(row.rstrip()) + 1)


def _statements(document: Document, line: int) -> Iterator[Span]:
    """Yield the logical line, and the blocks around it with and without their headers and `end`s."""
    lines = document.translation.lines
    index = bisect_right(lines, line, key=lambda logical: logical.line) - 1
    if index >= 0 and line <= lines[index].last_line:
        yield _lines(document, lines[index].line, lines[index].last_line)
    for block in blocks(document):
        if block.header.line <= line <= block.last_line:
            yield _lines(document, block.header.line, block.last_line)
            if block.header.last_line < block.last_body_line:
                yield _lines(document, block.header.last_line + 1, block.last_body_line)
        elif block.header.line > line:
            return


def _lines(document: Document, first: int, last: int) -> Span:
    row = document.line(first)
    return Span(first, len(row) - len(row.lstrip()) + 1, last, len(document.line(last).rstrip()) + 1)


def _nodes(document: Document, place: tuple[int, int]) -> Iterator[Span]:
    """Yield the ranges of the nodes that hold a place, from outside in."""
    symbols = document.symbols
    stack: list[ast.AST] = [document.parsed.tree]
    while stack:
        node = stack.pop()
        first = getattr(node, "lineno", None)
        if first is not None:
            if not first <= place[0] <= (getattr(node, "end_lineno", None) or first):
                continue
            span = Span(*symbols.range_of(node))
            if not span[:2] <= place <= span[2:]:
                continue
            # Instead of a line that could not be read the tree has something harmless of another length.
            is_written = span.line not in document.program.unread_lines
            if is_written and (span.line == span.end_line or not isinstance(node, ast.stmt)):
                yield span
        for field in CHILDREN.get(type(node), ()):
            child = getattr(node, field)
            if isinstance(child, list):
                stack.extend(item for item in child if item is not None)
            elif child is not None:
                stack.append(child)
