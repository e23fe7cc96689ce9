"""The page of an audit: the simulated run with the recorded one laid over it."""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.audit.findings import AuditedRun, AuditFindings
from elitescript.audit.series import STATE
from elitescript.audit.simulation import play, started_robot
from elitescript.audit.verdict import findings_of
from elitescript.controller.views.trace import TraceRow
from elitescript.controller.views.trace_signals import SignalLevels
from elitescript.kinematics.tcp import tcp_poses
from elitescript.language.text.source import SourceFile
from elitescript.messages.enums import TaskState
from elitescript.messages.motion import Six
from elitescript.plotting.page import Page, page_of
from elitescript.plotting.recorder import RunRecorder
from elitescript.plotting.recording import Recording as Plotted
from elitescript.plotting.sampling import ROWS_MAX, Sampling
from elitescript.recorder.recording import Recording
from elitescript.records import replace


def audit_page(audit: AuditFindings, title: str) -> Page:
    """Return the page of the first run that differs, or of the first.

    Args:
        audit: that was made.
        title: of the recorded run.
    """
    run = audit.first
    robot, _ = started_robot(audit.cell, run.inputs)
    recorder = RunRecorder(robot, Sampling())
    _, made = play(
        audit.cell,
        run.inputs,
        run.recorded,
        run.marks,
        recorder.sampling,
        by_lines=run.by_lines,
        robot=robot,
        watch=recorder.watch,
    )
    simulated = recorder.recording(f"{audit.cell.source.name}, simulated", robot, audit.cell.source, made)
    begin_s = simulated.rows[0].t
    # Of the run itself and of what differs, in the time of the rows; what the text alone shows has no time.
    found = [its if its.t is None else replace(its, t=begin_s + its.t) for its in findings_of(audit)]
    simulated = replace(simulated, findings=found)
    rows = rows_of(audit.recording, run, audit, begin_s)
    title += "".join(f", {words}" for words in _cut(run))
    return page_of(simulated, Plotted(title, audit.model, rows, recorded_source(audit)))


def _cut(run: AuditedRun) -> Iterator[str]:
    """Say where the recording of a run begins or ends before the run does."""
    series = run.recorded
    if series.is_headless:
        yield "begins within the program"
    if series.is_open:
        yield f"ends at {series.t[-1]:.3f} s in line {series.lines[-1]}"


def recorded_source(audit: AuditFindings) -> SourceFile:
    """Return the text of recorded lines: the program kept in the recording, else the one that was simulated.

    Without it no line of one run is found in the other.
    """
    name = str(audit.recording.facts.get("program", ""))
    data = audit.recording.attachments.get(name)
    return audit.cell.source if data is None else SourceFile(f"<{name}>", data.decode("utf-8", "replace"))


def rows_of(recording: Recording, run: AuditedRun, audit: AuditFindings, begin_s: float) -> list[TraceRow]:
    """Return the recorded run as rows of a trace.

    Args:
        recording: with the run.
        run: of it.
        audit: with the arm.
        begin_s: time of the first row.
    """
    series = run.recorded
    every = max(1, len(series) // ROWS_MAX)
    rows = range(0, len(series), every)
    names = [f"target_TCP_pose.{axis}" for axis in range(6)]
    first = next(row for row, t in enumerate(recording.t) if t == run.begin_s)
    poses: list[Six] = []
    if all(name in recording.columns for name in names):
        for row in rows:
            x, y, z, rx, ry, rz = (recording.columns[name][first + row] for name in names)
            poses.append((x, y, z, rx, ry, rz))
    else:
        poses = list(
            tcp_poses(
                audit.model.arm, [series.joints(row) for row in rows], run.simulated.robot.controller.setup.T_flange_tcp
            )
        )
    states = recording.columns.get(STATE)
    levels, changes, at = dict(series.levels), list(series.changes), 0
    shown = SignalLevels(dict(levels))
    found: list[TraceRow] = []
    for row, pose in zip(rows, poses, strict=True):
        is_changed = False
        while at < len(changes) and changes[at].row <= row:
            levels[changes[at].name] = changes[at].value
            at, is_changed = at + 1, True
        if is_changed:
            shown = SignalLevels(dict(levels))
        state = TaskState.PLAYING if states is None else TaskState(int(states[first + row]))
        a, b, c, d, e, f = (column[row] for column in series.qd)
        actual: Six | None = None
        if series.actual is not None:
            g, h, i, j, k, m = (column[row] for column in series.actual)
            actual = (g, h, i, j, k, m)
        found.append(
            TraceRow(
                begin_s + series.t[row],
                series.lines[row],
                series.joints(row),
                (a, b, c, d, e, f),
                pose,
                state.name.lower(),
                actual,
                shown,
            )
        )
    return found
