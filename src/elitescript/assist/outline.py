"""Lists what a text defines: programs, functions, threads, classes and nodes of the pendant's program tree.

It is made from the headers of blocks and where they end, which are known of texts that Python cannot read, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from enum import StrEnum
from typing import Final

from elitescript.assist.blocks import blocks
from elitescript.assist.document import Document
from elitescript.language.text.lexer import NAME, LogicalLine
from elitescript.language.text.masked import header_colon
from elitescript.lint.program import Span
from elitescript.records import NamedTuple, record


class SymbolKind(StrEnum):
    """What a symbol is."""

    PROGRAM = "program"
    """The outer `def` of a program."""
    SECONDARY = "secondary"
    """A `sec`."""
    FUNCTION = "function"
    THREAD = "thread"
    """A function that is given to `start_thread`."""
    CLASS = "class"
    METHOD = "method"
    NODE = "node"
    """What a `$ LINE` mark begins."""


@record
class Symbol:
    """One symbol.

    Attributes:
        name: the name; of a node its label.
        kind: what it is.
        detail: parameters of a function, number of a node; may be empty.
        span: all of it, with its `end`.
        name_span: its name, inside `span`.
        children: what is inside it, in the order of the text.
    """

    name: str
    kind: SymbolKind
    detail: str
    span: Span
    name_span: Span
    children: tuple[Symbol, ...] = ()


class FoundSymbol(NamedTuple):
    """A symbol that a search found.

    Attributes:
        document: name of its document.
        symbol: the symbol.
        container: name of the symbol around it; empty if there is none.
    """

    document: str
    symbol: Symbol
    container: str


_DEFINITION: Final = re.compile(rf"(?:async[ \t]+)?(def|sec|class|thread)[ \t]+({NAME})")
_MARK: Final = re.compile(r"""\$[ \t]*LINE[ \t]*:[ \t]*\([ \t]*(\d+)[ \t]*,[ \t]*(["'])(.*?)(?<!\\)\2[ \t]*(,?)""")
_KINDS: Final = {
    "def": SymbolKind.FUNCTION,
    "sec": SymbolKind.SECONDARY,
    "thread": SymbolKind.THREAD,
    "class": SymbolKind.CLASS,
}


class _Draft:
    """A symbol that is being made."""

    __slots__ = ("children", "detail", "kind", "last_line", "name", "name_span", "start")

    def __init__(self, name: str, kind: SymbolKind, detail: str, start: tuple[int, int], name_span: Span) -> None:
        self.name = name
        self.kind = kind
        self.detail = detail
        self.start = start
        self.name_span = name_span
        self.last_line = start[0]
        self.children: list[_Draft] = []


def document_symbols(document: Document) -> tuple[Symbol, ...]:
    """Return the symbols of a text, in its order. Never raises."""
    return document.once(_document_symbols)


def _document_symbols(document: Document) -> tuple[Symbol, ...]:
    roots: list[_Draft] = []
    around: list[_Draft] = []
    for draft in sorted([*_definitions(document), *_nodes(document)], key=lambda draft: draft.start):
        while around and draft.start[0] > around[-1].last_line:
            around.pop()
        if draft.kind is SymbolKind.FUNCTION and around and around[-1].kind is SymbolKind.CLASS:
            draft.kind = SymbolKind.METHOD
        (around[-1].children if around else roots).append(draft)
        around.append(draft)
    if document.parsed.unit is not None or not document.parsed.is_complete:
        for draft in roots:
            if len(roots) == 1 and draft.kind in (SymbolKind.FUNCTION, SymbolKind.THREAD):
                draft.kind = SymbolKind.PROGRAM
    return tuple(_symbol(document, draft) for draft in roots)


def _symbol(document: Document, draft: _Draft) -> Symbol:
    last = draft.last_line
    span = Span(*draft.start, last, len(document.line(last).rstrip()) + 1)
    children = tuple(_symbol(document, child) for child in draft.children)
    return Symbol(draft.name, draft.kind, draft.detail, span, draft.name_span, children)


def _definitions(document: Document) -> Iterator[_Draft]:
    translation = document.translation
    threads = _thread_lines(document)
    last_lines = {block.header: block.last_line for block in blocks(document)}
    for line in translation.headers:
        code = translation.masked[line.start : line.end]
        found = _DEFINITION.match(code)
        if found is None:
            continue
        column = line.start - document.parsed.source.text.rfind("\n", 0, line.start)
        kind = SymbolKind.THREAD if line.line in threads else _KINDS[found[1]]
        name_span = Span(line.line, column + found.start(2), line.line, column + found.end(2))
        draft = _Draft(found[2], kind, _parameters(document, line, code), (line.line, column), name_span)
        draft.last_line = last_lines.get(line, line.last_line)
        yield draft


def _thread_lines(document: Document) -> set[int]:
    """Return the lines of the functions that are given to `start_thread`."""
    names = document.names
    return {node.lineno for _, name in names.thread_starts for node in names.functions(name.entity)}


def _parameters(document: Document, line: LogicalLine, code: str) -> str:
    """Return what stands in the brackets behind the name of a definition, in one line."""
    opening = code.find("(")
    closing = code.rfind(")", 0, header_colon(code) + 1 or len(code))
    if not 0 <= opening < closing:
        return ""
    text = document.parsed.source.text[line.start + opening : line.start + closing + 1]
    return " ".join(text.split())


def _nodes(document: Document) -> Iterator[_Draft]:
    """Yield the nodes: each lasts to the next mark that is not deeper, or to the end of the block around it."""
    translation = document.translation
    if not translation.marks:
        return
    places: dict[int, list[int]] = {}
    for line, column in translation.marks:
        places.setdefault(line, []).append(column)
    around: list[tuple[int, _Draft]] = []
    before = 0
    for logical in translation.lines:
        columns = sorted(places.get(logical.line, ()))
        while around and (logical.column < around[-1][0] or (columns and logical.column == around[-1][0])):
            around.pop()[1].last_line = before
        for column in columns:
            found = _MARK.match(document.line(logical.line), column - 1)
            # A mark with a third element stands behind its node.
            if found is not None and not found[4]:
                name_span = Span(logical.line, found.start(3) + 1, logical.line, found.end(3) + 1)
                draft = _Draft(found[3] or found[1], SymbolKind.NODE, found[1], (logical.line, column), name_span)
                around.append((logical.column, draft))
                yield draft
        before = logical.last_line
    for _, draft in around:
        draft.last_line = before


def workspace_symbols(documents: Iterable[Document], query: str, limit: int = 200) -> tuple[FoundSymbol, ...]:
    """Return symbols whose names contain the characters of a query in this order, best matches first.

    Upper and lower case count alike. An empty query finds all, within the limit. Never raises.
    """
    wanted = query.strip().lower()
    found = []
    for document in documents:
        for symbol, container in _walk(document_symbols(document), ""):
            rank = _rank(symbol.name.lower(), wanted)
            if rank is not None:
                place = (rank, len(symbol.name) if wanted else 0, symbol.name, document.name, symbol.span)
                found.append((place, FoundSymbol(document.name, symbol, container)))
    found.sort(key=lambda item: item[0])
    return tuple(item for _, item in found[:limit])


def _walk(symbols: Iterable[Symbol], container: str) -> Iterator[tuple[Symbol, str]]:
    for symbol in symbols:
        yield symbol, container
        yield from _walk(symbol.children, symbol.name)


def _rank(name: str, wanted: str) -> int | None:
    """Return how well a name fits, 0 best; None if it does not."""
    if wanted in name:
        return 0 if name == wanted else 1 if name.startswith(wanted) else 2
    characters = iter(name)
    return 3 if all(character in characters for character in wanted) else None
