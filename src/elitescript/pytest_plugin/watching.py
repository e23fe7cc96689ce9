"""What the robots of one test do, kept until the test has passed."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, Final
from weakref import ref

if TYPE_CHECKING:
    from elitescript.findings.found import Findings
    from elitescript.messages.profile import Profile
    from elitescript.models.model import RobotModel
    from elitescript.plotting.sampling import Sampling
    from elitescript.pytest_plugin.limits import Guard
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run

RUNS_MAX: Final = 5
"""Runs of a test that are kept: the last ones."""


class WatchedRun:
    """One run of a test. It keeps what has happened, and not the robot, which a test may drop.

    Attributes:
        run: returns its record; None if it is no longer held.
        unit: the program.
        start_tick: its first tick.
        record: its events.
        alarms: what stopped it.
        warnings: texts.
        check_text: returns what `check` finds in the program.
        model: the arm.
        profile: the firmware.
        ignored: codes of findings that the robot leaves out.
        is_strict: whether the robot refuses what only warns otherwise.
        presets: names of program globals that had a value before.
        rows: of its page; None if none is written.
    """

    __slots__ = (
        "alarms",
        "check_text",
        "ignored",
        "is_strict",
        "model",
        "presets",
        "profile",
        "record",
        "rows",
        "run",
        "start_tick",
        "unit",
        "warnings",
    )

    def __init__(self, robot: VirtualRobot, run: Run, presets: Mapping[str, object], rows: Sampling | None) -> None:
        self.run: ref[Run] = ref(run)
        self.unit = run.unit
        self.start_tick = run.start_tick
        self.record = run.record
        self.alarms = run.alarms
        self.warnings = run.warnings
        self.check_text = run.check_text
        self.model: RobotModel = robot.model
        self.profile: Profile = robot.profile
        self.is_strict = robot.options.strict
        self.ignored = robot.options.ignored
        self.presets = tuple(presets)
        self.rows = rows

    @property
    def findings(self) -> Findings:
        """What text and run have found; of a run that nobody has any more, as far as its events are kept."""
        if (run := self.run()) is not None:
            return run.findings
        from elitescript.findings.found import Found
        from elitescript.run import FINDINGS

        found = Found()
        for event in self.record.read():
            if isinstance(event, FINDINGS):
                found.take(event, self.start_tick)
        return found.listed(() if self.check_text is None else self.check_text())


class RunWatcher:
    """Keeps the last runs of a test. Implements `observer.RunObserver`.

    Args:
        keeps_rows: whether each run keeps the rows that its page is made of.
        guard: makes what holds runs to their limits, when the first one begins.

    Attributes:
        runs: the last ones.
    """

    __slots__ = ("_guard", "_keeps_rows", "_make_guard", "runs")

    def __init__(self, *, keeps_rows: bool, guard: Callable[[], Guard]) -> None:
        self._keeps_rows = keeps_rows
        self._make_guard = guard
        self._guard: Guard | None = None
        self.runs: deque[WatchedRun] = deque(maxlen=RUNS_MAX)

    def started(self, robot: Any, run: Any, presets: Mapping[str, object], trace: Any) -> Any:
        """Keep a run; see `RunObserver.started`."""
        rows = None
        if self._keeps_rows:
            from elitescript.plotting.sampling import Sampling

            rows = Sampling()
        self.runs.append(WatchedRun(robot, run, presets, rows))
        if rows is None:
            return trace
        return rows if trace is None else _Traces(trace, rows)

    def limits(self, robot: VirtualRobot, run: Run, until_s: float | None) -> AbstractContextManager[float | None]:
        """Hold a run to the limits of the test; see `RunObserver.limits`."""
        if self._guard is None:
            self._guard = self._make_guard()
        return self._guard.limits(robot, run, until_s)

    @property
    def exceeded(self) -> list[str]:
        """Why runs were ended by their limits, in words."""
        return [] if self._guard is None else self._guard.exceeded

    def close(self) -> None:
        """End what holds runs to their limits."""
        if self._guard is not None:
            self._guard.close()


class _Traces:
    """Several traces of one run."""

    __slots__ = ("_traces",)

    def __init__(self, *traces: Any) -> None:
        self._traces = traces

    def record(self, controller: Any, until_tick: int) -> None:
        for trace in self._traces:
            trace.record(controller, until_tick)

    def finish(self, controller: Any) -> None:
        for trace in self._traces:
            trace.finish(controller)
