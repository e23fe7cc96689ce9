"""Rows of samples as binary frames, which a page reads without copying; `web/src/source/rows.ts` is the other side.

Little endian: `u32` magic "ESC1", `u32` run, `u32` first tick, `u32` ticks from one row to the next (0: the first
column lists the ticks), `u32` rows, `u16` columns, `u16` 0; for each column `u8` kind and `u8` number of its name;
zeros up to a multiple of 8; the columns one after the other, each filled up to a multiple of 8 bytes.

A float of 32 bits holds a joint to 2.4e-7 rad.
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import dist
from struct import Struct
from typing import Any, Final

from elitescript.controller.views.trace import ACTUAL_COLUMNS, TRACE_COLUMNS, TraceRow, TraceSpan
from elitescript.errors import UsageError
from elitescript.messages.motion import Six
from elitescript.messages.timing import PERIOD_S, ticks_for

COLUMNS: Final = (
    "tick",
    *("q1", "q2", "q3", "q4", "q5", "q6"),
    *("qd1", "qd2", "qd3", "qd4", "qd5", "qd6"),
    *("x", "y", "z", "rx", "ry", "rz"),
    "speed",
    *("qa1", "qa2", "qa3", "qa4", "qa5", "qa6"),
    *("fx", "fy", "fz", "mx", "my", "mz"),
)
"""Names of columns by their number: target positions and speeds of the joints, pose and speed of the TCP, measured
positions, wrench at the TCP. SI units, base frame. New ones are added at the end."""

KINDS: Final = {"f": 0, "d": 1, "H": 2, "i": 3}
"""Number of each kind of column, by the type code of its array: floats of 32 and 64 bits, 16 bits without sign, 32 bits
with sign."""

MAGIC: Final = 0x31435345
FRAME_BYTES_MAX: Final = 256 * 1024

_HEAD: Final = Struct("<IIIIIHH")
_NAMES: Final = (*TRACE_COLUMNS[2:-1], *ACTUAL_COLUMNS)
"""Columns of the numbers of a row, in their order."""
_WIDTH: Final = len(TRACE_COLUMNS) - 3
_WIDTH_WITH_ACTUAL: Final = _WIDTH + len(ACTUAL_COLUMNS)
_X: Final = _NAMES.index("x")
_FORMS: Final = {width: Struct(f"{width}d") for width in (_WIDTH, _WIDTH_WITH_ACTUAL)}


def frames(run: int, ticks: Sequence[int], columns: Mapping[str, Sequence[float]]) -> Iterator[bytes]:
    """Yield frames with all rows, each of at most `FRAME_BYTES_MAX`.

    Args:
        run: number of the run.
        ticks: of the rows, ascending.
        columns: the others by name; floats of 32 bits unless they are an array of another of `KINDS`.

    Raises:
        UsageError: no column of that name, or one of another length.
    """
    made = {
        name: values if isinstance(values, array) and values.typecode in KINDS else array("f", values)
        for name, values in columns.items()
    }
    for name, values in made.items():
        if name not in COLUMNS or name == COLUMNS[0]:
            raise UsageError(f"{name!r} is no column; there are {', '.join(COLUMNS[1:])}")
        if len(values) != len(ticks):
            raise UsageError(f"column {name} has {len(values)} rows, not {len(ticks)}")
    size = 4 + sum(values.itemsize for values in made.values())
    head = _padded(_HEAD.size + 2 * (len(made) + 1)) + 8 * (len(made) + 1)
    rows_max = max(1, (FRAME_BYTES_MAX - head) // size)
    for begin in range(0, len(ticks), rows_max):
        end = begin + rows_max
        yield _frame(run, ticks[begin:end], {name: values[begin:end] for name, values in made.items()})


def _frame(run: int, ticks: Sequence[int], columns: dict[str, array[float]]) -> bytes:
    count = len(ticks)
    step = ticks[1] - ticks[0] if count > 1 else 1
    if any(tick != ticks[0] + index * step for index, tick in enumerate(ticks)):
        listed: array[Any] = array("i", ticks)
        step, columns = 0, {COLUMNS[0]: listed, **columns}
    names = b"".join(bytes((KINDS[values.typecode], COLUMNS.index(name))) for name, values in columns.items())
    parts = [_HEAD.pack(MAGIC, run, ticks[0], step, count, len(columns), 0), names]
    parts.append(bytes(_padded(_HEAD.size + len(names)) - _HEAD.size - len(names)))
    for values in columns.values():
        data = _little_endian(values).tobytes()
        parts += [data, bytes(_padded(len(data)) - len(data))]
    return b"".join(parts)


def _padded(size: int) -> int:
    return (size + 7) & ~7


def _little_endian(values: array[float]) -> array[float]:
    if sys.byteorder == "big":
        values = values[:]
        values.byteswap()
    return values


class RowWriter:
    """Takes rows of a trace as they are recorded, and gives them as frames.

    Args:
        run: number of the run.
    """

    __slots__ = ("_last", "_numbers", "_ready", "_run", "_ticks", "_width")

    def __init__(self, run: int) -> None:
        self._run = run
        self._ticks = array("i")
        self._numbers = array("d")
        self._width = _WIDTH
        self._last: tuple[int, Six, tuple[float, ...]] | None = None
        """Tick, joints and place of the row before the next frame."""
        self._ready: list[bytes] = []

    def add(self, span: TraceSpan) -> None:
        """Take the rows of a span that is later than the others."""
        width = _WIDTH if span.q_actual is None else _WIDTH_WITH_ACTUAL
        self._widen(width)
        pack = _FORMS[width].pack
        if span.q_actual is None:
            packed = [pack(*q, *qd, *pose) for (q, qd), pose in zip(span.targets, span.tcp_poses, strict=True)]
        else:
            places = zip(span.targets, span.tcp_poses, span.q_actual, strict=True)
            packed = [pack(*q, *qd, *pose, *actual) for (q, qd), pose, actual in places]
        # Of an arm at rest the numbers are given once.
        self._numbers.frombytes(packed[0] * len(span.ticks) if span.is_at_rest else b"".join(packed))
        self._ticks.extend(span.ticks)

    def append(self, row: TraceRow) -> None:
        """Take a row that is later than the others."""
        numbers = (*row.q, *row.qd, *row.tcp_pose, *(row.q_actual or ()))
        self._widen(len(numbers))
        self._numbers.extend(numbers)
        self._ticks.append(ticks_for(row.t))

    def take(self) -> list[bytes]:
        """Return the frames with the rows since the last call."""
        self._pack()
        ready, self._ready = self._ready, []
        return ready

    def _widen(self, width: int) -> None:
        if width != self._width:
            self._pack()
            self._width = width

    def _pack(self) -> None:
        if not self._ticks:
            return
        width, numbers = self._width, self._numbers
        columns = {name: array("f", numbers[place::width]) for place, name in enumerate(_NAMES[:width])}
        columns["speed"] = self._speeds()
        self._ready += frames(self._run, self._ticks, columns)
        first = len(numbers) - width
        joints = numbers[first : first + 6]
        self._last = (self._ticks[-1], tuple(joints), tuple(numbers[first + _X : first + _X + 3]))  # type: ignore[assignment]
        self._ticks, self._numbers = array("i"), array("d")

    def _speeds(self) -> array[float]:
        """Return the mean speed of the TCP over the time before each row, m/s; zero at the first.

        A place that changes while the joints stand is another TCP, not a motion.
        """
        width, numbers = self._width, self._numbers
        joints = zip(*(numbers[place::width] for place in range(6)), strict=True)
        places = zip(*(numbers[place::width] for place in range(_X, _X + 3)), strict=True)
        speeds = array("f")
        last = self._last
        for tick, q, place in zip(self._ticks, joints, places, strict=True):
            if last is None or q == last[1]:
                speeds.append(0.0)
            else:
                speeds.append(dist(place, last[2]) / ((tick - last[0]) * PERIOD_S))
            last = (tick, q, place)
        return speeds


def frames_of(run: int, rows: Iterable[TraceRow]) -> list[bytes]:
    """Return the frames of recorded rows."""
    writer = RowWriter(run)
    for row in rows:
        writer.append(row)
    return writer.take()
