"""Makes what editors show of the last run out of the record of that run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final

from elitescript.assist.last_run import LastRun, LineTime, RunAlarm, RunFinding, ShortenedBlend
from elitescript.assist.units import value_text
from elitescript.debugger.values import shown
from elitescript.messages.events import Warned
from elitescript.messages.motion import shortened_radius
from elitescript.plotting.events import timed_moves
from elitescript.plotting.line_times import LineStretch
from elitescript.run import Run

FINDINGS_MAX: Final = 100
"""Findings of a run that editors show."""
_SHORT: Final = 10
_BITS: Final = 64
_ROOM: Final = 60
"""Characters of a value, but for what says how much is left out."""

_NO_COUNTS: Mapping[int, int] = {}
_NO_VALUES: Mapping[str, Mapping[str, str]] = {}


def last_run_of(
    run: Run,
    text: str,
    *,
    stretches: Iterable[LineStretch] = (),
    counts: Mapping[int, int] = _NO_COUNTS,
    values: Mapping[str, Mapping[str, str]] = _NO_VALUES,
) -> LastRun:
    """Return what editors show of a run that has ended.

    Args:
        run: the record.
        text: the text that ran.
        stretches: times during which the main thread stayed in one line.
        counts: how often each line ran, if statements were counted.
        values: last values of variables by scope, as `LastRun.values`; those of globals are taken from the run.
    """
    moves: dict[int, LineTime] = {}
    for move in timed_moves(run.events, run.time_s):
        before = moves.get(move.line, LineTime(0, 0.0))
        moves[move.line] = LineTime(before.times + 1, before.total_s + move.end_s - move.start_s)
    blends = {}
    for event in run.events:
        radii = shortened_radius(event.text) if isinstance(event, Warned) and event.line else None
        if radii is not None and isinstance(event, Warned):
            blends[event.line] = ShortenedBlend(*radii)
    lines = {line: LineTime(count, 0.0) for line, count in counts.items()}
    for stretch in stretches:
        time = lines.get(stretch.line, LineTime(0, 0.0))
        lines[stretch.line] = time._replace(total_s=time.total_s + stretch.end_s - stretch.start_s)
    known = {name: _text_of(value) for name, value in run.globals.items()}
    return LastRun(
        text=text,
        duration_s=run.time_s,
        moves=moves,
        lines=lines,
        values={**values, "": {**values.get("", {}), **known}},
        blends=blends,
        alarms=tuple(RunAlarm(alarm.line, alarm.code, alarm.text) for alarm in run.alarms),
        findings=tuple(_findings(run)),
    )


def _findings(run: Run) -> Iterator[RunFinding]:
    """Yield what the run has found, the worst first; what `check` finds too has a row of its own in editors."""
    for found in run.findings[:FINDINGS_MAX]:
        if found.t is not None and found.source != "check":
            rest = (found.code, str(found.text), str(found.hint), found.t, found.count)
            yield RunFinding(found.line, found.column, found.severity, *rest)


def _text_of(value: Any) -> str:
    """Return a value as editors show it: numbers and poses with few digits, anything else as the debugger shows it."""
    items = value if isinstance(value, list | tuple) and len(value) <= _SHORT else [value]
    if all(type(item) is float or (type(item) is int and item.bit_length() <= _BITS) for item in items):
        return value_text(value)
    return shown(value, _ROOM)
