"""Lists what a text defines: programs, functions, threads, classes and nodes of the pendant's program tree."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from elitescript.assist.document import Document
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


def document_symbols(document: Document) -> tuple[Symbol, ...]:
    """Return the symbols of a text, in its order. Never raises."""
    return ()


def workspace_symbols(documents: Iterable[Document], query: str, limit: int = 200) -> tuple[FoundSymbol, ...]:
    """Return symbols whose names contain the characters of a query in this order, best matches first.

    Upper and lower case count alike. An empty query finds all, within the limit. Never raises.
    """
    return ()
