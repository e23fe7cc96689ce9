"""Keeps the rows of a trace as numbers, and makes them when they are read.

A row takes 8 bytes for its time and 96 for joints and speeds, 48 more once its pose has been read; one of an arm at
rest takes only those for its time. Line, state and signals are kept once for each stretch of rows that share them.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from operator import index as as_integer
from struct import Struct
from typing import Any, Final, overload

from elitescript.controller.views.trace import ACTUAL_COLUMNS, TRACE_COLUMNS, Trace, TraceRow, TraceSpan
from elitescript.controller.views.trace_signals import TraceSignals
from elitescript.errors import UsageError
from elitescript.kinematics.tcp import TcpKinematics
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.timing import TICKS_PER_S
from elitescript.records import NamedTuple

_WIDTH: Final = 12
"""Numbers of a row: joints, speeds."""
_WIDTH_WITH_ACTUAL: Final = 18
"""The same and measured joints."""
_FORMS: Final = {width: Struct(f"{width}d") for width in (_WIDTH, _WIDTH_WITH_ACTUAL)}
_POSE: Final = Struct("6d")
_POSE_NAMES: Final = TRACE_COLUMNS[2 + _WIDTH : -1]

_PLACES: Final = {name: place for place, name in enumerate((*TRACE_COLUMNS[2 : 2 + _WIDTH], *ACTUAL_COLUMNS))}
"""Place of each column but those of the pose among the numbers of a row."""

_CHUNK: Final = 1024
"""Rows whose numbers are copied at once while rows are read one after the other."""


class RowStretch(NamedTuple):
    """Rows one after the other that share line, state and signals."""

    begin: int
    """Index of the first row."""
    end: int
    """Index of the row after the last one."""
    line: int
    state: str
    signals: Mapping[str, Value]


class _Stretch:
    """Where the numbers of a stretch are; those of an arm at rest are there once."""

    __slots__ = ("begin", "first", "is_at_rest", "line", "poses", "signals", "state", "tcp", "width")

    def __init__(
        self,
        begin: int,
        first: int,
        width: int,
        is_at_rest: bool,
        line: int,
        state: str,
        signals: Mapping[str, Value],
        tcp: TcpKinematics | None,
    ) -> None:
        self.begin = begin
        """Index of the first row."""
        self.tcp = tcp
        """Gives the poses; None if they came with the rows."""
        self.poses = array("d")
        """Of its first rows, as many as have been computed, or came."""
        self.first = first
        """Index of its first number."""
        self.width = width
        """Numbers of a row."""
        self.is_at_rest = is_at_rest
        self.line = line
        self.state = state
        self.signals = signals

    def row(self, t: float, numbers: tuple[float, ...], pose: Six) -> TraceRow:
        """Return a row."""
        a, b, c, d, e, f, g, h, i, j, k, m, *actual = numbers
        q, qd = (a, b, c, d, e, f), (g, h, i, j, k, m)
        if not actual:
            return TraceRow(t, self.line, q, qd, pose, self.state, None, self.signals)
        a, b, c, d, e, f = actual
        return TraceRow(t, self.line, q, qd, pose, self.state, (a, b, c, d, e, f), self.signals)

    def pose(self, place: int, numbers: tuple[float, ...]) -> Six:
        """Return the pose of one row.

        Args:
            place: of the row among those of the stretch.
            numbers: of the row.
        """
        if 6 * place < len(self.poses):
            a, b, c, d, e, f = self.poses[6 * place : 6 * place + 6]
            return a, b, c, d, e, f
        assert self.tcp is not None
        a, b, c, d, e, f, *_ = numbers
        return self.tcp.pose((a, b, c, d, e, f))

    def place_rows(self, numbers: array[float], count: int) -> None:
        """Compute the poses of the first rows, as far as they have not been read before.

        Args:
            numbers: of all stretches.
            count: of the rows.
        """
        known = len(self.poses) // 6
        if self.tcp is None or count <= known:
            return
        width, first = self.width, self.first
        places = [numbers[first + known * width + joint : first + count * width : width] for joint in range(6)]
        poses = self.tcp.poses(list(zip(*places, strict=True)))
        self.poses.frombytes(b"".join([_POSE.pack(*pose) for pose in poses]))


class TraceRows(Sequence[TraceRow]):
    """Rows of a trace in the order of time; equal to any sequence of the same rows."""

    __slots__ = ("_begins", "_numbers", "_stretches", "_times")

    __hash__ = None  # type: ignore[assignment]

    def __init__(self, rows: Iterable[TraceRow] = ()) -> None:
        self._times = array("d")
        self._numbers = array("d")
        self._stretches: list[_Stretch] = []
        self._begins: list[int] = []
        """Index of the first row of each stretch."""
        for row in rows:
            self.append(row)

    # ---------------------------------------------------------------- writing

    def append(self, row: TraceRow) -> None:
        """Append a row that is later than the others."""
        numbers = (*row.q, *row.qd, *(row.q_actual or ()))
        width = len(numbers)
        stretch = self._put(_FORMS[width].pack(*numbers), width, False, row.line, row.state, row.signals, None)
        stretch.poses.extend(row.tcp_pose)
        self._times.append(row.t)

    def add(self, span: TraceSpan) -> None:
        """Append the rows of a span that is later than the others."""
        width = _WIDTH if span.q_actual is None else _WIDTH_WITH_ACTUAL
        pack = _FORMS[width].pack
        if span.q_actual is None:
            packed = [pack(*q, *qd) for q, qd in span.targets]
        else:
            packed = [pack(*q, *qd, *actual) for (q, qd), actual in zip(span.targets, span.q_actual, strict=True)]
        data, known = b"".join(packed), len(self._numbers)
        stretch = self._put(data, width, span.is_at_rest, span.line, span.state, span.signals, span.tcp)
        is_next = 6 * (known - stretch.first) == width * len(stretch.poses)
        if span.posed is not None and is_next and len(self._numbers) > known:
            # Something has read them, and those before: they need not be computed again.
            stretch.poses.frombytes(b"".join([_POSE.pack(*pose) for pose in span.posed]))
        self._times.extend([tick / TICKS_PER_S for tick in span.ticks])

    def _put(
        self,
        numbers: bytes,
        width: int,
        is_at_rest: bool,
        line: int,
        state: str,
        signals: Mapping[str, Value],
        tcp: TcpKinematics | None,
    ) -> _Stretch:
        """Append the numbers of the next rows, of rows at rest only if they are others than before; return where."""
        last = self._stretches[-1] if self._stretches else None
        if (
            last is None
            or last.line != line
            or last.signals is not signals
            or last.state != state
            or last.width != width
            or last.is_at_rest != is_at_rest
            or last.tcp is not tcp
            or (is_at_rest and self._numbers[-width:].tobytes() != numbers)
        ):
            begin = len(self._times)
            last = _Stretch(begin, len(self._numbers), width, is_at_rest, line, state, signals, tcp)
            self._stretches.append(last)
            self._begins.append(begin)
        elif is_at_rest:
            return last
        self._numbers.frombytes(numbers)
        return last

    def thin(self) -> None:
        """Drop every second row, but the first of those in one line, and the last row of all."""
        kept = self.thinned()
        self._times, self._numbers, self._stretches, self._begins = (
            kept._times,
            kept._numbers,
            kept._stretches,
            kept._begins,
        )

    def thinned(self) -> TraceRows:
        """Return the rows that `thin` keeps."""
        kept = TraceRows()
        view = memoryview(self._numbers).cast("B")
        line, is_even = -1, False
        last = len(self._times) - 1
        for stretch, (begin, end, *_) in zip(self._stretches, self.stretches(), strict=True):
            first = begin if stretch.line != line or not is_even else begin + 1
            line, is_even = stretch.line, (end - 1 - first) % 2 == 0
            indices = [*range(first, end, 2)]
            if end > last and not is_even:
                indices.append(last)
            if indices:
                size = 8 * stretch.width
                places = [0] if stretch.is_at_rest else [index - begin for index in indices]
                offsets = [8 * stretch.first + place * size for place in places]
                numbers = b"".join([view[offset : offset + size] for offset in offsets])
                state, signals, tcp = stretch.state, stretch.signals, stretch.tcp
                where = kept._put(numbers, stretch.width, stretch.is_at_rest, line, state, signals, tcp)
                if tcp is None:
                    for place in places:
                        where.poses.extend(stretch.poses[6 * place : 6 * place + 6])
                kept._times.extend([self._times[index] for index in indices])
        view.release()
        return kept

    # ---------------------------------------------------------------- reading

    @classmethod
    def of(cls, rows: Sequence[TraceRow]) -> TraceRows:
        """Return rows in this form: themselves if they have it already."""
        return rows if isinstance(rows, TraceRows) else cls(rows)

    @property
    def times(self) -> Sequence[float]:
        """Times of the rows, s; they grow with the rows."""
        return self._times

    @property
    def has_actual(self) -> bool:
        """Whether every row has measured joint positions."""
        return all(stretch.width == _WIDTH_WITH_ACTUAL for stretch in self._stretches)

    def stretches(self) -> list[RowStretch]:
        """Return the stretches of rows that share line, state and signals; neighbours may differ in none of them."""
        ends = [*self._begins[1:], len(self._times)] if self._begins else []
        return [
            RowStretch(its.begin, end, its.line, its.state, its.signals)
            for its, end in zip(self._stretches, ends, strict=True)
        ]

    def column(self, name: str) -> Sequence[float]:
        """Return the numbers of a column, one for each row.

        Args:
            name: `q1` to `q6`, `qd1` to `qd6`, `x`, `y`, `z`, `rx`, `ry`, `rz`, or `qa1` to `qa6` for measured joint
                positions, which are the targets where there is no plant.

        Raises:
            UsageError: there is no such column of numbers.
        """
        if name in _POSE_NAMES:
            return self._pose_column(_POSE_NAMES.index(name))
        place = _PLACES.get(name)
        if place is None:
            known = ", ".join((*TRACE_COLUMNS[2:-1], *ACTUAL_COLUMNS))
            raise UsageError(f"a trace has no column of numbers {name!r}; it has {known}")
        found = array("d")
        for stretch, (begin, end, *_) in zip(self._stretches, self.stretches(), strict=True):
            width = stretch.width
            first = stretch.first + (place if place < width else place - width)
            if stretch.is_at_rest:
                found.extend(array("d", [self._numbers[first]]) * (end - begin))
            else:
                found.extend(self._numbers[first : first + (end - begin) * width : width])
        return found

    def _pose_column(self, place: int) -> Sequence[float]:
        found = array("d")
        for stretch, (begin, end, *_) in zip(self._stretches, self.stretches(), strict=True):
            count = end - begin
            stretch.place_rows(self._numbers, 1 if stretch.is_at_rest else count)
            if stretch.is_at_rest:
                found.extend(array("d", [stretch.poses[place]]) * count)
            else:
                found.extend(stretch.poses[place : 6 * count : 6])
        return found

    def columns(self) -> dict[str, list[Any]]:
        """Return all columns as lists, by the names of `run --trace`: `pandas.DataFrame(run.trace.columns())`.

        `t` (s), `line`, `q1` to `q6` (rad), `qd1` to `qd6` (rad/s), `x` to `rz` (TCP pose in the base frame, m and
        rad), `state`; `qa1` to `qa6` where joints are measured; then the signals of the trace. `polars.DataFrame`,
        `pyarrow.table` and others take the same.
        """
        names = [*TRACE_COLUMNS[2:-1], *(ACTUAL_COLUMNS if self._stretches and self.has_actual else ())]
        numbers = {name: list(self.column(name)) for name in names}
        found: dict[str, list[Any]] = {"t": list(self._times), "line": [], "state": []}
        parts = self.stretches()
        signals = list(dict.fromkeys(name for part in parts for name in part.signals))
        found.update({name: [] for name in signals})
        for part in parts:
            count = part.end - part.begin
            found["line"] += [part.line] * count
            found["state"] += [part.state] * count
            for name in signals:
                found[name] += [part.signals[name]] * count
        found |= numbers
        order = (*TRACE_COLUMNS, *names[len(TRACE_COLUMNS) - 3 :], *signals)
        return {name: found[name] for name in order}

    def between(self, begin_s: float, end_s: float, every: int = 1) -> list[TraceRow]:
        """Return the rows from one time to another, both included, or only every second or third ... of them.

        The cost depends on the number of rows that are returned, not on the length of the trace.

        Args:
            begin_s: time of the first row at the earliest, s.
            end_s: time of the last row at the latest, s.
            every: from one row to the next, at least 1.

        Raises:
            UsageError: `every` is less.
        """
        if every < 1:
            raise UsageError(f"every must be at least 1 row, got {every}")
        return self[bisect_left(self._times, begin_s) : bisect_right(self._times, end_s) : every]

    def __len__(self) -> int:
        return len(self._times)

    @overload
    def __getitem__(self, index: int) -> TraceRow: ...

    @overload
    def __getitem__(self, index: slice) -> list[TraceRow]: ...

    def __getitem__(self, index: int | slice) -> TraceRow | list[TraceRow]:
        if isinstance(index, slice):
            return [self._row(number) for number in range(*index.indices(len(self._times)))]
        number, count = as_integer(index), len(self._times)
        if not -count <= number < count:
            raise IndexError(f"there is no row {number} of a trace of {count}")
        return self._row(number % count)

    def _row(self, index: int) -> TraceRow:
        stretch = self._stretches[bisect_right(self._begins, index) - 1]
        place = 0 if stretch.is_at_rest else index - stretch.begin
        numbers = _FORMS[stretch.width].unpack_from(self._numbers, 8 * (stretch.first + place * stretch.width))
        return stretch.row(self._times[index], numbers, stretch.pose(place, numbers))

    def __iter__(self) -> Iterator[TraceRow]:
        index = 0
        while index < len(self._times):
            place = bisect_right(self._begins, index)
            stretch = self._stretches[place - 1]
            end = self._begins[place] if place < len(self._begins) else len(self._times)
            times = self._times[index : min(end, index + _CHUNK)]
            if stretch.is_at_rest:
                row = self._row(index)
                yield from [row._replace(t=t) for t in times]
            else:
                first = stretch.first + (index - stretch.begin) * stretch.width
                # A copy: an array that is being read as it is could not grow.
                numbers = self._numbers[first : first + len(times) * stretch.width]
                place = index - stretch.begin
                stretch.place_rows(self._numbers, place + len(times))
                poses = stretch.poses[6 * place : 6 * (place + len(times))]
                yield from map(stretch.row, times, _FORMS[stretch.width].iter_unpack(numbers), _POSE.iter_unpack(poses))
            index += len(times)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TraceRows | list | tuple):
            return NotImplemented
        return len(self) == len(other) and all(row == its for row, its in zip(self, other, strict=True))

    def __add__(self, other: object) -> list[TraceRow]:
        return [*self, *other] if isinstance(other, TraceRows | list) else NotImplemented

    def __radd__(self, other: object) -> list[TraceRow]:
        return [*other, *self] if isinstance(other, list) else NotImplemented

    def __repr__(self) -> str:
        ends = f" from {self._times[0]:g} to {self._times[-1]:g} s" if self._times else ""
        return f"<{len(self)} trace rows{ends}>"


class TraceRecorder(Trace):
    """A trace that keeps its own rows.

    Args:
        step_s: as for `Trace`.
        signals: as for `Trace`.
        window_s: as for `Trace`.
        rows: where they are kept.
    """

    __slots__ = ("rows",)

    def __init__(
        self,
        step_s: float | None = None,
        signals: TraceSignals | None = None,
        window_s: tuple[float, float] | None = None,
        rows: TraceRows | None = None,
    ) -> None:
        self.rows = TraceRows() if rows is None else rows
        super().__init__(self.rows.append, step_s, signals, window_s)

    def _take(self, span: TraceSpan) -> None:
        self.rows.add(span)
