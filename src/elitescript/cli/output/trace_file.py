"""Trace files: CSV or JSON lines. Floats keep every digit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType
from typing import TextIO

from elitescript.controller.views.trace import ACTUAL_COLUMNS, TRACE_COLUMNS, TraceRow
from elitescript.errors import UsageError
from elitescript.json_records import jsonlines
from elitescript.messages.signals import Value
from elitescript.paths import why_no_file


class TraceFile(AbstractContextManager["TraceFile"]):
    """Writes a trace to a file; `write` takes one row.

    Args:
        path: ends in `.csv` or `.jsonl`.
        has_actual: whether the rows hold measured joint positions.
        signals: names of the signals that the rows hold, one more column each; in CSV a digital one is 0 or 1.

    Raises:
        UsageError: another ending, or the file cannot be written.
    """

    write: Callable[[TraceRow], None]

    def __init__(self, path: Path, *, has_actual: bool = False, signals: Sequence[str] = ()) -> None:
        self._signals = signals
        self._columns = (*TRACE_COLUMNS, *(ACTUAL_COLUMNS if has_actual else ()), *signals)
        if path.suffix not in (".csv", ".jsonl"):
            raise UsageError(f"--trace {path}: the name must end in .csv or .jsonl")
        if why := why_no_file(path):
            raise UsageError(f"--trace {path}: it {why}")
        try:
            self._file: TextIO = path.open("w", encoding="utf-8", errors="backslashreplace", newline="")
        except OSError as error:
            raise UsageError(f"--trace {path}: {error.strerror or error}") from error
        if path.suffix == ".csv":
            self._file.write(",".join(self._columns) + "\n")
            self.write = self._write_csv
        else:
            self.write = self._write_json

    def _write_csv(self, row: TraceRow) -> None:
        levels = [str(int(level) if type(level) is bool else level) for level in self._levels(row)]
        self._file.write(",".join([*map(str, _flat(row)), *levels]) + "\n")

    def _write_json(self, row: TraceRow) -> None:
        values = (*_flat(row), *self._levels(row))
        self._file.write(jsonlines.line(dict(zip(self._columns, values, strict=True))) + "\n")

    def _levels(self, row: TraceRow) -> list[Value]:
        return [row.signals[name] for name in self._signals]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._file.close()


def _flat(row: TraceRow) -> tuple[float | int | str, ...]:
    return (row.t, row.line, *row.q, *row.qd, *row.tcp_pose, row.state, *(row.q_actual or ()))
