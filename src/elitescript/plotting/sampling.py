"""Records rows for a page: one for each control period of a short run, fewer the longer it lasts.

A page shows some thousand points of a curve, so a run of hours need not be kept period by period. Whenever there are
more rows than `rows_max` every second one is dropped and the step doubles. The first row of each stretch in one program
line stays, so that the times by line are exact to a period whatever the step.
"""

from __future__ import annotations

from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace import Trace, TraceRow
from elitescript.messages.timing import PERIOD_S

ROWS_MAX: Final = 200_000
"""Rows of a run of 800 s in which every control period is kept."""


class Sampling(Trace):
    """A trace that keeps its own rows, and thins them.

    Args:
        rows_max: rows from which on they are thinned; more remain only where lines change that often.
    """

    __slots__ = ("_full", "_line", "rows")

    def __init__(self, rows_max: int = ROWS_MAX) -> None:
        self.rows: list[TraceRow] = []
        self._full = rows_max
        self._line = -1
        super().__init__(self._take)

    @property
    def step_s(self) -> float:
        """Time from one row to the next while the program stays in one line, s."""
        return self._step_ticks * PERIOD_S

    def record(self, controller: Controller, until_tick: int) -> None:
        """As `Trace.record`; with a row at the tick at which the line changes."""
        if controller.line != self._line:
            self._line = controller.line
            is_known = bool(self.rows) and self.rows[-1].t >= controller.tick * PERIOD_S
            self._next_tick = controller.tick + is_known
        super().record(controller, until_tick)

    def _take(self, row: TraceRow) -> None:
        self.rows.append(row)
        if len(self.rows) > self._full:
            self._thin()
            self._step_ticks *= 2
            self._full = max(self._full, 2 * len(self.rows))

    def _thin(self) -> None:
        kept: list[TraceRow] = []
        line, is_even = -1, True
        for row in self.rows:
            is_even = row.line != line or not is_even
            line = row.line
            if is_even:
                kept.append(row)
        self.rows[:] = kept if kept[-1] is self.rows[-1] else [*kept, self.rows[-1]]
