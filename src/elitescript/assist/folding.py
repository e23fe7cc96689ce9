"""Finds what an editor can fold."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.records import NamedTuple


class FoldKind(StrEnum):
    """What folds."""

    BLOCK = "block"
    COMMENT = "comment"
    IMPORTS = "imports"
    REGION = "region"
    """What is between the fences of a plugin, or of a program that is cut at them."""
    NODE = "node"
    """What a `$ LINE` mark begins."""
    LINES = "lines"
    """A statement on several lines, such as a long list."""


class Fold(NamedTuple):
    """Lines that fold into the first one.

    Attributes:
        line: the line that stays.
        end_line: the last line that is hidden.
        kind: what it is.
    """

    line: int
    end_line: int
    kind: FoldKind


def folding_ranges(document: Document) -> tuple[Fold, ...]:
    """Return what can be folded, in the order of the text. Never raises."""
    return ()
