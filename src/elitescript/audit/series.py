"""One run as comparisons see it: the same numbers from a recording and from the simulated robot; and its marks."""

from __future__ import annotations

from array import array
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise
from math import isfinite
from operator import ne
from typing import Final

from elitescript.client.rtsi_signals import POINTS, levels_of
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.errors import UsageError
from elitescript.messages.enums import TaskState
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.messages.timing import PERIOD_S
from elitescript.recorder.recording import Recording
from elitescript.records import NamedTuple

STANDS_RAD_S: Final = 1e-3
"""Largest target speed of a joint of an arm that stands."""

TARGETS: Final = tuple(f"target_joint_positions.{joint}" for joint in range(6))
_SPEEDS: Final = tuple(f"target_joint_speeds.{joint}" for joint in range(6))
ACTUAL: Final = tuple(f"actual_joint_positions.{joint}" for joint in range(6))
_PLACES: Final = tuple(f"target_TCP_pose.{axis}" for axis in range(3))
LINE: Final = "script_control_line"
STATE: Final = "runtime_state"
SLIDER: Final = "target_speed_fraction"
SCALING: Final = "speed_scaling"


RUNNING: Final = (TaskState.PLAYING, TaskState.PAUSED)
"""States of a program that is not over."""

_LINES: Final = 1 << 31
"""Lines from which on a number is none."""


def line_of(value: float) -> int:
    """Return the line of a program that a row shows; 0 if it has none."""
    return int(value) if -_LINES <= value < _LINES else 0


class Change(NamedTuple):
    """A signal that has another level from a row on."""

    row: int
    name: str
    value: Value


class Mark(NamedTuple):
    """Something that happens in a run and by which runs are aligned."""

    row: int
    """First row that shows it."""
    key: tuple[str, Value]
    """`line` and its number, `moves` and whether the arm does, or an output and its level."""
    line: int
    """Of the program from this row on; of an edge the one before, which has caused it."""


class Series:
    """Numbers of one run, one row after the other, in order of time; SI units, base frame.

    Attributes:
        t: s since the program's begin.
        lines: of the main thread; 0 when no program runs.
        q: target positions of each joint, rad.
        qd: their speeds, rad/s.
        actual: measured positions, rad; None if they are not known.
        places: x, y and z of the target TCP, m; None if they are not known.
        scaling: how fast planned time passes, 0 to 1; None if it is not known.
        slider: speed slider, 0 to 1; None if it is not known.
        levels: of signals in the first row.
        changes: of signals in later rows.
        is_open: whether the run goes on behind the last row.
        is_headless: whether it began before the first row.
    """

    __slots__ = (
        "actual",
        "changes",
        "is_headless",
        "is_open",
        "levels",
        "lines",
        "places",
        "q",
        "qd",
        "scaling",
        "slider",
        "t",
    )

    def __init__(
        self,
        t: array[float],
        lines: array[int],
        q: Sequence[array[float]],
        qd: Sequence[array[float]],
        *,
        actual: Sequence[array[float]] | None = None,
        places: Sequence[array[float]] | None = None,
        scaling: array[float] | None = None,
        slider: array[float] | None = None,
        levels: Mapping[str, Value] | None = None,
        changes: Sequence[Change] = (),
        is_open: bool = False,
        is_headless: bool = False,
    ) -> None:
        self.t = t
        self.lines = lines
        self.q = q
        self.qd = qd
        self.actual = actual
        self.places = places
        self.scaling = scaling
        self.slider = slider
        self.levels = dict(levels or {})
        self.changes = changes
        self.is_open = is_open
        self.is_headless = is_headless

    def __len__(self) -> int:
        return len(self.t)

    @property
    def has_lines(self) -> bool:
        """Whether it is known where the program was."""
        return len({*self.lines} - {0}) > 1

    def stands(self, row: int) -> bool:
        """Return whether the arm stands in a row."""
        return all(abs(speed[row]) <= STANDS_RAD_S for speed in self.qd)

    def joints(self, row: int) -> Six:
        """Return the target positions in a row."""
        a, b, c, d, e, f = (column[row] for column in self.q)
        return (a, b, c, d, e, f)

    def waited_s(self, row: int) -> float:
        """Return the time without rows before a row, beyond a control period: how much later it may show something."""
        more_s = self.t[row] - self.t[row - 1] - PERIOD_S if row else 0.0
        return more_s if more_s > 0.5 * PERIOD_S else 0.0


