"""Scopes: the regions of a program that have variables of their own.

The outermost scope is the body of the program; what Python calls global are here only the names
that a `global` statement declares. What no scope binds comes from outside: robot commands,
Python's built-ins, or nothing (`Resolution.BUILTIN`).
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from enum import StrEnum

from elitescript.records import record


class Resolution(StrEnum):
    """What a name refers to in a scope."""

    LOCAL = "local"
    CELL = "cell"
    """A variable of a function, or of the program's body, around this one."""
    GLOBAL = "global"
    BUILTIN = "builtin"
    """Bound nowhere in the text."""


@record
class Binding:
    """A place that gives a name a value.

    Attributes:
        name: the name.
        node: the node that binds it: a `Name`, a definition, an import alias, a handler, a pattern.
        kind: `assign`, `augmented`, `annotated`, `walrus`, `for`, `with`, `except`, `import`, `def`,
            `class`, `parameter`, `match` or `delete`.
        line, column: where, both from 1, in characters.
    """

    name: str
    node: ast.AST
    kind: str
    line: int
    column: int


class Scope:
    """A region with variables of its own: the program, a function, lambda, comprehension or class.

    Attributes:
        kind: `body`, `function`, `lambda`, `comprehension` or `class`.
        name: name of the function or class; empty for others.
        node: the node that makes it; the module for the body of a script.
        parent: the scope around it; None for the body.
        children: the scopes directly inside it, in the order of the text.
        statements: its statements; empty for a lambda or comprehension.
        parameters: its parameters, in order.
        bindings: every binding of a name here, by name; also of names declared global.
        reads: every use of a name's value here, by name.
        globals: the `global` statements that declare a name here, by name.
        nonlocals: the same for `nonlocal`.
        calls: the calls made here, in the order of the text.
    """

    __slots__ = (
        "_global_names",
        "bindings",
        "calls",
        "children",
        "globals",
        "kind",
        "name",
        "node",
        "nonlocals",
        "parameters",
        "parent",
        "reads",
        "statements",
    )

    def __init__(self, global_names: set[str], kind: str, name: str, node: ast.AST, parent: Scope | None) -> None:
        self._global_names = global_names
        self.kind = kind
        self.name = name
        self.node = node
        self.parent = parent
        self.children: list[Scope] = []
        self.parameters: dict[str, ast.arg] = {}
        self.bindings: dict[str, list[Binding]] = {}
        self.reads: dict[str, list[ast.Name]] = {}
        self.globals: dict[str, list[ast.Global]] = {}
        self.nonlocals: dict[str, list[ast.Nonlocal]] = {}
        self.calls: list[ast.Call] = []
        body = getattr(node, "body", None)
        self.statements: list[ast.stmt] = body if isinstance(body, list) else []
        if parent is not None:
            parent.children.append(self)

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name}>" if self.name else f"<{self.kind}>"

    def has_local(self, name: str) -> bool:
        return name in self.bindings and name not in self.globals and name not in self.nonlocals

    def resolve(self, name: str) -> Resolution:
        """Return what `name` refers to when it is used here."""
        if name in self.globals:
            return Resolution.GLOBAL
        home = self.home(name)
        if home is self:
            return Resolution.LOCAL
        if home is not None or name in self.nonlocals:
            return Resolution.CELL
        return Resolution.GLOBAL if name in self._global_names else Resolution.BUILTIN

    def home(self, name: str) -> Scope | None:
        """Return the scope whose variable `name` is when it is used here; None if global or built in."""
        if self.has_local(name):
            return self
        if name in self.globals:
            return None
        scope = self.parent
        while scope is not None:
            if scope.kind != "class":
                if name in scope.globals:
                    return None
                if scope.has_local(name):
                    return scope
            scope = scope.parent
        return None

    def walk(self) -> Iterator[Scope]:
        """Yield this scope and all inside it, outer ones first."""
        stack = [self]
        while stack:
            scope = stack.pop()
            yield scope
            stack.extend(reversed(scope.children))
