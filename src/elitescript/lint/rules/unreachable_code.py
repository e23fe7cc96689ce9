"""Code that is never reached, because the line above always leaves.

Behind `return`, `raise`, `break`, `continue` and `halt()` nothing of the same block runs, nor behind an `if`
of which every branch leaves. Lines without an effect (`pass`, a line mark, one more `return`, the `sync()` that
generators put at the end of each loop) do not count.

    def job():
      return
      movej(HOME)                # W207
    end
"""

from __future__ import annotations

import ast
from bisect import bisect_right
from collections.abc import Iterator
from math import inf
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.hooks import LINE
from elitescript.language.nodes import BLOCKS
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W207", since="0.1", needs_all_lines=True)
def unreachable_code(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first such statement of each block."""
    # Ranges of lines, in order; those that are nested are not reported.
    reported: list[tuple[int, float]] = []
    blocks = sorted(_blocks(program), key=lambda block: block[0].lineno)
    for block in blocks:
        for index, statement in enumerate(block):
            if not _leaves(statement, program):
                continue
            rest = block[index + 1 :]
            if program.source.tree is not None:
                # What ends the block of a node was generated; the next node begins with its mark.
                rest = rest[next((at for at, other in enumerate(rest) if _is_mark(other)), len(rest)) :]
            first = next((other for other in rest if not _is_filler(other)), None)
            if first is None or _makes_generator(rest):
                break
            place = bisect_right(reported, (first.lineno, inf))
            if not place or reported[place - 1][1] < first.lineno:
                reported.insert(place, (first.lineno, rest[-1].end_lineno or rest[-1].lineno))
                what = _WORDS.get(type(statement), "the lines above")
                text = said(
                    "this is never reached: {what} in line {line} always leaves", what=what, line=statement.lineno
                )
                yield Finding(program.header_span(first), text, "remove it, or put it before that line")
            break


_WORDS: Final[dict[type[ast.stmt], str]] = {
    ast.Return: "the `return`",
    ast.Raise: "the `raise`",
    ast.Break: "the `break`",
    ast.Continue: "the `continue`",
    ast.If: "every branch of the `if`",
    ast.Expr: "the call",
}
_BLOCK_OWNERS: Final = (
    ast.Module,
    ast.FunctionDef,
    ast.ClassDef,
    ast.If,
    ast.For,
    ast.While,
    ast.With,
    ast.Try,
    ast.ExceptHandler,
    ast.match_case,
)
_FILLERS: Final = (LINE, "labelmsg", "sync")
_LONGEST_CHAIN: Final = 60
"""Branches of an `elif` chain that are followed."""

_LEAVING: Final = frozenset(("exit", "halt", "quit"))


def _blocks(program: AnalysedProgram) -> Iterator[list[ast.stmt]]:
    for kind in _BLOCK_OWNERS:
        for owner in program.nodes(kind):
            for field in BLOCKS:
                block = getattr(owner, field, None)
                if block:
                    yield block


def _leaves(statement: ast.stmt, program: AnalysedProgram, depth: int = 0) -> bool:
    """Return whether the statement behind can never be reached from this one."""
    if isinstance(statement, (ast.Return, ast.Raise, ast.Break, ast.Continue)):
        return True
    if isinstance(statement, ast.If):
        branches = (statement.body, statement.orelse)
        return depth < _LONGEST_CHAIN and all(
            any(_leaves(inner, program, depth + 1) for inner in branch) for branch in branches
        )
    call = statement.value if isinstance(statement, ast.Expr) else None
    if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name) or call.func.id not in _LEAVING:
        return False
    if program.symbols.scope_of(call).resolve(call.func.id) is not Resolution.BUILTIN:
        return False
    command = CATALOGUE.get(call.func.id)
    return command is None or program.is_available(command)


def _is_mark(statement: ast.stmt) -> bool:
    value = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == LINE


def _is_filler(statement: ast.stmt) -> bool:
    if isinstance(statement, (ast.Pass, ast.Global, ast.Nonlocal, ast.Break, ast.Continue)):
        return True
    if isinstance(statement, ast.Return):
        return statement.value is None
    value = statement.value if isinstance(statement, ast.Expr) else None
    if isinstance(value, ast.Call) and isinstance(value.func, ast.Name):
        return value.func.id in _FILLERS
    return isinstance(value, ast.Constant)


def _makes_generator(statements: list[ast.stmt]) -> bool:
    """Return whether a `yield` is among them: behind a `return` it makes a generator without elements."""
    return any(isinstance(node, (ast.Yield, ast.YieldFrom)) for top in statements for node in ast.walk(top))
