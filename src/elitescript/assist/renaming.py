"""Renames variables, parameters, functions and what else a program defines."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit
from elitescript.lint.program import Span
from elitescript.records import record


@record
class Renamable:
    """What a rename would change.

    Attributes:
        span: the name at the cursor.
        name: the name.
        refusal: why it cannot be renamed; empty if it can.
    """

    span: Span
    name: str
    refusal: str = ""


@record
class Renaming:
    """The result of a rename.

    Attributes:
        edits: all at once, they do not overlap; empty if it is refused.
        refusal: why it is refused; empty if it is not.
    """

    edits: tuple[Edit, ...] = ()
    refusal: str = ""


def prepare_rename(document: Document, line: int, column: int) -> Renamable | None:
    """Return what a rename at a place would change; None if no name stands there. Never raises."""
    return None


def rename(document: Document, line: int, column: int, new_name: str) -> Renaming:
    """Return the edits that give the name at a place another name.

    The text afterwards compiles to the same code, up to the name. Strings and comments stay as they are. Never raises:
    what would change the meaning of the program is refused, with the reason.
    """
    return Renaming(refusal="nothing can be renamed here")
