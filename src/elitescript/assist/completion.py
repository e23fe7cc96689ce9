"""Offers what can stand at a place: commands, names, arguments, values, names in strings."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.lint.program import Span
from elitescript.records import record


class ItemKind(StrEnum):
    """What a completion stands for."""

    COMMAND = "command"
    FUNCTION = "function"
    VARIABLE = "variable"
    CONSTANT = "constant"
    ARGUMENT = "argument"
    """A keyword argument of a call, with its `=`."""
    KEYWORD = "keyword"
    SNIPPET = "snippet"
    """A whole block."""
    MODULE = "module"
    METHOD = "method"
    VALUE = "value"
    """One value of an argument that has few."""
    NAME = "name"
    """A name inside a string: of a signal, a socket, a variable of a client."""
    FILE = "file"


@record
class Completion:
    """One offer.

    Attributes:
        label: what the list shows.
        kind: what it is.
        span: the text that it replaces; one line, it holds the cursor.
        text: what is inserted by clients without snippets.
        snippet: what is inserted by clients with snippets, in their syntax (`$0`, `${1:a}`); empty if that is `text`.
        detail: one line about it, shown beside the label.
        sort: key of the order in the list.
        is_missing: the chosen firmware does not have it.
        is_deprecated: it works, but another one should be used.
        source: what `resolved` needs; empty if there is nothing to add.
        documentation: Markdown; empty before `resolved`.
    """

    label: str
    kind: ItemKind
    span: Span
    text: str
    snippet: str = ""
    detail: str = ""
    sort: str = ""
    is_missing: bool = False
    is_deprecated: bool = False
    source: str = ""
    documentation: str = ""


TRIGGERS = (".", "(", ",", "=", '"', "'", "[", " ")
"""Characters after which an editor should ask by itself, besides letters."""


def completions(document: Document, line: int, column: int) -> tuple[Completion, ...]:
    """Return what can stand at a place, the most likely first. Never raises."""
    return ()


def resolved(item: Completion) -> Completion:
    """Return an item with its documentation."""
    return item
