"""Lanes of the signals that changed, from the events of a run or the columns of a trace."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, Final

from elitescript.controller.views.trace import TraceRow
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.messages.events import Event, SignalChanged
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import seconds
from elitescript.plotting.decimation import extremes
from elitescript.plotting.packing import milliseconds

SIGNALS_MAX: Final = 64
"""Signals with a lane of their own: those that changed first. The others share one."""

CHANGES_MAX: Final = 400
"""Changes of one signal."""

CHANGES_IN_ALL: Final = 8000
"""Changes of all signals together."""

OTHERS_MAX: Final = 200
"""Changes in the lane that the other signals share."""


@dataclass(slots=True)
class _Steps:
    """Levels of one signal, each from its time on; the first is that at the start."""

    times: list[float]
    values: list[Value]
    causes: list[tuple[str, int]] = field(default_factory=lambda: [("", 0)])
    """What caused each, and the line of the statement."""

    def add(self, time_s: float, value: Value, by: str, line: int) -> None:
        """Append a level; of one tick the last level counts, as clients see it."""
        if self.times[-1] == time_s:
            self.values[-1], self.causes[-1] = value, (by, line)
            return
        self.times.append(time_s)
        self.values.append(value)
        self.causes.append((by, line))


def signal_lanes(events: Sequence[Event], start_s: float) -> dict[str, Any]:
    """Return lanes of the signals that changed, from events.

    Args:
        events: of a run, in order.
        start_s: where the lanes begin, s.

    Returns:
        `lanes`: for each signal `name`, `kind`, `unit`, times `t` (whole ms, each as the difference to the one
        before), levels `v` (None: not finite), `by` (indices into `causes`) and `left_out`, the number of changes
        that are not among them; terminals first, outputs before inputs. `causes`: pairs of `SignalChanged.by` and
        line. `others`: names of the signals that have no lane. `other_changes`: time, text and line of theirs.
        `other_changes_left_out`: how many more there were.
    """
    found: dict[str, _Steps] = {}
    for event in events:
        if isinstance(event, SignalChanged):
            if event.name not in found:
                found[event.name] = _Steps([start_s], [_value_before(event)])
            found[event.name].add(seconds(event.tick), event.value, event.by, event.line)
    others = set(list(found)[SIGNALS_MAX:])
    changes = [event for event in events if others and isinstance(event, SignalChanged) and event.name in others]
    return {
        **_lanes({name: steps for name, steps in found.items() if name not in others}),
        "others": sorted(others, key=_order),
        "other_changes": [
            [seconds(event.tick), f"{event.name} = {event.value}", event.line] for event in changes[:OTHERS_MAX]
        ],
        "other_changes_left_out": max(0, len(changes) - OTHERS_MAX),
    }


def signal_lanes_of_rows(rows: Sequence[TraceRow]) -> dict[str, Any]:
    """Return lanes of the signals in the columns of a trace: all of a few columns, of many those that changed.

    Returns:
        As `signal_lanes`; a trace has no causes of changes.
    """
    trace = TraceRows.of(rows)
    first, *others_after = trace.stretches()
    found = {name: _Steps([trace.times[0]], [value]) for name, value in first.signals.items()}
    for part in others_after:
        for name, steps in found.items():
            if (value := part.signals[name]) != steps.values[-1]:
                steps.add(trace.times[part.begin], value, "", 0)
    if len(found) > SIGNALS_MAX:
        found = {name: steps for name, steps in found.items() if len(steps.times) > 1}
    by_first_change = sorted(found, key=lambda name: found[name].times[1] if len(found[name].times) > 1 else 0.0)
    others = by_first_change[SIGNALS_MAX:]
    lanes = _lanes({name: found[name] for name in by_first_change[:SIGNALS_MAX]})
    left_out = sum(len(found[name].times) - 1 for name in others)
    return {**lanes, "others": others, "other_changes": [], "other_changes_left_out": left_out}


def _lanes(found: dict[str, _Steps]) -> dict[str, Any]:
    lanes, causes = [], {("", 0): 0}
    most = max(8, min(CHANGES_MAX, CHANGES_IN_ALL // max(1, len(found))))
    for name in sorted(found, key=_order):
        steps = found[name]
        kept = extremes(steps.times, [float(value) for value in steps.values], most)
        signal, _ = parse_signal_name(name)
        lanes.append(
            {
                "name": name,
                "kind": signal.kind,
                "unit": signal.unit,
                "left_out": len(steps.times) - len(kept),
                "t": milliseconds([steps.times[index] for index in kept]),
                "v": [_short(steps.values[index]) for index in kept],
                "by": [causes.setdefault(steps.causes[index], len(causes)) for index in kept],
            }
        )
    return {"lanes": lanes, "causes": [list(cause) for cause in causes]}


def _value_before(event: SignalChanged) -> Value:
    if isinstance(event.value, bool):
        return not event.value
    return parse_signal_name(event.name)[0].default


def _order(name: str) -> tuple[bool, bool, str, int]:
    """Sort terminals before registers and flags, outputs before inputs."""
    signal, index = parse_signal_name(name)
    return not signal.name.endswith(("_in", "_out")), signal.is_input, signal.name, index


def _short(value: Value) -> int | float | None:
    if not isfinite(value):
        return None
    return int(value) if isinstance(value, (bool, int)) else float(f"{value:.6g}")
