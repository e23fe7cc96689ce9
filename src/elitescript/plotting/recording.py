"""A run, or only its trace, as a page shows it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from elitescript.controller.views.trace import TraceRow
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Event
from elitescript.messages.findings import Finding
from elitescript.models.model import RobotModel
from elitescript.plotting.line_times import LineStretch
from elitescript.records import field, record
from elitescript.solids.contacts import Contact


@record
class Recording:
    """Contents of a page.

    Attributes:
        title: of the page.
        model: the arm that moved, whose limits are drawn.
        rows: at least one row of a trace.
        source: text of the program; None if only the trace is known.
        events: of the run; times count like those of the rows.
        state: how the run ended; empty if only the trace is known.
        step_s: time between two rows, s; 0 if only the trace is known.
        thread_lines: where each thread beside the main one was, in the order in which they began.
        scene: message of the robot and what is around it; None: the arm alone.
        first, last: moments before the program began and at the end, as messages; None if only rows are known.
        globals: changes of each program global: time, s, its value and type as text.
        waits: for each thread the times, s, from which on it waits for something else, and what that is.
        alarm: what a page shows of the alarm that ended the run.
        contacts: of the run; None if nothing was around the robot.
        problems: findings of `check`.
        findings: of text and run.
    """

    title: str
    model: RobotModel
    rows: Sequence[TraceRow]
    source: SourceFile | None = None
    events: Sequence[Event] = ()
    state: str = ""
    step_s: float = 0.0
    thread_lines: Mapping[str, Sequence[LineStretch]] = field(default_factory=dict)
    scene: Mapping[str, Any] | None = None
    first: Mapping[str, Any] | None = None
    last: Mapping[str, Any] | None = None
    globals: Mapping[str, Sequence[tuple[float, str, str]]] = field(default_factory=dict)
    waits: Mapping[str, Sequence[tuple[float, str]]] = field(default_factory=dict)
    alarm: Mapping[str, Any] | None = None
    contacts: Sequence[Contact] | None = None
    problems: Sequence[Diagnostic] = ()
    findings: Sequence[Finding] = ()
