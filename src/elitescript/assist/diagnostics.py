"""Lists the findings of a text as editors show them."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Diagnostic
from elitescript.lint.program import Span
from elitescript.records import NamedTuple, record


class Tag(StrEnum):
    """How an editor shows the text of a finding."""

    UNNECESSARY = "unnecessary"
    """Faded: it can be removed."""
    DEPRECATED = "deprecated"
    """Struck through: it works, but belongs to another language or time."""


class Related(NamedTuple):
    """Another place that belongs to a finding, or what to do about it.

    Attributes:
        span: the place.
        text: what it has to do with the finding.
    """

    span: Span
    text: str


@record
class Problem:
    """A finding with what editors show beside it.

    Attributes:
        diagnostic: code, severity, place, text, hint and repair: what `check` prints.
        tags: how it is shown.
        related: the hint, at the place of the finding, and other places.
        page: address of the explanation of its code, which is what `check --explain` prints.
    """

    diagnostic: Diagnostic
    tags: tuple[Tag, ...] = ()
    related: tuple[Related, ...] = ()
    page: str = ""


def diagnostics(document: Document) -> tuple[Problem, ...]:
    """Return the findings of a text, in its order: the same as those of `check`. Never raises."""
    return ()
