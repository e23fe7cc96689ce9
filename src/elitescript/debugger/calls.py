"""Which commands each statement of a text calls by name."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Final

from elitescript.language.parser import parse
from elitescript.language.probes import CountedStatement
from elitescript.language.text.source import SourceFile

_BODIES: Final = ("body", "orelse", "finalbody", "handlers", "cases")


def calls_by_statement(name: str, text: str, statements: Sequence[CountedStatement]) -> dict[str, frozenset[int]]:
    """Return for each name the numbers of the statements that call it, apart from those inside of them.

    Args:
        name: of the text.
        text: the program.
        statements: the counted ones.
    """
    numbers = {(row.line, row.column): row.number for row in statements}
    parsed = parse(SourceFile(name, text))
    found: dict[str, set[int]] = {}
    for statement in ast.walk(parsed.tree):
        if not isinstance(statement, ast.stmt):
            continue
        column = len(parsed.source.line(statement.lineno).encode()[: statement.col_offset].decode()) + 1
        number = numbers.get((statement.lineno, column))
        for called in _called(statement) if number is not None else ():
            found.setdefault(called, set()).add(number)  # type: ignore[arg-type]
    return {called: frozenset(places) for called, places in found.items()}


def _called(statement: ast.stmt) -> set[str]:
    """Return the names that a statement itself calls."""
    stack: list[ast.AST] = [
        child
        for field, value in ast.iter_fields(statement)
        if field not in _BODIES
        for child in (value if isinstance(value, list) else [value])
        if isinstance(child, ast.AST)
    ]
    found = set()
    while stack:
        node = stack.pop()
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            found.add(node.func.id)
        stack += ast.iter_child_nodes(node)
    return found
