"""Finds names of files in a text."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.lint.program import Span
from elitescript.records import NamedTuple


class FileKind(StrEnum):
    """Where a file is looked for."""

    TASK = "task"
    """In the task folder: a file that a command reads."""
    NAMED = "named"
    """Named in a comment: beside the program, or below the folder of the workspace."""


class DocumentLink(NamedTuple):
    """A name of a file.

    Attributes:
        span: the name, without quotes.
        path: what is written there. Whether such a file exists is not known here.
        kind: where it is looked for.
    """

    span: Span
    path: str
    kind: FileKind


def document_links(document: Document) -> tuple[DocumentLink, ...]:
    """Return the names of files, in the order of the text. Never raises."""
    return ()
