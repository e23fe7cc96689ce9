"""What the log says of a robot whose ticks come late: one line a minute, with the share of its time.

The first line comes `FIRST_TICKS` after ticks began to come late, not only after a minute; ticks that are
left out are named at once, if no line has named any within a minute.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.records import record

FIRST_TICKS: Final = 10 * TICKS_PER_S
"""Ticks of the wall clock between two reports while few are late."""
NEXT_TICKS: Final = 60 * TICKS_PER_S
"""The same after a report that was a problem."""
LATE_SHARE: Final = 0.01
"""Share of the time that was late or left out from which on it is a problem."""


@record
class Report:
    """Ticks since the last report."""

    ticks: int
    """That have run or were leapt over."""
    late: int
    """Of them, that began late by a period or more."""
    left_out: int
    """That never were."""
    worst_ms: float
    """The latest beginning."""

    @property
    def share(self) -> float:
        """Share of the ticks that were late or left out."""
        return (self.late + self.left_out) / max(self.ticks + self.left_out, 1)

    @property
    def is_problem(self) -> bool:
        """Whether the robot does not keep its time."""
        return self.share >= LATE_SHARE

    def __str__(self) -> str:
        began = f"{self.late} of {self.ticks} ticks began late, by {self.worst_ms:.1f} ms at most"
        if not self.is_problem:
            return f"{began}: the computer is busy"
        text = f"overloaded: {100 * self.share:.0f} % of the robot's time was late or left out: {began}"
        if self.left_out:
            rate = 100 * self.ticks / (self.ticks + self.left_out)
            lost_s = self.left_out * PERIOD_S
            text += f", and {self.left_out} ({lost_s:.1f} s) were left out, so that robot time passed at {rate:.1f} %"
        return text


class Overload:
    """Counts the late ticks of one robot, and says when a report is due."""

    __slots__ = ("_has_named_left_out", "_late_before", "_left_out_before", "_ticks", "_was_problem")

    def __init__(self) -> None:
        self._ticks = 0
        self._late_before = self._left_out_before = 0
        self._was_problem = False
        self._has_named_left_out = False

    def pass_on(self, ticks: int) -> None:
        """Count ticks that have gone by."""
        self._ticks += ticks

    def names_left_out(self) -> bool:
        """Return whether ticks that are left out now are to be named at once; the report counts the others."""
        is_first, self._has_named_left_out = not self._has_named_left_out, True
        return is_first

    def due(self, late: int, left_out: int, worst_ms: float) -> Report | None:
        """Return what is to be said now; None if nothing is.

        Args:
            late: ticks since the start that began late.
            left_out: ticks since the start that never were.
            worst_ms: the latest beginning since the last report.
        """
        missing = left_out - self._left_out_before
        if self._ticks + missing < (NEXT_TICKS if self._was_problem else FIRST_TICKS):
            return None
        report = Report(self._ticks, late - self._late_before, missing, worst_ms)
        self._ticks, self._late_before, self._left_out_before = 0, late, left_out
        self._was_problem = report.is_problem
        self._has_named_left_out = report.is_problem and bool(report.left_out)
        return report if report.late or report.left_out else None
