"""Recognizes motions that come again, though their numbers differ by rounding."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

COURSE_ERROR: Final = 1e-9
"""By so much numbers of one course may differ: m, rad, s."""


def rounded(numbers: Iterable[float]) -> tuple[int, ...]:
    """Return numbers as multiples of `COURSE_ERROR`."""
    return tuple([int(number / COURSE_ERROR + 0.5) for number in numbers])
