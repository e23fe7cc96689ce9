"""Packs numbers and texts for a page: numbers whole and as differences, texts short and without hidden characters."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Final

TEXT_MAX: Final = 300
"""Characters of a message or of what a channel carried."""

# Control characters except line ends and tabs, and those that change the direction of text, which could disguise a line
# of a program.
_HIDDEN: Final = re.compile("[\\x00-\\x08\\x0b\\x0c\\x0e-\\x1f\\x7f-\\x9f\\u200e\\u200f\\u2028-\\u202e\\u2066-\\u2069]")


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
    return _HIDDEN.sub(_escape, short)


def _escape(match: re.Match[str]) -> str:
    code = ord(match[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
