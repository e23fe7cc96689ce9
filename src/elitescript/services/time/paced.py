"""The time of a served robot that goes by the wall clock."""

from __future__ import annotations

from collections.abc import Callable

from elitescript.services.log import ServerLog
from elitescript.services.time.cycle import Cycle
from elitescript.services.time.overload import Overload


class PacedTime:
    """Says when the next tick begins, and when its output leaves; see `cycle`.

    Args:
        log: takes how many ticks were late.
        on_left_out: called with the number of ticks that are left out, if no report has named any within a minute.
    """

    __slots__ = ("_cycle", "_log", "_on_left_out", "_overload")

    def __init__(self, log: ServerLog, on_left_out: Callable[[int], None]) -> None:
        self._log = log
        self._on_left_out = on_left_out
        self._cycle = Cycle(on_left_out=self._note_left_out)
        self._overload = Overload()

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
    def is_at_outlet(self) -> bool:
        """Whether the present tick has begun without having been woken up for; see `Cycle.is_at_outlet`."""
        return self._cycle.is_at_outlet

    @property
    def waits_for(self) -> str:
        """Origin of the client that time waits for; empty if there is none."""
        return ""

    @property
    def passed(self) -> int:
        """How many of the ticks that are being leapt over have gone by; see `Cycle.passed`."""
        return self._cycle.passed

    async def next(
        self, ticks_on: Callable[[], int | None], *, has_outlet: bool, is_known: Callable[[], bool] = lambda: False
    ) -> int:
        """Return when the next tick begins; see `Cycle.next`.

        Args:
            ticks_on: returns how many ticks on the next one is that is due; None if there is none.
            has_outlet: whether what ticks give leaves at `outlet`.
            is_known: returns whether it is known what the next tick gives if nothing comes in; called after `ticks_on`.
        """
        self._report()
        ticks = ticks_on()
        gone_on = await self._cycle.next(ticks, has_outlet=has_outlet, is_known=ticks == 1 and is_known())
        self._overload.pass_on(gone_on)
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

    def _note_left_out(self, ticks: int) -> None:
        if self._overload.names_left_out():
            self._on_left_out(ticks)

    def _report(self) -> None:
        """Write how many ticks began late or were left out, once in a while."""
        cycle = self._cycle
        report = self._overload.due(cycle.overruns, cycle.left_out, cycle.worst_ns / 1e6)
        if report is None:
            return
        cycle.worst_ns = 0
        self._log.note(
            "late",
            str(report),
            is_problem=report.is_problem,
            ticks=report.late,
            left_out=report.left_out,
            share=round(report.share, 4),
            worst_ms=report.worst_ms,
        )
