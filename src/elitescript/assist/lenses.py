"""Adds lines above programs and functions: Run, Debug, Show path; calls and their share of the time."""

from __future__ import annotations

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.lint.program import Span
from elitescript.records import record

RUN = "elitescript.run"
DEBUG = "elitescript.debug"
SHOW_PATH = "elitescript.showPath"


@record
class CodeLens:
    """One entry.

    Attributes:
        span: the line that it stands above.
        title: the text.
        command: what a click does, one of the names above, with the document as argument; empty for a text only.
    """

    span: Span
    title: str
    command: str = ""


def code_lenses(document: Document, last_run: LastRun | None = None) -> tuple[CodeLens, ...]:
    """Return the entries of a text, in its order. Never raises."""
    return ()
