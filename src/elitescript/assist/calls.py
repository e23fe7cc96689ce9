"""Finds who calls a function, who starts it as a thread, and what it calls itself."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from pathlib import PurePosixPath

from elitescript.assist.document import Document
from elitescript.assist.names import Entity, EntityKind, Occurrence
from elitescript.assist.outline import Symbol, SymbolKind, document_symbols
from elitescript.language.symbols import Scope
from elitescript.lint.program import Span
from elitescript.records import NamedTuple, record


@record
class CallItem:
    """A function of a text, or the text itself, as caller or as what is called.

    Attributes:
        name: the name; of a script the last part of the name of the document.
        kind: what it is.
        detail: its parameters; may be empty.
        span: all of it.
        name_span: its name, inside `span`; it identifies the item in this version of the text.
    """

    name: str
    kind: SymbolKind
    detail: str
    span: Span
    name_span: Span


class Call(NamedTuple):
    """The calls between two functions.

    Attributes:
        item: the function at the other end.
        spans: where the calls stand, all in the caller: the name that is called or started.
        is_thread_start: they are calls of `start_thread`.
    """

    item: CallItem
    spans: tuple[Span, ...]
    is_thread_start: bool


def prepare(document: Document, line: int, column: int) -> tuple[CallItem, ...]:
    """Return the functions that the name at a place stands for; empty if it is no function. Never raises."""
    found = document.names.at(line, column)
    return tuple(_items(document, found.entity)) if found is not None else ()


def incoming(document: Document, item: CallItem) -> tuple[Call, ...]:
    """Return who calls or starts a function, in the order of the text. Never raises."""
    called = document.names.at(*item.name_span[:2])
    if called is None or item.name_span == _WHOLE:
        return ()
    uses = document.once(_uses).get(called.entity, ())
    return _grouped((_caller(document, use.name.scope), use) for use in uses)


def outgoing(document: Document, item: CallItem) -> tuple[Call, ...]:
    """Return what a function of the program calls or starts, in the order of the text. Never raises."""
    uses = document.once(_uses_by_caller).get(item.name_span, ())
    return _grouped((target, use) for use in uses for target in _items(document, use.name.entity))


class _Use(NamedTuple):
    """A name that is called, or given to `start_thread`."""

    name: Occurrence
    is_thread_start: bool


_WHOLE = Span(1, 1, 1, 1)
"""Where the name of a script stands, which has none."""


def _uses(document: Document) -> dict[Entity, list[_Use]]:
    """Return the calls by what is called, each in the order of the text."""
    names = document.names
    started = {name.span for _, name in names.thread_starts}
    found: dict[Entity, list[_Use]] = {}
    for item in names.occurrences:
        if item.role in ("read", "attribute"):
            above = names.symbols.parent(item.node)
            is_called = isinstance(above, ast.Call) and above.func is item.node
            if is_called or item.span in started:
                found.setdefault(item.entity, []).append(_Use(item, item.span in started))
    return found


def _uses_by_caller(document: Document) -> dict[Span, list[_Use]]:
    """Return the calls by the name of the function in which they stand, each in the order of the text."""
    found: dict[Span, list[_Use]] = {}
    for use in sorted((use for uses in document.once(_uses).values() for use in uses), key=lambda use: use.name.span):
        found.setdefault(_caller(document, use.name.scope).name_span, []).append(use)
    return found


def _grouped(pairs: Iterable[tuple[CallItem, _Use]]) -> tuple[Call, ...]:
    spans: dict[tuple[Span, bool], list[Span]] = {}
    items = {}
    for item, use in pairs:
        key = (item.name_span, use.is_thread_start)
        items[key] = item
        spans.setdefault(key, []).append(use.name.span)
    return tuple(Call(items[key], tuple(found), key[1]) for key, found in spans.items())


def _items(document: Document, entity: Entity) -> Iterator[CallItem]:
    items = document.once(_all_items)
    for place in document.names.of(entity):
        if place.role in ("def", "label") and place.span in items:
            yield items[place.span]


def _caller(document: Document, scope: Scope) -> CallItem:
    """Return the function in which a scope lies; the program if there is none."""
    items = document.once(_all_items)
    around: Scope | None = scope
    while around is not None:
        if around.kind == "function":
            span = document.names.defined_at(around)
            if span in items:
                return items[span]
        around = around.parent
    return _program(document, items)


def _program(document: Document, items: dict[Span, CallItem]) -> CallItem:
    label = Entity(EntityKind.LABEL, document.parsed.name)
    for place in document.names.of(label):
        if place.role == "label" and place.span in items:
            return items[place.span]
    name = PurePosixPath(document.name).name or document.name
    last = document.line_count
    return CallItem(name, SymbolKind.PROGRAM, "", Span(1, 1, last, len(document.line(last)) + 1), _WHOLE)


def _all_items(document: Document) -> dict[Span, CallItem]:
    """Return the functions of the text by the places of their names."""

    def walk(symbols: tuple[Symbol, ...]) -> Iterator[Symbol]:
        for symbol in symbols:
            yield symbol
            yield from walk(symbol.children)

    return {
        symbol.name_span: CallItem(symbol.name, symbol.kind, symbol.detail, symbol.span, symbol.name_span)
        for symbol in walk(document_symbols(document))
        if symbol.kind not in (SymbolKind.NODE, SymbolKind.CLASS)
    }
