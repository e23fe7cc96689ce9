"""The time of a served robot that goes by the wall clock."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.messages.timing import TICKS_PER_S
from elitescript.services.log import ServerLog
from elitescript.services.time.cycle import Cycle

REPORT_TICKS: Final = 10 * TICKS_PER_S
"""After so many ticks the log gets the number of those that were late."""
LATE_MANY: Final = REPORT_TICKS // 100
"""So many of them are a problem."""


class PacedTime:
    """Says when the next tick begins, and when its output leaves; see `cycle`.

    Args:
        log: takes how many ticks were late.
        on_left_out: called with the number of ticks that are left out.
    """

    __slots__ = ("_cycle", "_log", "_overruns_before", "_ticks")

    def __init__(self, log: ServerLog, on_left_out: Callable[[int], None]) -> None:
        self._log = log
        self._cycle = Cycle(on_left_out=on_left_out)
        self._ticks = self._overruns_before = 0
        """Since the last report, and before it."""

    @property
    def overruns(self) -> int:
        """Ticks that began late."""
        return self._cycle.overruns

    @property
    def left_out(self) -> int:
        """Ticks that never were because the computer was away."""
        return self._cycle.left_out

    @property
    def lag_ticks(self) -> int:
        """Whole periods by which the present tick began late."""
        return self._cycle.lag_ticks

    @property
    def waits_for(self) -> str:
        """Origin of the client that time waits for; empty if there is none."""
        return ""

    @property
    def passed(self) -> int:
        """How many of the ticks that are being leapt over have gone by; see `Cycle.passed`."""
        return self._cycle.passed

    async def next(self, ticks_on: Callable[[], int | None], *, has_outlet: bool) -> int:
        """Return when the next tick begins; see `Cycle.next`.

        Args:
            ticks_on: returns how many ticks on the next one is that is due; None if there is none.
            has_outlet: whether what ticks give leaves at `outlet`.
        """
        if self._ticks >= REPORT_TICKS:
            self._report(self._cycle.overruns - self._overruns_before)
            self._ticks, self._overruns_before = 0, self._cycle.overruns
        gone_on = await self._cycle.next(ticks_on(), has_outlet=has_outlet)
        self._ticks += gone_on
        return gone_on

    async def outlet(self) -> None:
        """Return when the output of the present tick leaves."""
        await self._cycle.outlet()

    def wake(self) -> None:
        """Look again whether time may go on: it waits for no client, but what a client does is due."""
        self._cycle.make_due()

    def make_due(self) -> int:
        """Let the next tick run, if it is about to be leapt over; see `Cycle.make_due`."""
        return self._cycle.make_due()

    def close(self) -> None:
        """End: no tick comes after this."""
        self._cycle.close()

    def _report(self, late: int) -> None:
        """Write how many ticks began late of the last `REPORT_TICKS`."""
        worst_ms, self._cycle.worst_ns = self._cycle.worst_ns / 1e6, 0
        if late:
            text = f"{late} of {self._ticks} ticks began late, by {worst_ms:.1f} ms at most: the computer is busy"
            self._log.note("late", text, is_problem=late >= LATE_MANY, ticks=late, worst_ms=worst_ms)
