"""What a feature of the server is: one request of the protocol, answered from one version of a text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from lsprotocol import types

from elitescript.assist.diagnostics import Tag
from elitescript.assist.document import Document
from elitescript.assist.generated import refusal, task_of
from elitescript.lsp.connection import RequestFailed
from elitescript.records import NamedTuple


class Feature(NamedTuple):
    """One request.

    Attributes:
        answer: called with the server, the text (None if the request names none) and the parameters. It returns the
            result, or, if it is slow, a coroutine.
        options: what the client is told about it; None for the usual.
        is_slow: it waits for findings, for files or for a run, and holds no other request up.
        may_be_late: clients ask it by themselves, also about a text that they have just closed, which is no mistake.
    """

    answer: Callable[..., Any]
    options: Any = None
    is_slow: bool = False
    may_be_late: bool = False


TAGS: Final = {
    Tag.UNNECESSARY: types.DiagnosticTag.Unnecessary,
    Tag.DEPRECATED: types.DiagnosticTag.Deprecated,
}


def refuse_generated(document: Document) -> None:
    """Refuse what edits a text, or prepares that, if it was generated from a graphical program.

    Raises:
        RequestFailed: it was; says where its source is.
    """
    if task := task_of(document.name):
        raise RequestFailed(refusal(task))


def markup(text: str) -> types.MarkupContent:
    """Return a Markdown text as the protocol has it."""
    return types.MarkupContent(types.MarkupKind.Markdown, text)
