"""Rows of a stretch of a run, as close as they are asked for, in a worker process: from another run up to there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from elitescript.controller.views.trace import Trace, TraceSpan
from elitescript.conversation import describe
from elitescript.conversation.rows import RowWriter
from elitescript.errors import ElitescriptError, ProgramError
from elitescript.language.text.source import SourceFile
from elitescript.messages.timing import PERIOD_S, seconds, ticks_for
from elitescript.studio.live.jobs import PreparedJob, code_name, job_of
from elitescript.studio.live.link import Link

ROWS_AT_ONCE: Final = 2000
"""Rows that are sent before the stretch is complete."""


def sample(link: Link, request: Mapping[str, Any], jail: Callable[[], None]) -> None:
    """Send the rows of a stretch.

    Args:
        link: to the engine.
        request: `job`, `run`, `ask`, `from_s`, `to_s`, `step_s`.
        jail: called before the text is compiled.
    """
    run, ask = request["run"], request["ask"]
    job = job_of(request["job"])
    rows = StretchRows(link, run, request["from_s"], request["to_s"], request["step_s"])
    try:
        robot = PreparedJob(job).robot()
        jail()
        unit = robot.compile(SourceFile(code_name(job.name), job.text))
        # A tick more: the last row of a run that is cut short shows the begin of its stop.
        robot.run(unit, presets=job.presets, until_s=request["to_s"] + PERIOD_S, trace=rows)
    except ProgramError as error:
        link.send(describe.refused("; ".join(map(str, error.problems)), ask))
    except ElitescriptError as error:
        link.send(describe.refused(str(error), ask))
    else:
        rows.send()
        link.send({"type": "detail_ended", "ask": ask, "run": run})


class StretchRows(Trace):
    """Takes the rows of a stretch, and sends them.

    Args:
        link: where to.
        run: number of the run.
        from_s, to_s: the stretch.
        step_s: from one row to the next, a whole number of control periods at least.
    """

    __slots__ = ("_count", "_link", "_writer")

    def __init__(self, link: Link, run: int, from_s: float, to_s: float, step_s: float) -> None:
        step = seconds(max(1, round(step_s / PERIOD_S)))
        super().__init__(lambda row: None, step, window_s=(seconds(ticks_for(from_s)), to_s))
        self._link = link
        self._writer = RowWriter(run)
        self._count = 0

    def _take(self, span: TraceSpan) -> None:
        self._writer.add(span)
        self._count += len(span.ticks)
        if self._count >= ROWS_AT_ONCE:
            self.send()

    def send(self) -> None:
        """Send the rows that have been taken."""
        self._count = 0
        for frame in self._writer.take():
            self._link.send_rows(frame)
