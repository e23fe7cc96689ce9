"""Whether six numbers are joint positions or a pose, by where they come from."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.symbols import Binding, Resolution, Scope, Symbols

_COPIES: Final = ("copy", "list")
_DEEPEST: Final = 20

_MOST_STORES: Final = 3
"""So many of six elements may be replaced before a list is taken for another one."""


class Kinds:
    """What commands return, followed through assignments and copies.

    A name has a kind only if every statement that binds it gives it that kind.
    """

    __slots__ = ("_known", "_symbols")

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols
        self._known: dict[Binding, str] = {}

    def kind(self, node: ast.expr, scope: Scope) -> str:
        """`joints`, `pose`, or nothing for what may be something else."""
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
        home = scope.home(name)
        bindings = home.bindings[name] if home else self._symbols.global_bindings(name)
        if not bindings or self._is_replaced(name, home):
            return ""
        kinds = {self._bound(binding, depth) for binding in bindings}
        return kinds.pop() if len(kinds) == 1 else ""

    def _bound(self, binding: Binding, depth: int) -> str:
        if binding not in self._known:
            # Whoever comes here again before there is a kind asks in a circle: `a = b; b = a`.
            self._known[binding] = ""
            statement = self._symbols.parent(binding.node)
            is_plain = isinstance(statement, ast.Assign) and binding.node in statement.targets
            if is_plain and isinstance(statement, ast.Assign):
                scope = self._symbols.scope_of(binding.node)
                self._known[binding] = self._kind(statement.value, scope, depth + 1)
        return self._known[binding]

    def _is_replaced(self, name: str, home: Scope | None) -> bool:
        """Return whether the elements of a list may have become those of another one."""
        stored = set()
        for scope in self._symbols.scopes:
            if home is None or scope.home(name) is home:
                for read in scope.reads.get(name, ()):
                    above = self._symbols.parent(read)
                    if isinstance(above, ast.Subscript) and above.value is read and not isinstance(above.ctx, ast.Load):
                        if not isinstance(above.slice, ast.Constant):
                            return True
                        stored.add(above.slice.value)
        return len(stored) > _MOST_STORES


def _is_whole(part: ast.expr) -> bool:
    return isinstance(part, ast.Slice) and part.lower is None and part.upper is None and part.step is None
