"""Gaps, restarts and repeated rows in the controller's time, while rows come."""

from __future__ import annotations

from itertools import pairwise
from statistics import median
from typing import Final

from elitescript.records import NamedTuple

LEARNING: Final = 25
"""Rows from which the rate is learnt: a controller may send less often than it was asked."""


class Gap(NamedTuple):
    """A stretch of the controller's time without rows that should have some."""

    begin_s: float
    """Of the row before."""
    end_s: float
    """Of the row after."""
    missing: int


class Restart(NamedTuple):
    """The controller's time began anew."""

    before_s: float
    after_s: float


class Pace:
    """Counts rows that are missing or repeated, by the controller's own time.

    Args:
        asked_hz: rate that was asked for.

    Attributes:
        rows: that came.
        missing: that did not.
        gaps: number of stretches without them.
        repeated: rows that came with the time of the one before; `rows` does not count them.
        restarts: how often the time began anew.
    """

    __slots__ = (
        "_before_s",
        "_first",
        "_newest_s",
        "_period_s",
        "_times",
        "gaps",
        "missing",
        "repeated",
        "restarts",
        "rows",
    )

    def __init__(self, asked_hz: float) -> None:
        self._period_s = 1.0 / asked_hz
        self._before_s: float | None = None
        self._newest_s: float | None = None
        self._times = 0
        """How often the newest row was repeated."""
        self._first: list[float] | None = []
        """Times of the first rows; None once the rate is known."""
        self.rows = 0
        self.missing = 0
        self.gaps = 0
        self.repeated = 0
        self.restarts = 0

    @property
    def rate_hz(self) -> float:
        """Rows a second that the controller sends; what was asked until that is known."""
        return 1.0 / self._period_s

    def repeats(self, t: float) -> int:
        """Return how often a row of this time has been repeated by now: 0 for a new one, which is to be taken.

        A controller repeats its last row while it has nothing newer.
        """
        if t != self._newest_s:
            self._newest_s, self._times = t, 0
            return 0
        self._times += 1
        self.repeated += 1
        return self._times

    def take(self, t: float) -> Gap | Restart | None:
        """Take the time of a row, s; return what it shows. Of the first rows, `settle` does."""
        self.rows += 1
        if self._first is not None:
            self._first.append(t)
            return None
        before, self._before_s = self._before_s, t
        if before is None:
            return None
        step = t - before
        if step < 0.0:
            self.restarts += 1
            return Restart(before, t)
        missing = round(step / self._period_s) - 1
        if missing <= 0:
            return None
        self.missing += missing
        self.gaps += 1
        return Gap(before, t, missing)

    def settle(self, *, at_once: bool = False) -> list[Gap | Restart]:
        """Learn the rate as soon as there are enough rows, and return what they show; later nothing.

        Args:
            at_once: with as many as there are.
        """
        first = self._first
        if first is None or (len(first) < LEARNING and not at_once):
            return []
        self._first = None
        rising = [after - before for before, after in pairwise(first) if after > before]
        if rising:
            self._period_s = round(median(rising), 6)
        self.rows -= len(first)
        return [found for found in map(self.take, first) if found is not None]
