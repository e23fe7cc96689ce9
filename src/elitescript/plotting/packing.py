"""Packs numbers and texts for a page: numbers whole and as differences, texts short and without hidden characters."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Final

from elitescript.shown import visible

TEXT_MAX: Final = 300
"""Characters of a message or of what a channel carried."""


def milliseconds(times: Sequence[float]) -> list[int]:
    """Return times as whole milliseconds, each as the difference to the one before."""
    return deltas([round(1000.0 * time) for time in times])


def deltas(values: Sequence[int]) -> list[int]:
    """Return the first value, then the difference of each to the one before."""
    return [values[0], *(later - value for value, later in pairwise(values))] if values else []


def undo_deltas(values: Sequence[int]) -> list[int]:
    """Return what was packed with `deltas`, as the page unpacks it."""
    return list(accumulate(values))


def shown_text(text: str, longest: int = TEXT_MAX) -> str:
    """Return the text cut after so many characters, with its hidden characters as escapes such as `\\u202e`."""
    short = text if len(text) <= longest else text[: longest - 1] + "…"
    return visible(short)
