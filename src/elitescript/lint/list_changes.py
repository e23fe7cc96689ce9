"""Lists where a program changes lists: elements that are replaced, added and removed, by the variable of the list."""

from __future__ import annotations

import ast
from functools import cached_property
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple

CHANGING: Final = frozenset(("append", "clear", "extend", "insert", "pop", "remove", "reverse", "sort"))
"""Methods that change their list."""

Variable = tuple[str, Scope | None]
"""A name, and the scope whose variable it is; None for a global."""


class Change(NamedTuple):
    """A place that changes a list.

    Attributes:
        node: the element that is replaced, or the call of the method.
        list: the expression that is the list.
        is_relative: the new element is computed of what is there.
    """

    node: ast.expr
    list: ast.expr
    is_relative: bool


class ListChanges:
    """The places of one program that change lists.

    Args:
        program: the program.

    Attributes:
        all: in no particular order.
    """

    __slots__ = ("__dict__", "_by_variable", "_program", "all")

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self.all: list[Change] = []
        for node in program.nodes(ast.Subscript):
            if isinstance(node.ctx, ast.Store):
                self.all.append(Change(node, node.value, self._is_relative(node)))
        for call in program.nodes(ast.Call):
            if isinstance(call.func, ast.Attribute) and call.func.attr in CHANGING:
                self.all.append(Change(call, call.func.value, True))
        self._by_variable: dict[Variable, list[Change]] = {}
        for change in self.all:
            if isinstance(change.list, ast.Name):
                self._by_variable.setdefault(variable_of(program, change.list), []).append(change)
        for changes in self._by_variable.values():
            changes.sort(key=lambda change: change.node.lineno)

    def of(self, variable: Variable) -> list[Change]:
        """Return the places that change the list of a variable, in the order of the text."""
        return self._by_variable.get(variable, [])

    @cached_property
    def by_site(self) -> dict[frozenset[int], list[Change]]:
        """The places that change a list which one place of the text makes, by that, in the order of the text."""
        found: dict[frozenset[int], list[Change]] = {}
        for change in sorted(self.all, key=lambda change: change.node.lineno):
            sites = self._program.values.of(change.list).sites
            if len(sites) == 1 and -1 not in sites:
                found.setdefault(sites, []).append(change)
        return found

    def _is_relative(self, node: ast.Subscript) -> bool:
        above = self._program.symbols.parent(node)
        if isinstance(above, ast.AugAssign):
            return True
        return isinstance(above, ast.Assign) and any(isinstance(part, ast.Subscript) for part in ast.walk(above.value))


def variable_of(program: AnalysedProgram, node: ast.Name) -> Variable:
    """Return the variable that a name stands for."""
    return node.id, program.symbols.scope_of(node).home(node.id)
