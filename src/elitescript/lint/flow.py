"""Determines whether the end of a block can be reached."""

from __future__ import annotations

import ast
from functools import cached_property
from typing import Final

from elitescript.language.nodes import children
from elitescript.language.symbols import Resolution, Scope
from elitescript.lint.program import AnalysedProgram

_LEAVING: Final = frozenset(("exit", "halt", "quit"))
_DEEPEST: Final = 60
"""Deepest nesting of blocks that is followed."""


class Flow:
    """Follows the blocks of one program, and the functions that they call."""

    __slots__ = ("__dict__", "_program", "_returns")

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self._returns: dict[Scope, bool] = {}

    def reaches_end(self, block: list[ast.stmt], depth: int = 0) -> bool:
        """Return whether what stands behind a block may be run after it; True where that is uncertain."""
        return depth > _DEEPEST or all(self._passes(statement, depth + 1) for statement in block)

    def _passes(self, node: ast.stmt, depth: int) -> bool:
        if isinstance(node, (ast.Return, ast.Raise, ast.Break, ast.Continue)):
            return False
        if isinstance(node, ast.If):
            return self.reaches_end(node.body, depth) or self.reaches_end(node.orelse, depth)
        if isinstance(node, ast.While):
            if isinstance(node.test, ast.Constant) and node.test.value:
                return _has_break(node.body)
            return _has_break(node.body) or self.reaches_end(node.orelse, depth)
        if isinstance(node, ast.For):
            return _has_break(node.body) or self.reaches_end(node.orelse, depth)
        if isinstance(node, ast.Try):
            return self._try_passes(node, depth)
        if isinstance(node, ast.With):
            return self.reaches_end(node.body, depth)
        if isinstance(node, ast.Match):
            return not any(takes_all(case) for case in node.cases) or any(
                self.reaches_end(case.body, depth) for case in node.cases
            )
        if isinstance(node, ast.Assert):
            return not isinstance(node.test, ast.Constant) or bool(node.test.value)
        return not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and self.never_returns(node.value))

    def _try_passes(self, node: ast.Try, depth: int) -> bool:
        if not self.reaches_end(node.finalbody, depth):
            return False
        if self.reaches_end([*node.body, *node.orelse], depth):
            return True
        return any(self.reaches_end(handler.body, depth) for handler in node.handlers)

    def never_returns(self, call: ast.Call) -> bool:
        """Return whether a call ends the program: `halt()`, or a function that always comes to it."""
        if not isinstance(call.func, ast.Name):
            return False
        name = call.func.id
        scope = self._program.symbols.scope_of(call)
        if scope.resolve(name) is Resolution.BUILTIN:
            # Where the firmware lacks `halt`, the call raises an error: it does not return either.
            return name in _LEAVING
        targets = self._program.symbols.definitions(name, scope)
        return bool(targets) and not any(self._may_return(target) for target in targets)

    def _may_return(self, scope: Scope) -> bool:
        if scope not in self._returns:
            # A function that calls itself is taken to return.
            self._returns[scope] = True
            node = scope.node
            if isinstance(node, ast.FunctionDef) and not node.decorator_list and not self.returns_of(scope):
                self._returns[scope] = self.is_generator(scope) or self.reaches_end(node.body)
        return self._returns[scope]

    def returns_of(self, scope: Scope) -> list[ast.Return]:
        """Return the `return` statements of a function itself, in no particular order."""
        return self._returns_of.get(scope, [])

    @cached_property
    def _returns_of(self) -> dict[Scope, list[ast.Return]]:
        found: dict[Scope, list[ast.Return]] = {}
        for node in self._program.nodes(ast.Return):
            found.setdefault(self._program.symbols.scope_of(node), []).append(node)
        return found

    def is_generator(self, scope: Scope) -> bool:
        """Return whether a function has a `yield` of its own."""
        return scope in self._generators

    @cached_property
    def _generators(self) -> frozenset[Scope]:
        kinds: tuple[type[ast.expr], ...] = (ast.Yield, ast.YieldFrom)
        return frozenset(self._program.symbols.scope_of(node) for kind in kinds for node in self._program.nodes(kind))


def _has_break(body: list[ast.stmt]) -> bool:
    """Return whether a loop may be left by a `break` of its own."""
    stack: list[ast.AST] = list(body)
    while stack:
        node = stack.pop()
        if isinstance(node, ast.Break):
            return True
        if isinstance(node, (ast.For, ast.While)):
            stack.extend(node.orelse)
        elif not isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.expr)):
            stack.extend(children(node))
    return False


def takes_all(case: ast.match_case) -> bool:
    """Return whether a case of a `match` takes every value."""
    return case.guard is None and isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None
