"""Adds small texts to lines: times of moves, units, names of arguments."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator
from enum import StrEnum
from math import degrees
from typing import Any, Final

from elitescript.assist.document import Document
from elitescript.assist.last_run import LastRun, LineTime
from elitescript.assist.own_names import NameFacts, OwnName, function_of
from elitescript.assist.units import number_text
from elitescript.language.scopes import Scope
from elitescript.lint.program import Span
from elitescript.records import record

_LONG_CALL: Final = 3
"""Fewest arguments without a keyword that get names."""
LABEL_MAX: Final = 43
"""Characters of a hint that VS Code shows; the rest is cut."""


class HintKind(StrEnum):
    """What a hint shows."""

    TIME = "time"
    """How long a move took in the last run."""
    UNIT = "unit"
    """Joint positions in degrees."""
    ARGUMENT = "argument"
    """Name of the parameter of an argument in a long call."""
    BLEND = "blend"
    """Radius that a blend was shortened to in the last run."""


@record
class InlayHint:
    """One hint; its place is in front of the character there.

    Attributes:
        line, column: where, from 1.
        kind: what it shows.
        label: the text.
        tooltip: Markdown; may be empty.
        pads_left: a blank in front of it.
        pads_right: a blank behind it.
    """

    line: int
    column: int
    kind: HintKind
    label: str
    tooltip: str = ""
    pads_left: bool = False
    pads_right: bool = False


def inlay_hints(
    document: Document,
    span: Span,
    last_run: LastRun | None = None,
    kinds: Collection[HintKind] = frozenset(HintKind),
) -> tuple[InlayHint, ...]:
    """Return the hints of a range, in the order of the text. Never raises.

    Args:
        document: the text.
        span: the lines that are shown; columns do not count.
        last_run: for times and blends; lines that were changed since have none.
        kinds: those that are wanted.
    """
    found: list[InlayHint] = []
    if HintKind.UNIT in kinds:
        found += _units(document, span)
    if HintKind.ARGUMENT in kinds:
        found += _arguments(document, span)
    if last_run is not None:
        if HintKind.TIME in kinds:
            found += _times(document, span, last_run)
        if HintKind.BLEND in kinds:
            found += _blends(document, span, last_run)
    return tuple(sorted(found, key=lambda hint: (hint.line, hint.column, hint.kind)))


# -------------------------------------------------------------------- units


def _units(document: Document, span: Span) -> Iterator[InlayHint]:
    program, symbols = document.program, document.symbols
    nodes: dict[ast.expr, None] = {}
    for arguments in program.arguments:
        for param, node in arguments.given:
            if param.quantity.meaning == "joints" and _is_shown(node, span):
                nodes[node] = None
    facts = document.once(NameFacts)
    kinds: dict[tuple[str, Scope | None], str] = {}
    for statement in program.nodes(ast.Assign):
        target = statement.targets[0]
        if isinstance(target, ast.Name) and isinstance(statement.value, ast.List) and _is_shown(statement.value, span):
            own = (target.id, symbols.scope_of(target).home(target.id))
            if own not in kinds:
                kinds[own] = facts.kind(OwnName(*own, (), 0))
            if kinds[own] == "joints":
                nodes[statement.value] = None
    for node in nodes:
        label = _degrees(node)
        if label:
            _, _, line, column = symbols.range_of(node)
            yield InlayHint(line, column, HintKind.UNIT, label, "joint positions in degrees", pads_left=True)


def _is_shown(node: ast.expr, span: Span) -> bool:
    return span.line <= node.lineno <= span.end_line


def _degrees(node: ast.expr) -> str:
    """Return six numbers that are written out, in degrees; empty for anything else, and for zeros."""
    if not isinstance(node, ast.List) or len(node.elts) != 6:
        return ""
    try:
        values: list[Any] = [ast.literal_eval(element) for element in node.elts]
    except (ValueError, TypeError):
        return ""
    if not all(type(value) in (int, float) for value in values) or not any(values):
        return ""
    labels = [
        ", ".join(number_text(round(degrees(value), digits)) for value in values) + " deg" for digits in (2, 1, 0)
    ]
    return next((label for label in labels if len(label) <= LABEL_MAX), labels[-1])


# -------------------------------------------------------------------- names of arguments


def _arguments(document: Document, span: Span) -> Iterator[InlayHint]:
    program, symbols = document.program, document.symbols
    for scope in symbols.scopes:
        for call in scope.calls:
            is_shown = span.line <= (call.end_lineno or call.lineno) and call.lineno <= span.end_line
            if not is_shown or not isinstance(call.func, ast.Name) or len(call.args) < _LONG_CALL:
                continue
            command = program.command(call.func.id, scope)
            if command is not None:
                names = [param.name for param in command.params]
            else:
                function = function_of(document, call.func.id, scope)
                names = [] if function is None else [a.arg for a in (*function.args.posonlyargs, *function.args.args)]
            for name, node in zip(names, call.args, strict=False):
                if isinstance(node, ast.Starred):
                    break
                if not (isinstance(node, ast.Name) and node.id == name):
                    line, column = symbols.place(node)
                    yield InlayHint(line, column, HintKind.ARGUMENT, f"{name}=")


# -------------------------------------------------------------------- the last run


def time_text(time: LineTime) -> str:
    """Return how long something took, `1.25 s`; of several times the number and the sum, `4 x, 5 s`."""
    total = f"{_rounded(time.total_s)} s"
    return total if time.times <= 1 else f"{time.times} x, {total}"


def _rounded(seconds: float) -> str:
    return f"{seconds:.3g}" if seconds < 100.0 else f"{seconds:.0f}"


def _times(document: Document, span: Span, last_run: LastRun) -> Iterator[InlayHint]:
    same = last_run.same_lines(document.source.lines)
    for line in range(max(span.line, 1), min(span.end_line, document.line_count) + 1):
        time = last_run.moves.get(same.earlier(line))
        if time is not None:
            tooltip = "time of the moves of this line in the last run"
            if time.times > 1:
                tooltip += f"; {_rounded(time.total_s / time.times)} s each on average"
            if last_run.duration_s:
                tooltip += f"; {100.0 * time.total_s / last_run.duration_s:.0f} % of the run"
            column = len(document.line(line)) + 1
            yield InlayHint(line, column, HintKind.TIME, time_text(time), tooltip, pads_left=True)


def _blends(document: Document, span: Span, last_run: LastRun) -> Iterator[InlayHint]:
    program = document.program
    same = last_run.same_lines(document.source.lines)
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        line = called.call.lineno
        blend = last_run.blends.get(same.earlier(line)) if span.line <= line <= span.end_line else None
        node = next((node for param, node in arguments.given if param.quantity.meaning == "blend radius"), None)
        if blend is not None and node is not None:
            _, _, line, column = document.symbols.range_of(node)
            label = f"-> {number_text(float(blend.used_m))} m"
            tooltip = f"{number_text(float(blend.asked_m))} m was shortened in the last run: at most half of a move"
            yield InlayHint(line, column, HintKind.BLEND, label, tooltip, pads_left=True)
