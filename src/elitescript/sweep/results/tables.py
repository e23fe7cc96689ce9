"""Tables of results: one row for each run, in the order of their numbers, as CSV, JSON lines or Parquet."""

from __future__ import annotations

import json
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import IO, Any, Final, Protocol

from elitescript.codec.json_text import to_text
from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.outputs.call_paths import ORDINARY, why_not_written
from elitescript.outputs.writing import Output, WriteError
from elitescript.shown import encodable
from elitescript.sweep.chaos.properties import properties_of
from elitescript.sweep.plans.plan import Plan, Row

FORMATS: Final = {".csv": "csv", ".jsonl": "jsonl", ".parquet": "parquet"}
"""Formats by the suffix of the file."""

GROUP_ROWS: Final = 10_000
"""Rows of a group of a Parquet file, which is kept in memory until it is complete."""

FIXED: Final = ("run", "seed", "state", "time_s", "failed", "digest")
"""Columns that every table has."""


def format_of(path: Path) -> str:
    """Return the format of a table by the name of its file.

    Raises:
        UsageError: no such format, or the library for it is missing; the text says how to get it.
    """
    found = FORMATS.get(path.suffix.lower())
    if found is None:
        raise UsageError(f"--out {path}: the name must end in {', '.join(FORMATS)}")
    if found == "parquet":
        _pyarrow()
    return found


def check_table(path: Path) -> None:
    """Refuse a table that could not be written, before the first run.

    Raises:
        UsageError: no such format or folder, no file, or the library for the format is missing.
    """
    format_of(path)
    if why := why_not_written(path, ORDINARY):
        raise UsageError(f"--out {path}: {why}")


def columns(plan: Plan) -> tuple[str, ...]:
    """Return the names of the columns of a sweep.

    Raises:
        UsageError: two columns have the same name.
    """
    varied = [row.name for row in plan.variations]
    margins = [margin_column(text) for text in properties_of(plan)] if plan.has_margins else []
    names = ("run", "seed", *varied, "state", "time_s", *plan.measures, *margins, "failed", "digest")
    for name in plan.measures:
        if name in FIXED or name in varied:
            what = "a column that every table has" if name in FIXED else "what is varied"
            raise UsageError(f"--measure {name}: the name is that of {what}; choose another one")
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"two columns of the table would be called {name!r}")
    return names


def margin_column(text: str) -> str:
    """Return the name of the column with the margin of a property."""
    return f"margin of {text}"


def values(row: Row, plan: Plan) -> tuple[Any, ...]:
    """Return the cells of a row, in the order of `columns`."""
    choices = row.choices
    varied = [choices.values.get(variation.name) for variation in plan.variations]
    measures = [row.measures.get(name) for name in plan.measures]
    margins: list[Any] = []
    if plan.has_margins:
        margins = list(row.margins) or [None] * len(properties_of(plan))
    return (choices.run, choices.seed, *varied, row.state, row.time_s, *measures, *margins, row.failed, row.digest)


def write_table(target: Path | Output, plan: Plan, rows: Iterable[Row]) -> None:
    """Write a table in one pass; the file is there when it is complete, and not before.

    Raises:
        UsageError: the file cannot be written, or the library for its format is missing.
    """
    output = target if isinstance(target, Output) else output_of(target)
    try:
        with output as file:
            _WRITERS[format_of(output.path)](file, plan, rows)
    except WriteError as error:
        raise UsageError(str(error)) from error


def output_of(path: Path) -> Output:
    """Return what a table is written with.

    Raises:
        UsageError: it cannot be written, or another process writes it.
    """
    try:
        return Output(path, f"--out {path}")
    except WriteError as error:
        raise UsageError(str(error)) from error


class _Write(Protocol):
    def __call__(self, file: IO[bytes], plan: Plan, rows: Iterable[Row]) -> None: ...


def _write_csv(file: IO[bytes], plan: Plan, rows: Iterable[Row]) -> None:
    file.write(encodable(csv_line(columns(plan))).encode())
    for row in rows:
        file.write(encodable(csv_line(values(row, plan))).encode())


def csv_line(cells: Iterable[Any]) -> str:
    """Return a line of a CSV file: numbers in the shortest form that reads back, empty cells for None."""
    return ",".join(map(_cell, cells)) + "\n"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    text = value if isinstance(value, str) else json.dumps(value)
    if any(letter in text for letter in ',"\n\r'):
        return '"' + text.replace('"', '""') + '"'
    return text


def _write_jsonl(file: IO[bytes], plan: Plan, rows: Iterable[Row]) -> None:
    names = columns(plan)
    for row in rows:
        file.write((json_line(names, values(row, plan)) + "\n").encode())


def json_line(names: Iterable[str], cells: Iterable[Any]) -> str:
    """Return a row as one line of JSON."""
    return to_text(dict(zip(names, cells, strict=True)))


def _pyarrow() -> Any:
    return require("parquet")


def _write_parquet(file: IO[bytes], plan: Plan, rows: Iterable[Row]) -> None:
    arrow = _pyarrow()
    names = columns(plan)
    schema = arrow.schema([(name, _arrow_type(arrow, name, plan)) for name in names])
    cells = (values(row, plan) for row in rows)
    with arrow.parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        while group := list(islice(cells, GROUP_ROWS)):
            arrays = [
                arrow.array([_arrow_value(arrow, value, field.type) for value in column], field.type)
                for column, field in zip(zip(*group, strict=True), schema, strict=True)
            ]
            writer.write_table(arrow.Table.from_arrays(arrays, schema=schema))


def _arrow_type(arrow: Any, name: str, plan: Plan) -> Any:
    """Return the type of a column, which depends on the plan alone: rows of later groups must fit too."""
    if name in ("run", "seed"):
        return arrow.int64()
    if name in ("state", "failed", "digest"):
        return arrow.string()
    variation = next((row for row in plan.variations if row.name == name), None)
    if variation is None or variation.kind in ("uniform", "normal", "grid"):
        return arrow.float64()
    kinds = {type(value) for value in variation.arguments}
    if kinds == {bool}:
        return arrow.bool_()
    if kinds <= {int, float}:
        return arrow.float64()
    return arrow.string()


def _arrow_value(arrow: Any, value: Any, kind: Any) -> Any:
    if value is None:
        return None
    if kind == arrow.float64():
        return float(value)
    if kind == arrow.string():
        return encodable(value if isinstance(value, str) else json.dumps(value))
    return value


_WRITERS: Final[dict[str, _Write]] = {"csv": _write_csv, "jsonl": _write_jsonl, "parquet": _write_parquet}
