"""Writes what has come of a text as pieces, each of which is read in a millisecond or so; see `loading`."""

from __future__ import annotations

import marshal
import struct
from collections.abc import Iterator
from itertools import groupby
from types import CodeType
from typing import Any, Final

from elitescript.codec.values import with_parts, write_text
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import CheckResult

PIECE_BYTES: Final = 64 * 1024
"""What is written as one piece, about; the code of one function cannot be divided."""
LENGTH: Final = struct.Struct(">I")

# The first byte of a piece, before its marshalled value.
VALUES: Final = b"V"
"""A list of constants, for the function that comes next."""
FUNCTION: Final = b"F"
"""`(count, code)`: a function without its constants, which are the last `count` values; it takes their place."""
PROBLEMS: Final = b"P"
"""A list of findings."""
STATEMENTS: Final = b"S"
"""A list of counted statements."""
UNIT: Final = b"U"
"""What else there is of a program whose function is the one value that is left."""
TREE: Final = b"T"
"""Of a graphical program, a part of its script; or nodes of lines, each with the number of lines in a row."""
END: Final = b"E"
"""Whether every error refuses the program."""


def packed(result: CheckResult) -> Iterator[bytes]:
    """Return a result as pieces, each with its length before it."""
    for mark, value in _pieces(result):
        data = marshal.dumps(value)
        yield LENGTH.pack(len(data) + 1) + mark + data


def _pieces(result: CheckResult) -> Iterator[tuple[bytes, Any]]:
    rows = [_problem(found) for found in result.problems]
    for at in range(0, len(rows), 200):
        yield PROBLEMS, rows[at : at + 200]
    if (unit := result.unit) is not None:
        yield from _tree(unit.source)
        probes = unit.probes
        for at in range(0, len(probes.statements), 1000):
            yield STATEMENTS, [tuple(row) for row in probes.statements[at : at + 1000]]
        yield from _function(unit.code, {})
        branches = [tuple(row) for row in probes.branches]
        functions = [tuple(row) for row in probes.functions]
        yield (
            UNIT,
            (
                unit.kind,
                unit.name,
                sorted(unit.global_names),
                unit.has_line_marks,
                unit.shows_hash_order,
                (probes.first, probes.size, branches, functions),
            ),
        )
    yield END, result.is_strict


def _tree(source: SourceFile) -> Iterator[tuple[bytes, Any]]:
    if not source.places:
        return
    for at in range(0, len(source.text), PIECE_BYTES):
        yield TREE, source.text[at : at + PIECE_BYTES]
    rows = [(place, len(list(lines))) for place, lines in groupby(source.places)]
    for at in range(0, len(rows), 1000):
        yield TREE, rows[at : at + 1000]


def _problem(found: Diagnostic) -> tuple[Any, ...]:
    """Return a finding without its repair, which no run needs."""
    place = (found.line, found.column, found.end_line, found.end_column)
    return (
        found.code,
        str(found.severity),
        *place,
        *(with_parts(write_text(text)) for text in (found.text, found.hint)),
    )


def _function(code: CodeType, sizes: dict[int, int]) -> Iterator[tuple[bytes, Any]]:
    batch: list[Any] = []
    size = 0
    for value in code.co_consts:
        if isinstance(value, CodeType) and _size(value, sizes) > PIECE_BYTES:
            yield VALUES, batch
            batch, size = [], 0
            yield from _function(value, sizes)
            continue
        batch.append(value)
        size += _size(value, sizes) if isinstance(value, CodeType) else len(marshal.dumps(value))
        if size > PIECE_BYTES:
            yield VALUES, batch
            batch, size = [], 0
    yield VALUES, batch
    yield FUNCTION, (len(code.co_consts), code.replace(co_consts=()))


def _size(code: CodeType, sizes: dict[int, int]) -> int:
    """Return about how many bytes a function has, with those in it."""
    found = sizes.get(id(code))
    if found is None:
        inner = sum(_size(value, sizes) if isinstance(value, CodeType) else 16 for value in code.co_consts)
        found = sizes[id(code)] = inner + 2 * len(code.co_code)
    return found
