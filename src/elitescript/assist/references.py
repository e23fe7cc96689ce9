"""Finds where a name is defined, read and written."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.lint.program import Span
from elitescript.records import NamedTuple


class Access(StrEnum):
    """What is done with a name at a place."""

    READ = "read"
    WRITE = "write"
    """It gets a value there, also by `def`, `for`, `import`, `except ... as`."""
    TEXT = "text"
    """It is only named there: in a `global` statement or in a string."""


class Reference(NamedTuple):
    """A place where a name stands.

    Attributes:
        span: the name, without quotes if it stands in a string.
        access: what is done with it.
        is_definition: `definition` returns this place.
    """

    span: Span
    access: Access
    is_definition: bool


def definition(document: Document, line: int, column: int) -> tuple[Span, ...]:
    """Return where the name at a place is defined, in the order of the text.

    A function or class: its name behind `def` or `class`. A variable: every place that gives it its first value in its
    scope. A signal in a string: where it is added. A command, or nothing: an empty tuple. Never raises.
    """
    return ()


def references(document: Document, line: int, column: int, include_definition: bool = True) -> tuple[Reference, ...]:
    """Return all places where the name at a place stands, in the order of the text. Never raises.

    Of a command, and of what Python has itself: all uses in this text. Of a name of a signal or connection in a string:
    the other strings that name it.
    """
    return ()


def highlights(document: Document, line: int, column: int) -> tuple[Reference, ...]:
    """Return what an editor marks while the cursor is at a place: `references`, with reads told from writes."""
    return references(document, line, column)
