"""The properties and measures of many runs: parsed once, watched anew in each run.

Example:
    >>> from elitescript import VirtualRobot
    >>> from elitescript.properties.parsing import parse_measure, parse_property
    >>> checks = Checks([parse_property("max_of(tcp_speed) < 0.5")], {"height": parse_measure("min_of(tcp[2])")})
    >>> watching = checks.watch()
    >>> robot = VirtualRobot("CS66")
    >>> run = robot.run("def p():\\n  movej([0, -1.5, 1.5, -1.5, -1.5, 0], 1, 1)\\nend", trace=watching.trace)
    >>> watching.results(run).verdicts[0].holds
    False
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Literal

from elitescript.controller.views.trace import step_ticks
from elitescript.messages.signals import Value
from elitescript.properties.monitor import Monitor
from elitescript.properties.verdicts import Measure, Property, Verdict
from elitescript.records import record
from elitescript.run import Run


@record
class Results:
    """What the properties and measures of one run came to.

    Attributes:
        verdicts: of the properties in their order.
        measures: numbers by their names; None where a run has none.
        reasons: why a run has no number, by the name of the measure.
    """

    verdicts: tuple[Verdict, ...]
    measures: Mapping[str, Value | None]
    reasons: Mapping[str, str]

    @property
    def first_failed(self) -> int | None:
        """Index of the first property that did not hold; None if all did."""
        return next((index for index, verdict in enumerate(self.verdicts) if not verdict.holds), None)


class Checks:
    """Properties and measures of many runs.

    Args:
        properties: in their order.
        measures: by their names.
        step_s: time from one moment to the next while the arm moves; every tick if None. Signals, lines and times are
            exact all the same.

    Raises:
        UsageError: `step_s` is no whole number of ticks.
    """

    __slots__ = ("_step_ticks", "measures", "properties")

    def __init__(
        self,
        properties: Sequence[Property] = (),
        measures: Mapping[str, Measure] | None = None,
        step_s: float | None = None,
    ) -> None:
        self.properties = tuple(properties)
        self.measures = dict(measures or {})
        self._step_ticks = step_ticks(step_s)

    def watch(self) -> Watching:
        """Return what watches one run."""
        return Watching(self, self._step_ticks)


class Watching:
    """Watches one run.

    Attributes:
        trace: for `VirtualRobot.run(trace=...)`; False if the record of the run is enough.
    """

    __slots__ = ("_measures", "_watches", "trace")

    def __init__(self, checks: Checks, row_ticks: int) -> None:
        self._watches = [one.watch() for one in checks.properties]
        self._measures = {name: measure.watch() for name, measure in checks.measures.items()}
        sees = [(one.needs, watch.see) for one, watch in zip(checks.properties, self._watches, strict=True)]
        sees += [(one.needs, self._measures[name].see) for name, one in checks.measures.items()]
        sees = [(needs, see) for needs, see in sees if not needs.nothing]
        self.trace: Monitor | Literal[False] = Monitor(sees, row_ticks) if sees else False

    def results(self, run: Run) -> Results:
        """Return what came of the run, once it is over."""
        end_tick = self.trace.end_tick if self.trace else run.start_tick
        verdicts = tuple(watch.verdict(run, end_tick) for watch in self._watches)
        measures = {name: watch.value(run, end_tick) for name, watch in self._measures.items()}
        reasons = {name: watch.reason for name, watch in self._measures.items() if watch.reason}
        for name, value in measures.items():
            if value is not None and not _fits(value):
                measures[name], reasons[name] = None, "the number is too large"
        return Results(verdicts, measures, reasons)


def _fits(value: Value) -> bool:
    """Return whether a number can be added to others and written into a table of floating-point numbers."""
    try:
        return isfinite(value)
    except OverflowError:
        return False