def runs_of(recording: Recording) -> list[range]:
    """Return the rows of each run of a program: from the first row in which it runs to the first in which none does.

    The run that goes on at the end of the recording, or of a time of its controller, ends with the last row.
    """
    columns = recording.columns
    if STATE in columns:
        runs = [state in RUNNING for state in columns[STATE]]
    elif LINE in columns:
        runs = [line > 0 for line in columns[LINE]]
    else:
        runs = [True] * len(recording.t)
    found: list[range] = []
    begin: int | None = None
    restarts = set(recording.restarts)
    for row, is_running in enumerate(runs):
        if begin is not None and (row in restarts or not is_running):
            found.append(range(begin, row if row in restarts else row + 1))
            begin = None
        if begin is None and is_running:
            begin = row
    if begin is not None:
        found.append(range(begin, len(runs)))
    return found


def recorded(recording: Recording, rows: range) -> Series:
    """Return one run of a recording.

    Raises:
        UsageError: it has no target joints, or not in all of these rows.
    """
    begin, end = rows.start, rows.stop
    columns = recording.columns

    def six(names: Sequence[str]) -> list[array[float]] | None:
        if not all(name in columns for name in names):
            return None
        found = [columns[name][begin:end] for name in names]
        return found if all(map(isfinite, (sum(column) for column in found))) else None

    q = six(TARGETS)
    if q is None:
        raise UsageError("the recording has no target joint positions in all rows of this run, so nothing is compared")
    t0 = recording.t[begin]
    t = array("d", [time - t0 for time in recording.t[begin:end]])
    qd = six(_SPEEDS) or [_slopes(t, column) for column in q]
    lines = array("l", bytes(array("l").itemsize * len(t)))
    if LINE in columns:
        lines = array("l", map(line_of, columns[LINE][begin:end]))
    levels, changes = _signals(columns, rows)

    def one(name: str) -> array[float] | None:
        found = columns[name][begin:end] if name in columns else None
        return found if found and isfinite(sum(found)) else None

    # Without a state the line says whether the program runs; without both a run has no end that could be seen.
    is_open = (
        columns[STATE][end - 1] in RUNNING if STATE in columns else LINE not in columns or columns[LINE][end - 1] > 0
    )
    return Series(
        t,
        lines,
        q,
        qd,
        actual=six(ACTUAL),
        places=six(_PLACES),
        scaling=one(SCALING),
        slider=one(SLIDER),
        levels=levels,
        changes=changes,
        is_open=is_open,
        is_headless=begin == 0 or begin in recording.restarts,
    )


def simulated(rows: TraceRows, joints: Six, place: Six, *, is_open: bool) -> Series:
    """Return a run of the simulated robot.

    A row of a trace has the joints at the end of its tick, which clients of the robot are given with the next one; so
    they are moved by one row.

    Args:
        rows: with every control period, and with all signals that are compared.
        joints: target positions at the start, rad.
        place: TCP there.
        is_open: whether the program did not come to its end.
    """
    t0 = rows.times[0]

    def moved(name: str, first: float) -> array[float]:
        return array("d", [first, *rows.column(name)[:-1]])

    lines = array("l")
    levels: dict[str, Value] = {}
    changes: list[Change] = []
    last: Mapping[str, Value] = {}
    for part in rows.stretches():
        lines.extend(array("l", [part.line]) * (part.end - part.begin))
        if part.signals is not last:
            if part.begin == 0:
                levels = dict(part.signals)
            else:
                changes += [
                    Change(part.begin, name, value) for name, value in part.signals.items() if last[name] != value
                ]
            last = part.signals
    actual = None
    if rows.has_actual:
        actual = [moved(f"qa{joint}", joints[joint - 1]) for joint in range(1, 7)]
    return Series(
        array("d", [time - t0 for time in rows.times]),
        lines,
        [moved(f"q{joint}", joints[joint - 1]) for joint in range(1, 7)],
        [moved(f"qd{joint}", 0.0) for joint in range(1, 7)],
        actual=actual,
        places=[moved(axis, first) for axis, first in zip(("x", "y", "z"), place, strict=False)],
        levels=levels,
        changes=changes,
        is_open=is_open,
    )


