"""Adds lines above programs and functions: Run, Debug, Show path; calls and their share of the time."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun
from elitescript.language.scopes import Scope
from elitescript.lint.program import Span
from elitescript.records import record

RUN: Final = "elitescript.run"
DEBUG: Final = "elitescript.debug"
SHOW_PATH: Final = "elitescript.showPath"


@record
class CodeLens:
    """One entry.

    Attributes:
        span: the line that it stands above.
        title: the text.
        command: what a click does, one of the names above, with the document as argument; empty for a text only.
    """

    span: Span
    title: str
    command: str = ""


def code_lenses(document: Document, last_run: LastRun | None = None) -> tuple[CodeLens, ...]:
    """Return the entries of a text, in its order. Never raises."""
    found = [*_of_program(document), *_of_functions(document, last_run)]
    return tuple(sorted(found, key=lambda lens: lens.span))


def _of_program(document: Document) -> Iterator[CodeLens]:
    lines = document.translation.lines
    if not lines:
        return
    unit = document.parsed.unit
    span = _row(document, unit.lineno if unit is not None else lines[0].line)
    yield CodeLens(span, "Run", RUN)
    yield CodeLens(span, "Debug", DEBUG)
    yield CodeLens(span, "Show path", SHOW_PATH)


def _of_functions(document: Document, last_run: LastRun | None) -> Iterator[CodeLens]:
    for scope in document.symbols.scopes:
        node = scope.node
        if scope.kind == "function" and isinstance(node, ast.FunctionDef) and scope.parent is not None:
            parts = [_used(document, scope)]
            if last_run is not None:
                parts.append(_share(document, scope, last_run))
            yield CodeLens(_row(document, node.lineno), "; ".join(part for part in parts if part))


def _used(document: Document, function: Scope) -> str:
    """Return how often the text names a function."""
    outer = function.parent
    if outer is None or outer.kind == "class":
        return ""
    name = function.name
    count = len(document.symbols.reads_of(name, outer.home(name)))
    return "not used" if not count else f"used {'once' if count == 1 else f'{count} times'}"


def _share(document: Document, function: Scope, last_run: LastRun) -> str:
    """Return how often a function was called in the last run, and the share of the time spent in its lines."""
    same = last_run.same_lines(document.source.lines)
    first = function.statements[0].lineno if function.statements else 0
    inner = [child.node for child in function.children if child.kind == "function"]
    taken_s = 0.0
    node = function.node
    assert isinstance(node, ast.FunctionDef)
    for line in range(node.lineno + 1, (node.end_lineno or node.lineno) + 1):
        is_inner = any(
            isinstance(other, ast.FunctionDef) and other.lineno <= line <= (other.end_lineno or 0) for other in inner
        )
        time = None if is_inner else last_run.lines.get(same.earlier(line))
        taken_s += 0.0 if time is None else time.total_s
    calls = last_run.lines.get(same.earlier(first))
    parts = [f"{calls.times} calls" if calls.times > 1 else "1 call"] if calls is not None and calls.times else []
    if last_run.duration_s and taken_s:
        parts.append(f"{100.0 * taken_s / last_run.duration_s:.0f} % of the time")
    return ", ".join(parts)


def _row(document: Document, line: int) -> Span:
    row = document.line(line)
    return Span(line, len(row) - len(row.lstrip()) + 1, line, len(row.rstrip()) + 1)
