"""Records a run for a page: rows, and what its events do not tell of globals and threads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from elitescript.conversation import describe
from elitescript.conversation.limits import cut_name
from elitescript.debugger.values import shown, type_name
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.text.source import SourceFile
from elitescript.plotting.line_times import ThreadLines
from elitescript.plotting.moments import alarm_of, contacts_of, moment_now, moment_of_run, scene_of
from elitescript.plotting.recording import Recording
from elitescript.plotting.sampling import Sampling
from elitescript.robot import VirtualRobot
from elitescript.run import Run

CHANGES_MAX: Final = 50_000
"""Changes of program globals that are kept; later ones are known at the end only."""
TEXT_MAX: Final = 8 << 20
"""Characters of their values, and of what threads wait for; what comes after them is left out likewise."""

_FIXED: Final = frozenset((bool, int, float, str, type(None)))
"""Types of values that cannot change: the same object is the same value."""


class RunRecorder:
    """Records one run of a robot. `sampling` is its trace, and `watch` is called after every tick.

    Args:
        robot: before it runs.
        sampling: rows of the page.
    """

    __slots__ = ("_changes", "_first", "_globals", "_lines", "_scene", "_text", "_values", "_waits", "sampling")

    def __init__(self, robot: VirtualRobot, sampling: Sampling) -> None:
        self.sampling = sampling
        self._lines = ThreadLines()
        self._scene = scene_of(robot)
        self._first: Mapping[str, Any] | None = None
        self._globals: dict[str, list[tuple[float, str, str]]] = {}
        self._values: dict[str, Any] = {}
        self._changes = 0
        self._text = 0
        self._waits: dict[str, list[tuple[float, str]]] = {}

    def watch(self, robot: VirtualRobot) -> None:
        """Record where the threads are, what they wait for, and globals that have changed."""
        t = robot.time_s
        threads = robot.threads()
        if self._first is None:
            self._first = describe.moment(moment_now(robot))
        self._lines.record(t, [(thread.name, thread.line) for thread in threads[1:]])
        for thread in threads:
            waits = self._waits.setdefault(thread.name, [])
            if not waits or waits[-1][1] != cut_name(thread.waits_for):
                reason = cut_name(thread.waits_for)
                self._text += len(reason)
                if self._text <= TEXT_MAX:
                    waits.append((t, reason))
        self._watch_globals(t, robot.host.monitor())

    def _watch_globals(self, t: float, monitor: Mapping[str, Any]) -> None:
        for name, value in monitor.items():
            if value is self._values.get(name, self) and type(value) in _FIXED:
                continue
            self._values[name] = value
            known = self._globals.setdefault(name, [])
            text = shown(value)
            if (not known or known[-1][1] != text) and self._changes < CHANGES_MAX and self._text <= TEXT_MAX:
                self._changes += 1
                self._text += len(text)
                known.append((t, text, type_name(value)))

    def recording(
        self,
        title: str,
        robot: VirtualRobot,
        source: SourceFile,
        run: Run,
        problems: Sequence[Diagnostic] | None = None,
    ) -> Recording:
        """Return what a page shows of the run.

        Args:
            title: of the page.
            robot: that has run.
            source: text of the program.
            run: its record.
            problems: findings of `check`; those of the run's own text if None.
        """
        if problems is None:
            problems = () if run.check_text is None else run.check_text()
        rows = self.sampling.rows
        return Recording(
            title,
            robot.model,
            rows,
            source,
            run.events,
            run.state,
            self.sampling.step_s,
            self._lines.stretches(rows.times[-1]),
            scene=self._scene,
            first=self._first,
            last=describe.moment(moment_of_run(run)),
            globals=self._globals,
            waits=self._waits,
            alarm=alarm_of(robot, run),
            contacts=contacts_of(run),
            problems=problems,
            findings=run.findings if run.has_findings else (),
        )
