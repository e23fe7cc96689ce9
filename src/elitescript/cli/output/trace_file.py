"""Trace files: CSV or JSON lines. Floats keep every digit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from types import TracebackType

from elitescript.controller.views.trace import ACTUAL_COLUMNS, TRACE_COLUMNS, TraceRow
from elitescript.errors import ElitescriptError, UsageError
from elitescript.json_records import jsonlines
from elitescript.messages.signals import Value

TYPE_CHECKING = False
if TYPE_CHECKING:
    from elitescript.outputs.writing import Output


class TraceFile(AbstractContextManager["TraceFile"]):
    """Writes a trace to a file; `write` takes one row.

    The file has its name when the run has ended, in whatever way: with Ctrl-C the rows so far are in it. If rows could
    not be written, or what the run prints is no longer read, what was there before is left.

    Args:
        output: file, whose name ends in `.csv` or `.jsonl`.
        has_actual: whether the rows hold measured joint positions.
        signals: names of the signals that the rows hold, one more column each; in CSV a digital one is 0 or 1.

    Raises:
        UsageError: another ending.
        WriteError: the file cannot be written.
    """

    write: Callable[[TraceRow], None]

    def __init__(self, output: Output, *, has_actual: bool = False, signals: Sequence[str] = ()) -> None:
        self._signals = signals
        self._columns = (*TRACE_COLUMNS, *(ACTUAL_COLUMNS if has_actual else ()), *signals)
        if output.path.suffix not in (".csv", ".jsonl"):
            raise UsageError(f"{output.called}: the name must end in .csv or .jsonl")
        self._output = output
        self._put = output.file.write
        if output.path.suffix == ".csv":
            self._put((",".join(self._columns) + "\n").encode("utf-8", "backslashreplace"))
            self.write = self._write_csv
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

    def _levels(self, row: TraceRow) -> list[Value]:
        return [row.signals[name] for name in self._signals]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if error is None or isinstance(error, ElitescriptError):
            self._output.finish()
        else:
            self._output.drop()


def _flat(row: TraceRow) -> tuple[float | int | str, ...]:
    return (row.t, row.line, *row.q, *row.qd, *row.tcp_pose, row.state, *(row.q_actual or ()))
