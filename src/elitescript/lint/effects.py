"""Determines which expressions have no effect besides their value."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.language.builtin_names import PURE_BUILTINS
from elitescript.language.nodes import children
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram

_PURE_METHODS: Final = frozenset(
    """
    capitalize center copy count decode encode endswith find format get index isalnum isalpha isdigit islower isspace
    isupper items join keys ljust lower lstrip partition replace rfind rindex rjust rpartition rsplit rstrip split
    splitlines startswith strip swapcase title upper values zfill
    """.split()  # noqa: SIM905
)
"""Methods of texts, lists and dicts that only give a value."""


def _is_pure_call(call: ast.Call, program: AnalysedProgram) -> bool:
    """Return whether a call only gives a value, whatever its arguments do: a reading command, `math.sin`, `len`."""
    function = call.func
    if isinstance(function, ast.Attribute):
        base = function.value
        if function.attr in _PURE_METHODS:
            # Imported late: short programs do without values.
            from elitescript.values.description import BYTES, DICT, LIST, TEXT, TUPLE

            kinds = program.values.of(base).kinds
            if kinds and not kinds & ~(TEXT | BYTES | LIST | TUPLE | DICT):
                return True
        scope = program.symbols.scope_of(call)
        return isinstance(base, ast.Name) and program.symbols.imported(base.id, scope) == "math"
    if not isinstance(function, ast.Name):
        return False
    scope = program.symbols.scope_of(function)
    command = program.command(function.id, scope)
    if command is not None:
        return command.only_gives_a_value
    return function.id in PURE_BUILTINS and scope.resolve(function.id) is Resolution.BUILTIN


def has_effect(root: ast.expr, program: AnalysedProgram) -> bool:
    """Return whether evaluating an expression may do anything besides giving its value."""
    stack: list[ast.AST] = [root]
    while stack:
        node = stack.pop()
        if isinstance(node, (ast.Yield, ast.YieldFrom, ast.Await, ast.NamedExpr)):
            return True
        if isinstance(node, ast.Call) and not _is_pure_call(node, program):
            return True
        if not isinstance(node, ast.Lambda):
            stack += children(node)
    return False