def marks_of(series: Series, outputs: Collection[str], *, by_lines: bool) -> list[Mark]:
    """Return the marks of a run in order; of one row the edges of outputs come before the line that follows them.

    Args:
        series: of the run.
        outputs: signals whose edges are marks.
        by_lines: whether changes of the line are; else those from standing to moving and back.
    """
    found = [
        Mark(change.row, (change.name, change.value), series.lines[max(change.row - 1, 0)])
        for change in series.changes
        if change.name in outputs
    ]
    if by_lines:
        lines = series.lines
        changed = [0, *(row for row, differs in enumerate(map(ne, lines, lines[1:]), 1) if differs)]
        found += [Mark(row, ("line", lines[row]), lines[row]) for row in changed]
    else:
        moves = [not series.stands(row) for row in range(len(series))]
        changed = [0, *(row for row, (before, now) in enumerate(pairwise(moves), 1) if before != now)]
        found += [Mark(row, ("moves", moves[row]), series.lines[row]) for row in changed]
    # Sorting keeps the order of one row: edges by name first.
    found.sort(key=lambda mark: (mark.row, mark.key[0] in ("line", "moves"), mark.key[0]))
    return found


def edges_of(signals: Iterable[str], driven: Iterable[str]) -> set[str]:
    """Return the signals whose changes are marks: outputs, but not the numbers that change with every row.

    Args:
        signals: that are compared.
        driven: inputs that devices of the simulated cell set; what these do is a result too.
    """
    return {name for name in signals if _is_edge(name)} | {name for name in driven if _kind(name) != "float"}


def _is_edge(name: str) -> bool:
    row, _ = parse_signal_name(name)
    return not row.is_input and row.kind != "float"


def _kind(name: str) -> str:
    return parse_signal_name(name)[0].kind


def recorded_signals(recording: Recording) -> list[str]:
    """Return the signals that a recording shows. What a recorder has left out was 0 all the time."""
    is_whole = "host" in recording.facts
    return [
        name for variable in POINTS if is_whole or variable in recording.columns for name in POINTS[variable] if name
    ]


def _signals(columns: Mapping[str, array[float]], rows: range) -> tuple[dict[str, Value], list[Change]]:
    levels: dict[str, Value] = {}
    changes: list[Change] = []
    for variable in POINTS:
        if variable not in columns:
            continue
        values = columns[variable][rows.start : rows.stop]
        if values.tobytes() == values[:1].tobytes() * len(values):
            places: Iterable[int] = ()
        else:
            places = [place for place, differs in enumerate(map(ne, values, values[1:]), 1) if differs]
        known: dict[str, Value] = {}
        for place in (0, *places):
            if not isfinite(values[place]):
                continue
            for name, level in levels_of(variable, values[place]).items():
                if name not in known:
                    levels[name] = level
                elif known[name] != level:
                    changes.append(Change(place, name, level))
                known[name] = level
    changes.sort(key=lambda change: change.row)
    return levels, changes


def _slopes(t: array[float], values: array[float]) -> array[float]:
    slopes = array("d", [0.0])
    slopes.extend(
        [
            (now - before) / max(t_now - t_before, 1e-9)
            for (t_before, t_now), (before, now) in zip(pairwise(t), pairwise(values), strict=True)
        ]
    )
    return slopes
