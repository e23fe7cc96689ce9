"""What the robots of one test do, kept until the test has passed."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from elitescript.controller.controller import Controller
    from elitescript.controller.views.trace import Trace
    from elitescript.messages.profile import Profile
    from elitescript.models.model import RobotModel
    from elitescript.plotting.sampling import Sampling
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run

RUNS_MAX: Final = 5
"""Runs of a test that are kept: the last ones."""

LINES_MAX: Final = 40
"""Lines of a run that are kept: the last ones."""


class LineLog:
    """The lines in which the main thread stood, each with the tick at which it came there.

    It takes the place of a trace, which is called between two ticks that are due, and hands the call on.

    Args:
        traces: that get the rows.
    """

    __slots__ = ("_line", "_traces", "lines")

    def __init__(self, *traces: Trace) -> None:
        self.lines: deque[tuple[int, int]] = deque(maxlen=LINES_MAX)
        self._line = 0
        self._traces = traces

    def record(self, controller: Controller, until_tick: int) -> None:
        """Note the line of the present tick."""
        line = controller.line
        if line != self._line:
            self._line = line
            if line:
                self.lines.append((controller.tick, line))
        for trace in self._traces:
            trace.record(controller, until_tick)

    def finish(self, controller: Controller) -> None:
        """Record the last row."""
        for trace in self._traces:
            trace.finish(controller)


class WatchedRun:
    """One run of a test.

    Attributes:
        run: its record.
        model: the arm.
        profile: the firmware.
        is_strict: whether the robot refuses what only warns otherwise.
        presets: program globals that had a value before.
        lines: the last lines.
        rows: of its page; None if none is written.
    """

    __slots__ = ("is_strict", "lines", "model", "presets", "profile", "rows", "run")

    def __init__(
        self, robot: VirtualRobot, run: Run, presets: Mapping[str, object], lines: LineLog, rows: Sampling | None
    ) -> None:
        self.run = run
        self.model: RobotModel = robot.model
        self.profile: Profile = robot.profile
        self.is_strict = robot.options.strict
        self.presets = tuple(presets)
        self.lines = lines
        self.rows = rows


class RunWatcher:
    """Keeps the last runs of a test. Implements `observer.RunObserver`.

    Args:
        keeps_rows: whether each run keeps the rows that its page is made of.
    """

    __slots__ = ("_keeps_rows", "runs")

    def __init__(self, *, keeps_rows: bool) -> None:
        self._keeps_rows = keeps_rows
        self.runs: deque[WatchedRun] = deque(maxlen=RUNS_MAX)

    def started(self, robot: Any, run: Any, presets: Mapping[str, object], trace: Any) -> Any:
        """Keep a run; see `RunObserver.started`."""
        traces = () if trace is None else (trace,)
        rows = None
        if self._keeps_rows:
            from elitescript.plotting.sampling import Sampling

            rows = Sampling()
            traces = (*traces, rows)
        log = LineLog(*traces)
        self.runs.append(WatchedRun(robot, run, presets, log, rows))
        return log
