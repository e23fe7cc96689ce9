"""What a program could run, from its text, and what it has run, from its counters."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from elitescript.coverage.model import Branch, Function, Handler, ProgramCoverage
from elitescript.language.compiler import compile_parsed
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.probes import HITS_PROBES, ProbeTable
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple

_OPTIONS: Final = Options(probes=HITS_PROBES)


class HandlerText(NamedTuple):
    """An `except` clause: its line, its text, and the lines of the statements in it."""

    line: int
    text: str
    body: tuple[int, ...]


class AnalysedProgram(NamedTuple):
    """A program text with all that can be counted in it.

    Attributes:
        source: the text.
        kind: `program`, `secondary` or `script`.
        table: what the numbers of its counters mean.
        handlers: in the order of the text.
        calls: line of the first call of every name that it calls.
    """

    source: SourceFile
    kind: str
    table: ProbeTable
    handlers: tuple[HandlerText, ...]
    calls: Mapping[str, int]


def analyse(source: SourceFile) -> AnalysedProgram:
    """Return what can be counted in a text.

    Raises:
        ProgramError: it does not compile.
    """
    parsed = parse(source, _OPTIONS)
    handlers = []
    calls: dict[str, int] = {}
    for node in ast.walk(parsed.tree):
        if isinstance(node, ast.ExceptHandler):
            text = source.line(node.lineno).strip().rstrip(":").strip()
            handlers.append(HandlerText(node.lineno, text, tuple(inner.lineno for inner in node.body)))
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            calls[node.func.id] = min(node.lineno, calls.get(node.func.id, node.lineno))
    handlers.sort()
    # Compiling uses up the tree.
    unit = compile_parsed(parsed)
    return AnalysedProgram(source, unit.kind, unit.probes, tuple(handlers), calls)


def added(counts: Iterable[Sequence[int]]) -> list[int]:
    """Return the sums of the counters of several processes."""
    sums: list[int] = []
    for row in counts:
        if len(row) > len(sums):
            sums += [0] * (len(row) - len(sums))
        for index, count in enumerate(row):
            sums[index] += count
    return sums


def program_coverage(path: str, program: AnalysedProgram, counts: Sequence[int]) -> ProgramCoverage:
    """Return what was run of a program.

    Args:
        path: for reports, relative to the root folder, with `/`.
        program: the text.
        counts: of its counters, from the first one on; missing ones are 0.
    """
    table = program.table
    hits = [*counts[: table.size], *[0] * (table.size - len(counts))]

    def count(number: int) -> int:
        return hits[number - table.first] if number >= 0 else 0

    lines: dict[int, int] = {}
    line_of: dict[int, int] = {}
    for statement in table.statements:
        lines[statement.line] = max(lines.get(statement.line, 0), count(statement.number))
        line_of[statement.number] = statement.line
    handlers = []
    for line, text, body in program.handlers:
        # A clause was entered if its first statement that is counted ran.
        first = next((row for row in body if row in lines), None)
        if first is not None:
            handlers.append(Handler(line, text, lines[first]))
    branches = []
    for branch in table.branches:
        line = line_of[branch.statement]
        taken = count(branch.number) if count(branch.statement) else None
        branches.append(Branch(line, None if branch.line == line else branch.line, taken))
    source = program.source.lines
    return ProgramCoverage(
        path,
        tuple(source[:-1] if source and not source[-1] else source),
        lines,
        tuple(branches),
        tuple(Function(row.name, row.line, row.end_line, count(row.number)) for row in table.functions),
        tuple(handlers),
        program.source.places,
        tuple(map(program.source.file_line, range(1, len(source) + 1))) if program.source.places else (),
    )
