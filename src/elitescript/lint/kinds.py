"""Determines whether six numbers are joint positions or a pose, by their origin."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.symbols import Binding, Resolution, Scope, Symbols

_COPIES: Final = ("copy", "list")
_DEEPEST: Final = 20

_MOST_STORES: Final = 3
"""Number of elements, of six, that may be replaced before a list counts as another one."""


class Kinds:
    """Follows what commands return through assignments and copies.

    A name has a kind only if every statement that binds it gives it that kind.
    """

    __slots__ = ("_known", "_symbols")

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols
        self._known: dict[Binding, str] = {}

    def kind(self, node: ast.expr, scope: Scope) -> str:
        """Return `joints` or `pose`; empty if it may be something else."""
        return self._kind(node, scope, 0)

    def _kind(self, node: ast.expr, scope: Scope, depth: int) -> str:
        if depth > _DEEPEST:
            return ""
        if isinstance(node, ast.Name):
            return self._named(node.id, scope, depth)
        if isinstance(node, ast.Subscript) and _is_whole(node.slice):
            return self._kind(node.value, scope, depth + 1)
        if not isinstance(node, ast.Call):
            return ""
        function = node.func
        if isinstance(function, ast.Attribute):
            is_copy = function.attr == "copy" and not node.args
            return self._kind(function.value, scope, depth + 1) if is_copy else ""
        if not isinstance(function, ast.Name) or scope.resolve(function.id) is not Resolution.BUILTIN:
            return ""
        if function.id in _COPIES and len(node.args) == 1 and not node.keywords:
            return self._kind(node.args[0], scope, depth + 1)
        command = CATALOGUE.get(function.id)
        return "" if command is None else command.details.kind

    def _named(self, name: str, scope: Scope, depth: int) -> str:
        bindings = self._symbols.bindings(name, scope)
        if not bindings or self._is_replaced(name, scope.home(name)):
            return ""
        kinds = {self._bound(binding, depth) for binding in bindings}
        return kinds.pop() if len(kinds) == 1 else ""

    def _bound(self, binding: Binding, depth: int) -> str:
        if binding not in self._known:
            # Read again before there is a kind, it is a circle: `a = b; b = a`.
            self._known[binding] = ""
            statement = self._symbols.parent(binding.node)
            if isinstance(statement, ast.Assign) and binding.node in statement.targets:
                scope = self._symbols.scope_of(binding.node)
                self._known[binding] = self._kind(statement.value, scope, depth + 1)
        return self._known[binding]

    def _is_replaced(self, name: str, home: Scope | None) -> bool:
        """Return whether the elements of a list may have become those of another one."""
        stored = set()
        for read in self._symbols.reads_of(name, home):
            above = self._symbols.parent(read)
            if isinstance(above, ast.Subscript) and above.value is read and not isinstance(above.ctx, ast.Load):
                if not isinstance(above.slice, ast.Constant):
                    return True
                stored.add(above.slice.value)
        return len(stored) > _MOST_STORES


def _is_whole(part: ast.expr) -> bool:
    return isinstance(part, ast.Slice) and part.lower is None and part.upper is None and part.step is None
