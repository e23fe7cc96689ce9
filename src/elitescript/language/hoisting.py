"""Moves `global` statements that come after a use of their name to the top of their function.

Python refuses them. Older controllers accepted them, and some program generators write them in
every program, so they only give a warning.
"""

from __future__ import annotations

import ast
from itertools import islice

from elitescript.language.checkpoints import body_start, is_checkpoint
from elitescript.language.diagnostics import Diagnostic, Edit, Fix, Severity, diagnostic
from elitescript.language.nodes import BLOCKS
from elitescript.language.parser import Parsed
from elitescript.language.symbols import LateGlobal, Symbols
from elitescript.said import said


def hoist_late_globals(parsed: Parsed) -> list[Diagnostic]:
    """Move late `global` statements in the tree of `parsed`; return one E109 for each late name."""
    symbols = Symbols(parsed)
    late = symbols.late_globals()
    severity = Severity.ERROR if parsed.options.strict else Severity.WARNING
    problems = [_finding(item, symbols, severity) for item in late]
    moving = {item.statement: item.scope for item in late}
    for statement in moving:
        _, block, place = symbols.block_of(statement)
        block[place] = ast.copy_location(ast.Pass(), statement)
    for statement, scope in moving.items():
        body = scope.statements
        moved = ast.copy_location(ast.Global(statement.names), body[0])
        body.insert(body_start(body), moved)
    return problems


def _finding(item: LateGlobal, symbols: Symbols, severity: Severity) -> Diagnostic:
    source = symbols.parsed.source
    line, column, end_line, end_column = symbols.range_of(item.statement)
    row = source.line(line)
    at = row.find(item.name, column + len("global"))
    start = at + 1 if at >= 0 and end_line == line else column
    return diagnostic(
        "E109",
        line,
        start,
        said(
            "`global {name}` comes after `{name}` was used in line {used_line}; a Python 3 controller refuses it",
            name=item.name,
            used_line=item.used_line,
        ),
        end_column=start + len(item.name) if at >= 0 else end_column,
        hint="move it to the top of the function",
        fix=_fix(item, symbols),
        severity=severity,
    )


def _fix(item: LateGlobal, symbols: Symbols) -> Fix | None:
    source = symbols.parsed.source
    line, column, end_line, end_column = symbols.range_of(item.statement)
    own = list(islice((statement for statement in item.scope.statements if not is_checkpoint(statement)), 2))
    first = own[min(body_start(own), len(own) - 1)]
    first_line, first_column = symbols.place(first)
    if end_line != line or first_line == line:
        return None
    declaration = source.line(line)[column - 1 : end_column - 1]
    before = source.line(first_line)[: first_column - 1]
    separator = "; " if before.strip() else f"\n{before}"
    parent = symbols.parent(item.statement)
    alone = source.line(line).strip(" \t;") == declaration
    siblings = max(len(getattr(parent, field, ())) for field in BLOCKS)
    if alone and siblings > 1:
        removal = Edit(line, 1, line + 1, 1, "")
    else:
        removal = Edit(line, column, end_line, end_column, "pass")
    insertion = Edit(first_line, first_column, first_line, first_column, declaration + separator)
    return Fix("move it to the top", (insertion, removal), safe=True)
