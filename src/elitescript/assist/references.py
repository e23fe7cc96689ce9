"""Finds where a name is defined, read and written."""

from __future__ import annotations

import re

from elitescript.assist.document import Document
from elitescript.assist.enclosing import scope_at
from elitescript.assist.names import Access, Entity, EntityKind
from elitescript.lint.program import Span
from elitescript.records import NamedTuple


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
    """Return where the name at a place is defined, in the order of the text. Never raises.

    A function, class, import or parameter: where it is defined. A variable: the first place that gives it a value. A
    signal or connection in a string: the calls that make it. A command: nothing, since no text defines it; `hover`
    links to its page.
    """
    entity = _entity_at(document, line, column)
    return tuple(item.span for item in document.names.definitions(entity)) if entity is not None else ()


def references(document: Document, line: int, column: int, include_definition: bool = True) -> tuple[Reference, ...]:
    """Return all places where the name at a place stands, in the order of the text. Never raises.

    Of a command, and of what Python has itself: all uses in this text. Of a name of a signal or connection in a string:
    the other strings that name it. Attributes of the same name count as one: the classes of objects are not known.
    """
    entity = _entity_at(document, line, column)
    if entity is None:
        return ()
    names = document.names
    defined = {item.span for item in names.definitions(entity)}
    found = (Reference(item.span, item.access, item.span in defined) for item in names.of(entity))
    return tuple(item for item in found if include_definition or not item.is_definition)


def highlights(document: Document, line: int, column: int) -> tuple[Reference, ...]:
    """Return what an editor marks while the cursor is at a place: `references`, with reads told from writes."""
    return references(document, line, column)


def _entity_at(document: Document, line: int, column: int) -> Entity | None:
    """Return what the name at a place stands for; of a line that could not be read, what the word would stand for."""
    found = document.names.at(line, column)
    if found is not None:
        return found.entity
    if line not in document.program.unread_lines:
        return None
    for word in re.finditer(r"[^\W\d]\w*", document.code_line(line)):
        if word.start() < column <= word.end() + 1:
            entity = document.names.entity(word.group(), scope_at(document, line, column))
            return entity if entity.kind is not EntityKind.OUTSIDE else None
    return None
