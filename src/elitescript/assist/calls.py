"""Finds who calls a function, who starts it as a thread, and what it calls itself."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.assist.outline import SymbolKind
from elitescript.lint.program import Span
from elitescript.records import NamedTuple, record


@record
class CallItem:
    """A function of a text, or the text itself, as caller or as what is called.

    Attributes:
        name: the name; of a script the name of the document.
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
    return ()


def incoming(document: Document, item: CallItem) -> tuple[Call, ...]:
    """Return who calls or starts a function, in the order of the text. Never raises."""
    return ()


def outgoing(document: Document, item: CallItem) -> tuple[Call, ...]:
    """Return what a function of the program calls or starts, in the order of the text. Never raises."""
    return ()
