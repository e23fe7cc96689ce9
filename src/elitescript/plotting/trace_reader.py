"""Reads a trace from its file, row by row, and locates every mistake."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, Final

from elitescript.controller.views.trace import ACTUAL_COLUMNS, TRACE_COLUMNS, TraceRow
from elitescript.controller.views.trace_rows import TraceRows
from elitescript.controller.views.trace_signals import NO_SIGNALS, SignalLevels
from elitescript.errors import UsageError
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value, parse_signal_name
from elitescript.untrusted.files import TRACE, read_text
from elitescript.untrusted.json_text import JsonError, json_value

SUFFIXES: Final = (".csv", ".jsonl")
"""Suffixes of trace files."""

_NUMBERS: Final = tuple(name for name in TRACE_COLUMNS if name not in ("line", "state"))


def read_trace(path: Path) -> TraceRows:
    """Return the rows of a trace file, in the order of time.

    The order of the columns is free. Measured joint positions are read where a row has all six, and signals where a
    column has the name of one; other columns are ignored.

    Raises:
        UsageError: the file cannot be read or is not a trace; the text begins with `file:line:`.
    """
    return trace_of(path, read_text(path, TRACE, is_stream_allowed=True))


def trace_of(path: Path, text: str) -> TraceRows:
    """Return the rows in the text of a trace file; see `read_trace`."""
    lines = text.split("\n")
    records = _csv_records(path, lines) if path.suffix == ".csv" else _json_records(path, lines)
    rows = TraceRows()
    columns: tuple[str, ...] = ()
    kinds: dict[str, str] = {}
    levels: dict[str, Value] = {}
    signals = NO_SIGNALS
    for number, record in records:
        place = f"{path}:{number}"
        if (names := tuple(record)) != columns:
            columns, kinds = names, {name: kind for name in names if (kind := _kind_of_signal(name))}
        found = {name: _level(place, name, record[name], kind) for name, kind in kinds.items()}
        if found != levels:
            levels, signals = found, SignalLevels(found)
        row = _row(place, record)._replace(signals=signals)
        if rows and not row.t > rows.times[-1]:
            raise UsageError(f"{path}:{number}: t = {row.t:g} s does not come after the {rows.times[-1]:g} s before it")
        rows.append(row)
    if not rows:
        raise UsageError(f"{path}:{max(1, text.count(chr(10)))}: the trace has no rows")
    return rows


def _csv_records(path: Path, lines: Iterable[str]) -> Iterator[tuple[int, Mapping[str, Any]]]:
    numbered = enumerate(lines, 1)
    header = [name.strip() for name in next(numbered)[1].split(",")]
    _require_columns(f"{path}:1", header)
    for number, line in numbered:
        if not line.strip():
            continue
        cells = line.strip("\r").split(",")
        if len(cells) != len(header):
            raise UsageError(f"{path}:{number}: {len(cells)} cells, but the header has {len(header)}")
        yield number, dict(zip(header, cells, strict=True))


def _json_records(path: Path, lines: Iterable[str]) -> Iterator[tuple[int, Mapping[str, Any]]]:
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            record = json_value(line)
        except JsonError as error:
            raise UsageError(f"{path}:{number}: not JSON: {error}") from None
        if not isinstance(record, dict):
            raise UsageError(f"{path}:{number}: needs an object with the columns of a trace, has {line.strip()[:60]}")
        _require_columns(f"{path}:{number}", record)
        yield number, record


def _require_columns(place: str, names: Iterable[str]) -> None:
    missing = [name for name in TRACE_COLUMNS if name not in set(names)]
    if missing:
        raise UsageError(f"{place}: not a trace: no column {', '.join(missing)}")


def _row(place: str, record: Mapping[str, Any]) -> TraceRow:
    values = [_number(place, name, record[name]) for name in _NUMBERS]
    line = _number(place, "line", record["line"])
    if line < 0 or line != int(line):
        raise UsageError(f"{place}: line: needs a line number of the program, or 0, has {record['line']!r}")
    a, b, c, d, e, f = values[1:7]
    g, h, i, j, k, m = values[7:13]
    x, y, z, rx, ry, rz = values[13:19]
    q, qd, pose = (a, b, c, d, e, f), (g, h, i, j, k, m), (x, y, z, rx, ry, rz)
    return TraceRow(values[0], int(line), q, qd, pose, str(record["state"]), _q_actual(place, record))


def _kind_of_signal(column: str) -> str:
    """Return the kind of the signal of that name; empty if the column is not a signal."""
    if column in TRACE_COLUMNS or column in ACTUAL_COLUMNS:
        return ""
    try:
        return parse_signal_name(column)[0].kind
    except UsageError:
        return ""


def _level(place: str, column: str, value: Any, kind: str) -> Value:
    if kind == "float" and str(value) in ("inf", "-inf", "nan"):
        return float(value)
    number = float(value) if isinstance(value, bool) else _number(place, column, value)
    if kind == "float":
        return number
    if number != int(number):
        raise UsageError(f"{place}: {column}: needs a whole number, has {value!r}")
    return bool(number) if kind == "bool" else int(number)


def _q_actual(place: str, record: Mapping[str, Any]) -> Six | None:
    if not all(name in record for name in ACTUAL_COLUMNS):
        return None
    a, b, c, d, e, f = [_number(place, name, record[name]) for name in ACTUAL_COLUMNS]
    return (a, b, c, d, e, f)


def _number(place: str, column: str, value: Any) -> float:
    try:
        number = float("nan") if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = float("nan")
    if not isfinite(number):
        raise UsageError(f"{place}: {column}: needs a finite number, has {value!r}")
    return number
