"""Offers repairs of findings and small rewritings."""

from __future__ import annotations

from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Diagnostic, Edit
from elitescript.lint.program import Span
from elitescript.records import record


class ActionKind(StrEnum):
    """Kind of an action, as the protocol of editors names it."""

    QUICK_FIX = "quickfix"
    REWRITE = "refactor.rewrite"
    FIX_ALL = "source.fixAll"


@record
class CodeAction:
    """One action.

    Attributes:
        title: what the menu shows.
        kind: of the action.
        edits: what changes, all at once: they do not overlap, and none counts on another.
        problems: the findings that it repairs.
        is_preferred: it is the repair that is certainly meant.
    """

    title: str
    kind: ActionKind
    edits: tuple[Edit, ...]
    problems: tuple[Diagnostic, ...] = ()
    is_preferred: bool = False


def code_actions(document: Document, span: Span) -> tuple[CodeAction, ...]:
    """Return the actions for a range, the preferred ones first. Never raises."""
    return ()


def fix_all(document: Document) -> CodeAction | None:
    """Return the action that makes every safe fix of the text, as `check --fix`; None if there is none."""
    return None
