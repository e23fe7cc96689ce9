"""Times by program line: stretches in one line, and the sum for each line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from elitescript.controller.views.trace import TraceRow
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.messages.timing import seconds
from elitescript.plotting.curves import joint_changes
from elitescript.records import NamedTuple


class LineStretch(NamedTuple):
    """A time during which the main thread stayed in one line."""

    start_s: float
    end_s: float
    line: int
    """0 when no program ran."""


class LineTime(NamedTuple):
    """Time of one line in all."""

    line: int
    moving_s: float
    """While the arm moved."""
    standing_s: float
    """While it did not."""
    visits: int
    """Stretches: how often the program came to this line from another one."""


class ThreadLines:
    """Records in which line each thread beside the main one is; called after every tick of a run."""

    __slots__ = ("_open", "_told")

    def __init__(self) -> None:
        self._told: dict[str, int] = {}
        """For each thread how many of its times `news` has returned."""
        self._open: dict[str, list[tuple[float, int]]] = {}
        """For each thread the times at which it came to a line; line 0 while there is no such thread."""

    def record(self, time_s: float, threads: Iterable[tuple[str, int]]) -> None:
        """Record the lines of the threads.

        Args:
            time_s: of the tick, s; ascending.
            threads: name and line of each; one that is missing has ended.
        """
        lines = dict(threads)
        for name in lines.keys() - self._open.keys():
            self._open[name] = []
        for name, entries in self._open.items():
            line = lines.get(name, 0)
            if not entries or entries[-1][1] != line:
                entries.append((time_s, line))

    def news(self) -> dict[str, list[tuple[float, int]]]:
        """Return for each thread the times, s, at which it came to a line since the last call, with the line."""
        found = {name: entries[self._told.get(name, 0) :] for name, entries in self._open.items()}
        self._told = {name: len(entries) for name, entries in self._open.items()}
        return {name: entries for name, entries in found.items() if entries}

    def stretches(self, end_s: float) -> dict[str, list[LineStretch]]:
        """Return the stretches of each thread up to a time; they follow each other without gaps."""
        return {
            name: [
                LineStretch(start_s, later_s, line)
                for (start_s, line), (later_s, _) in pairwise([*entries, (end_s, 0)])
                if later_s > start_s
            ]
            for name, entries in self._open.items()
        }


def stretches(rows: Sequence[TraceRow]) -> list[LineStretch]:
    """Return the stretches of a trace; they follow each other without gaps. A row lasts until the next one."""
    found: list[LineStretch] = []
    trace = TraceRows.of(rows)
    times, parts = trace.times, trace.stretches()
    start_s, line = times[0], parts[0].line
    for part in parts:
        if part.line != line:
            found.append(LineStretch(start_s, times[part.begin], line))
            start_s, line = times[part.begin], part.line
    if times[-1] > start_s:
        found.append(LineStretch(start_s, times[-1], line))
    return found


def line_times(rows: Sequence[TraceRow]) -> list[LineTime]:
    """Return the time by line, the longest first; the sum over all lines is the duration of the trace."""
    trace = TraceRows.of(rows)
    moving: dict[int, float] = {}
    standing: dict[int, float] = {}
    visits: dict[int, int] = {}
    for stretch in stretches(trace):
        visits[stretch.line] = visits.get(stretch.line, 0) + 1
    # A row shows the state at the end of its tick. So where rows are one tick apart, the change since the row before is
    # the motion of this one; where they are further apart, most of it lies in the change to the next.
    times_s, far_s = trace.times, 1.5 * seconds(1)
    changes = [any(trace[0].qd), *joint_changes(trace)]
    for part in trace.stretches():
        line = part.line
        for index in range(part.begin, min(part.end, len(trace) - 1)):
            t_s, later_s = times_s[index], times_s[index + 1]
            times = moving if changes[index + (later_s - t_s > far_s)] else standing
            times[line] = times.get(line, 0.0) + later_s - t_s
    table = [LineTime(line, moving.get(line, 0.0), standing.get(line, 0.0), visits[line]) for line in visits]
    return sorted(table, key=lambda entry: (-entry.moving_s - entry.standing_s, entry.line))


def merged(found: Sequence[LineStretch], stretches_max: int) -> list[LineStretch]:
    """Return fewer stretches: runs of short ones become one, under the line that took most of it."""
    if len(found) <= stretches_max:
        return list(found)
    shortest_s = 2.0 * (found[-1].end_s - found[0].start_s) / stretches_max
    result: list[LineStretch] = []
    shares: dict[int, float] = {}
    start_s = found[0].start_s

    def close(end_s: float) -> None:
        if shares:
            line = max(shares, key=lambda candidate: shares[candidate])
            result.append(LineStretch(start_s, end_s, line))
            shares.clear()

    for stretch in found:
        if stretch.end_s - stretch.start_s >= shortest_s:
            close(stretch.start_s)
            result.append(stretch)
            start_s = stretch.end_s
            continue
        shares[stretch.line] = shares.get(stretch.line, 0.0) + stretch.end_s - stretch.start_s
        if stretch.end_s - start_s >= shortest_s:
            close(stretch.end_s)
            start_s = stretch.end_s
    close(found[-1].end_s)
    return result
