"""Trace files: CSV, JSON lines or Parquet. Floats keep every digit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from types import TracebackType
from typing import BinaryIO, Final

from elitescript.controller.views.trace import ACTUAL_COLUMNS, TRACE_COLUMNS, TraceRow
from elitescript.errors import ElitescriptError, UsageError
from elitescript.json_records import jsonlines
from elitescript.messages.signals import Value, parse_signal_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.outputs.writing import Output


GROUP_ROWS: Final = 20_000
"""Rows of a group of a Parquet file."""


class TraceFile(AbstractContextManager["TraceFile"]):
    """Writes a trace to a file; `write` takes one row.

    The file has its name when the run has ended, in whatever way: with Ctrl-C the rows so far are in it. If rows could
    not be written, or what the run prints is no longer read, what was there before is left.

    Args:
        output: file, whose name ends in `.csv`, `.jsonl` or `.parquet`.
        has_actual: whether the rows hold measured joint positions.
        signals: names of the signals that the rows hold, one more column each; in CSV a digital one is 0 or 1.

    Raises:
        UsageError: another ending, or the package for `.parquet` is missing.
        WriteError: the file cannot be written.
    """

    write: Callable[[TraceRow], None]

    def __init__(self, output: Output, *, has_actual: bool = False, signals: Sequence[str] = ()) -> None:
        self._signals = signals
        self._columns = (*TRACE_COLUMNS, *(ACTUAL_COLUMNS if has_actual else ()), *signals)
        if output.path.suffix not in (".csv", ".jsonl", ".parquet"):
            raise UsageError(f"{output.called}: the name must end in .csv, .jsonl or .parquet")
        self._table: _ParquetRows | None = None
        self._output = output
        self._put = output.file.write
        if output.path.suffix == ".csv":
            self._put((",".join(self._columns) + "\n").encode("utf-8", "backslashreplace"))
            self.write = self._write_csv
        elif output.path.suffix == ".parquet":
            self._table = _ParquetRows(output.file, self._columns, signals)
            self.write = self._write_table
        else:
            self.write = self._write_json

    def _write_csv(self, row: TraceRow) -> None:
        levels = [str(int(level) if type(level) is bool else level) for level in self._levels(row)]
        self._put((",".join([*map(str, _flat(row)), *levels]) + "\n").encode("utf-8", "backslashreplace"))

    def _write_json(self, row: TraceRow) -> None:
        values = (*_flat(row), *self._levels(row))
        self._put(
            (jsonlines.line(dict(zip(self._columns, values, strict=True))) + "\n").encode("utf-8", "backslashreplace")
        )

    def _write_table(self, row: TraceRow) -> None:
        assert self._table is not None
        self._table.add((*_flat(row), *self._levels(row)))

    def _levels(self, row: TraceRow) -> list[Value]:
        return [row.signals[name] for name in self._signals]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if error is None or isinstance(error, ElitescriptError):
            if self._table is not None:
                self._table.close()
            self._output.finish()
        else:
            self._output.drop()


class _ParquetRows:
    """Writes rows in groups, so that a long run takes no more memory than a short one.

    Args:
        file: of the table.
        columns: names of the columns of a row.
        signals: those of them that are signals.

    Raises:
        UsageError: the package for it is missing.
    """

    __slots__ = ("_arrow", "_rows", "_schema", "_writer")

    def __init__(self, file: BinaryIO, columns: Sequence[str], signals: Sequence[str]) -> None:
        # Imported late: few traces are tables.
        from elitescript.extras import require

        arrow = self._arrow = require("parquet", "a trace as Parquet")
        types = {"line": arrow.int64(), "state": arrow.string()}
        kinds = {"bool": arrow.bool_(), "int": arrow.int64()}
        types |= {name: kinds.get(parse_signal_name(name)[0].kind, arrow.float64()) for name in signals}
        self._schema = arrow.schema([(name, types.get(name, arrow.float64())) for name in columns])
        self._writer = arrow.parquet.ParquetWriter(file, self._schema, compression="zstd")
        self._rows: list[tuple[Value | str, ...]] = []

    def add(self, row: tuple[Value | str, ...]) -> None:
        """Append a row."""
        self._rows.append(row)
        if len(self._rows) == GROUP_ROWS:
            self._write()

    def close(self) -> None:
        """Write what is left, and the end of the file."""
        self._write()
        self._writer.close()

    def _write(self) -> None:
        columns = list(zip(*self._rows, strict=True)) or [()] * len(self._schema)
        arrays = [self._arrow.array(column, field.type) for column, field in zip(columns, self._schema, strict=True)]
        self._writer.write_table(self._arrow.Table.from_arrays(arrays, schema=self._schema))
        self._rows = []


def _flat(row: TraceRow) -> tuple[float | int | str, ...]:
    return (row.t, row.line, *row.q, *row.qd, *row.tcp_pose, row.state, *(row.q_actual or ()))
