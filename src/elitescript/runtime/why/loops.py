"""Finds the loop in which a frame is, and the conditions that decide whether it goes on."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.records import NamedTuple

EXITS_MAX: Final = 3
"""Most ways out of an endless loop that are said."""
_ENDING: Final = frozenset(("halt",))
"""Commands that leave every loop."""


class Exit(NamedTuple):
    """A way out of a loop."""

    line: int
    condition: ast.expr


def scope_at(symbols: Symbols, line: int) -> Scope:
    """Return the innermost function around a line, or the program."""
    found = symbols.body
    for scope in symbols.scopes:
        node = scope.node
        if scope.kind == "function" and _holds(node, line) and getattr(node, "lineno", 0) >= _line_of(found.node):
            found = scope
    return found


def loops_at(symbols: Symbols, line: int) -> list[ast.While | ast.For]:
    """Return the loops around a line in the function of that line, the innermost one first."""
    home = scope_at(symbols, line)
    found: list[ast.While | ast.For] = []
    stack: list[ast.AST] = list(home.statements)
    while stack:
        node = stack.pop()
        if isinstance(node, ast.FunctionDef | ast.ClassDef | ast.Lambda) or not isinstance(
            node, ast.stmt | ast.ExceptHandler | ast.match_case
        ):
            continue
        if isinstance(node, ast.While | ast.For) and _holds(node, line):
            found.append(node)
        stack += ast.iter_child_nodes(node)
    return sorted(found, key=lambda loop: (loop.lineno, loop.col_offset), reverse=True)


def exits(loop: ast.While | ast.For) -> list[Exit]:
    """Return the ways out of an endless loop: what leads to a `break` of it, to a `return` or to `halt()`."""
    return list(_exits(loop.body, (), is_inner=False))


def _exits(body: list[ast.stmt], before: tuple[ast.expr, ...], *, is_inner: bool) -> Iterator[Exit]:
    for statement in body:
        if before and _leaves(statement, is_inner=is_inner):
            yield Exit(statement.lineno, _all_of(before))
        elif isinstance(statement, ast.If):
            tests = (*before, statement.test)
            if statement.body and isinstance(statement.body[-1], ast.Continue) and not statement.orelse:
                # What follows is reached where the condition is false.
                before = (*before, _negated(statement.test))
            elif any(_leaves(inner, is_inner=is_inner) for inner in statement.body):
                yield Exit(statement.lineno, _all_of(tests))
            else:
                yield from _exits(statement.body, tests, is_inner=is_inner)
            if any(_leaves(inner, is_inner=is_inner) for inner in statement.orelse):
                yield Exit(statement.lineno, _negated(statement.test))
            else:
                yield from _exits(statement.orelse, before, is_inner=is_inner)
        elif isinstance(statement, ast.Try):
            for part in (statement.body, statement.orelse, *(handler.body for handler in statement.handlers)):
                yield from _exits(part, before, is_inner=is_inner)
        elif isinstance(statement, ast.With):
            yield from _exits(statement.body, before, is_inner=is_inner)
        elif isinstance(statement, ast.While | ast.For):
            yield from _exits(statement.body, before, is_inner=True)


def _negated(test: ast.expr) -> ast.expr:
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return test.operand
    return ast.UnaryOp(ast.Not(), test)


def _all_of(tests: tuple[ast.expr, ...]) -> ast.expr:
    return tests[0] if len(tests) == 1 else ast.BoolOp(ast.And(), list(tests))


def _leaves(statement: ast.stmt, *, is_inner: bool) -> bool:
    if isinstance(statement, ast.Break):
        return not is_inner
    if isinstance(statement, ast.Return | ast.Raise):
        return True
    call = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in _ENDING


def _holds(node: ast.AST, line: int) -> bool:
    return _line_of(node) <= line <= (getattr(node, "end_lineno", None) or _line_of(node))


def _line_of(node: ast.AST | None) -> int:
    return getattr(node, "lineno", 0)
