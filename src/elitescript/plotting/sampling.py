"""Records rows for a page: one for each control period of a short run, fewer the longer it lasts.

A page shows some thousand points of a curve, so a run of hours need not be kept period by period. Whenever there are
more rows than `rows_max` every second one is dropped and the step doubles. The first row of each stretch in one program
line stays, so that the times by line are exact to a period whatever the step.
"""

from __future__ import annotations

from typing import Final

from elitescript.controller.controller import Controller
from elitescript.controller.views.trace import SPAN_ROWS_MAX, TraceSpan
from elitescript.controller.views.trace_rows import TraceRecorder
from elitescript.messages.timing import PERIOD_S

ROWS_MAX: Final = 200_000
"""Rows of a run of 800 s in which every control period is kept."""


class Sampling(TraceRecorder):
    """A trace that keeps its own rows, and thins them.

    Args:
        rows_max: rows from which on they are thinned; more remain only where lines change that often.
        step_s: time from one row to the next at first, s; one control period if None.
    """

    __slots__ = ("_full", "_line")

    def __init__(self, rows_max: int = ROWS_MAX, step_s: float | None = None) -> None:
        super().__init__(step_s)
        self._full = rows_max
        self._line = -1
        self._rows_max = min(SPAN_ROWS_MAX, rows_max + 1)

    @property
    def step_s(self) -> float:
        """Time from one row to the next while the program stays in one line, s."""
        return self._step_ticks * PERIOD_S

    def record(self, controller: Controller, until_tick: int) -> None:
        """As `Trace.record`; with a row at the tick at which the line changes."""
        if controller.line != self._line:
            self._line = controller.line
            times = self.rows.times
            is_known = bool(times) and times[-1] >= controller.tick * PERIOD_S
            self._next_tick = controller.tick + is_known
        super().record(controller, until_tick)

    def _take(self, span: TraceSpan) -> None:
        super()._take(span)
        if len(self.rows) > self._full:
            self.rows.thin()
            self._step_ticks *= 2
            self._full = max(self._full, 2 * len(self.rows))
        self._rows_max = min(SPAN_ROWS_MAX, self._full + 1 - len(self.rows))
