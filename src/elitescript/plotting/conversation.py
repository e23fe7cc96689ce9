"""Makes the conversation of a recorded run: what a live source would have said of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from elitescript import __version__
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.conversation import describe
from elitescript.conversation.describe import Message, Moment
from elitescript.conversation.limits import EVENTS_MAX, EventBudget
from elitescript.conversation.messages import RunOptions
from elitescript.conversation.recording import RecordedRun, recording
from elitescript.conversation.trees import nodes
from elitescript.json_records.jsonlines import plain
from elitescript.messages.signals import Value
from elitescript.messages.timing import seconds, ticks_for
from elitescript.plotting.events import timed_moves
from elitescript.plotting.line_times import line_times, stretches
from elitescript.plotting.recording import Recording
from elitescript.solids.scene import scene

ABILITIES: Final = ("seek", "step")
"""What a recorded run can do."""

RUN: Final = 1
"""Number of a recorded run."""

_COLUMNS: Final = (
    *(f"q{joint}" for joint in range(1, 7)),
    *(f"qd{joint}" for joint in range(1, 7)),
    *("x", "y", "z", "rx", "ry", "rz"),
)
_MEASURED: Final = tuple(f"qa{joint}" for joint in range(1, 7))


def packed(recordings: Sequence[Recording], bytes_max: int) -> tuple[bytes, float]:
    """Return recordings as bytes, and the time from one row to the next where rows were left out to fit.

    Args:
        recordings: that are shown over each other.
        bytes_max: rows are thinned until they take fewer bytes, events too if need be.

    Returns:
        the bytes, and the largest time between two rows, s; 0 if every row is there.
    """
    rows = [TraceRows.of(found.rows) for found in recordings]
    events_max, every = EVENTS_MAX, 1
    while True:
        runs = [recorded_run(found, kept, events_max) for found, kept in zip(recordings, rows, strict=True)]
        data = recording(runs)
        if len(data) <= bytes_max:
            break
        # What is left without rows tells which of the two takes the room.
        bare = len(recording([RecordedRun(run.said, [], {}, run.first, run.globals, run.waits) for run in runs]))
        if bare > bytes_max // 2 and events_max > 1000:
            events_max //= 2
        elif max(map(len, rows)) > 1000:
            rows = [kept.thinned() for kept in rows]
            every *= 2
        else:
            break
    return data, 0.0 if every == 1 else max(max(found.step_s, seconds(1)) * every for found in recordings)


def recorded_run(found: Recording, rows: TraceRows, events_max: int = EVENTS_MAX) -> RecordedRun:
    """Return one run with these of its rows."""
    names = _COLUMNS + (_MEASURED if rows.has_actual else ())
    ticks = [ticks_for(t) for t in rows.times]
    return RecordedRun(
        list(_said(found, events_max)),
        ticks,
        {name: rows.column(name) for name in names},
        found.first if found.first is not None else _moment(rows, 0),
        found.globals,
        found.waits,
    )


def _said(found: Recording, events_max: int) -> Iterator[Message]:
    rows = TraceRows.of(found.rows)
    end_s = rows.times[-1]
    version = 0 if found.source is None else 1
    yield describe.hello("recorded", f"elitescript {__version__}", ABILITIES, found.title)
    yield dict(found.scene) if found.scene is not None else scene(found.model)
    if found.source is not None:
        file: Message = {"type": "file", "name": found.title, "text": found.source.text, "digest": ""}
        yield file | {"tree": nodes(found.source.places)} if found.source.places else file
        yield describe.problems(version, found.problems, compiles=True)
    yield describe.run_began(RUN, version, RunOptions(robot=found.model.name))
    parts = stretches(rows)
    yield describe.lines(RUN, "main", [(part.start_s, part.line) for part in parts] or [(end_s, rows[0].line)])
    for name, known in found.thread_lines.items():
        if known:
            entries = [(part.start_s, part.line) for part in known]
            yield describe.lines(RUN, name, [*entries, (known[-1].end_s, 0)])
    yield describe.moves(RUN, timed_moves(found.events, end_s))
    budget = EventBudget(events_max)
    message = describe.events(RUN, found.events, budget)
    message["list"] += budget.last()
    message["list"] += _changes(rows)
    yield message
    if budget.events or budget.bytes:
        yield describe.left_out(RUN, budget)
    yield describe.cycle(RUN, line_times(rows))
    if found.contacts is not None:
        yield describe.contacts(RUN, found.contacts)
    last = found.last if found.last is not None else _moment(rows, len(rows) - 1)
    ended = {"type": "run_ended", "run": RUN, "state": found.state or "finished", "moment": last}
    if met := describe.run_findings(found.findings):
        ended["findings"] = met
    yield ended if found.alarm is None else ended | {"alarm": found.alarm}


def _changes(rows: TraceRows) -> list[dict[str, Any]]:
    """Return changes of the signals in the columns of a trace as events."""
    found: list[dict[str, Any]] = []
    first, *later = rows.stretches()
    known: dict[str, Value] = dict(first.signals)
    for part in later:
        for name, value in part.signals.items():
            if known[name] != value:
                known[name] = value
                t = rows.times[part.begin]
                found.append(
                    {"type": "signal", "t": t, "name": name, "value": plain(value), "by": "", "line": part.line}
                )
    return found


def _moment(rows: TraceRows, index: int) -> Mapping[str, Any]:
    """Return what a row tells of a moment."""
    row = rows[index]
    signals = {name: value for name, value in row.signals.items() if value}
    return describe.moment(Moment(row.t, row.line, row.q, row.tcp_pose, signals=signals))
