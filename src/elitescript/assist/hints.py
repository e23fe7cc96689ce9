"""Adds small texts to lines: times of moves, units, names of arguments."""

from __future__ import annotations

from collections.abc import Collection
from enum import StrEnum

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.lint.program import Span
from elitescript.records import record


class HintKind(StrEnum):
    """What a hint shows."""

    TIME = "time"
    """How long a move took in the last run."""
    UNIT = "unit"
    """Joint positions in degrees."""
    ARGUMENT = "argument"
    """Name of the parameter of an argument in a long call."""
    BLEND = "blend"
    """Radius that a blend was shortened to in the last run."""


@record
class InlayHint:
    """One hint; its place is in front of the character there.

    Attributes:
        line, column: where, from 1.
        kind: what it shows.
        label: the text.
        tooltip: Markdown; may be empty.
        pads_left: a blank in front of it.
        pads_right: a blank behind it.
    """

    line: int
    column: int
    kind: HintKind
    label: str
    tooltip: str = ""
    pads_left: bool = False
    pads_right: bool = False


def inlay_hints(
    document: Document,
    span: Span,
    last_run: LastRun | None = None,
    kinds: Collection[HintKind] = frozenset(HintKind),
) -> tuple[InlayHint, ...]:
    """Return the hints of a range, in the order of the text. Never raises.

    Args:
        document: the text.
        span: the lines that are shown; columns do not count.
        last_run: for times and blends; lines that were changed since have none.
        kinds: those that are wanted.
    """
    return ()
