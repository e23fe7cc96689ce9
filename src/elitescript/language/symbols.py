"""Finds scopes, names and calls of a program, for tools."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from operator import attrgetter
from typing import Any, Final

from elitescript.language.nodes import BLOCKS, children
from elitescript.language.parser import Parsed, character_offset
from elitescript.language.scopes import Binding, Resolution, Scope
from elitescript.records import record

__all__ = ["Binding", "LateGlobal", "Resolution", "Scope", "Symbols"]

THREAD_STARTER: Final = "start_thread"

_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


@record
class LateGlobal:
    """Describes a `global` statement behind a use of one of its names in the same function.

    Attributes:
        name: the name.
        statement: the statement.
        scope: the function.
        used_line: line of the first use.
    """

    name: str
    statement: ast.Global
    scope: Scope
    used_line: int


class Symbols:
    """Analyses one text.

    Attributes:
        parsed: the text.
        body: the outermost scope.
        scopes: all scopes, outer ones first.
        global_names: names that a `global` statement declares, anywhere.
    """

    def __init__(self, parsed: Parsed) -> None:
        self.parsed = parsed
        self._declared: set[str] = set()
        self._parents: dict[ast.AST, ast.AST] = {}
        self._scope_of: dict[ast.AST, Scope] = {}
        self._global_bindings: dict[str, list[Binding]] = {}
        root: ast.AST = parsed.unit or parsed.tree
        self.body = Scope(self._declared, "body", parsed.name, root, None)
        _Walk(self).run()
        for scope in tuple(self.body.walk()):
            scope.calls.sort(key=_place)
            scope.children.sort(key=lambda child: _position(child.node))
            for bindings in scope.bindings.values():
                bindings.sort(key=lambda binding: (binding.line, binding.column))
            for reads in scope.reads.values():
                reads.sort(key=_place)
        self.scopes = tuple(self.body.walk())
        self.global_names = frozenset(self._declared)
        self._made_by = {scope.node: scope for scope in self.scopes}

    # Places

    def place(self, node: ast.AST) -> tuple[int, int]:
        """Return (line, column) where a node starts, from 1, in characters."""
        line = getattr(node, "lineno", 1)
        return line, character_offset(self.parsed.source.line(line), getattr(node, "col_offset", 0)) + 1

    def range_of(self, node: ast.AST) -> tuple[int, int, int, int]:
        """Return (line, column, end line, end column) of a node, from 1, in characters, the end exclusive."""
        line, column = self.place(node)
        end_line = getattr(node, "end_lineno", None) or line
        end = getattr(node, "end_col_offset", None) or 0
        return line, column, end_line, character_offset(self.parsed.source.line(end_line), end) + 1

    # Relations

    def parent(self, node: ast.AST) -> ast.AST | None:
        """Return the node directly around a node; None for the root."""
        return self._parents.get(node)

    def ancestors(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the nodes around a node, from inside out."""
        above = self._parents.get(node)
        while above is not None:
            yield above
            above = self._parents.get(above)

    def scope_of(self, node: ast.AST) -> Scope:
        """Return the scope in which a node is evaluated; for a definition, the scope around it."""
        return self._scope_of.get(node, self.body)

    def scope_made_by(self, node: ast.AST) -> Scope | None:
        """Return the scope that a definition, lambda or comprehension makes."""
        return self._made_by.get(node)

    # Names

    def definitions(self, name: str, scope: Scope) -> tuple[Scope, ...]:
        """Return scopes of the functions that `name` may stand for when it is used in `scope`."""
        home = scope.home(name)
        places = (home,) if home else self.declaring(name)
        nodes = [binding.node for place in places for binding in place.bindings.get(name, ()) if binding.kind == "def"]
        return tuple(made for node in nodes if (made := self.scope_made_by(node)) is not None)

    def bindings(self, name: str, scope: Scope) -> list[Binding]:
        """Return the places that give a value to the variable that `name` is in `scope`."""
        home = scope.home(name)
        return home.bindings[name] if home else self.global_bindings(name)

    def reads_of(self, name: str, home: Scope | None) -> list[ast.Name]:
        """Return all uses of the value of a variable of a scope; of a global of the program, or built in, for None."""
        return self._reads.get((name, home), [])

    @cached_property
    def _reads(self) -> dict[tuple[str, Scope | None], list[ast.Name]]:
        found: dict[tuple[str, Scope | None], list[ast.Name]] = {}
        for scope in self.scopes:
            for name, reads in scope.reads.items():
                found.setdefault((name, scope.home(name)), []).extend(reads)
        return found

    def declaring(self, name: str) -> Sequence[Scope]:
        """Return the scopes that declare a name global."""
        return self._declaring.get(name, ())

    @cached_property
    def _declaring(self) -> dict[str, list[Scope]]:
        found: dict[str, list[Scope]] = {}
        for scope in self.scopes:
            for name in scope.globals:
                found.setdefault(name, []).append(scope)
        return found

    def owners(self, name: str) -> Sequence[Scope]:
        """Return the scopes that have a variable of this name for themselves."""
        return self._owners.get(name, ())

    @cached_property
    def _owners(self) -> dict[str, list[Scope]]:
        found: dict[str, list[Scope]] = {}
        for scope in self.scopes:
            for name in scope.bindings:
                if scope.has_local(name):
                    found.setdefault(name, []).append(scope)
        return found

    def block_of(self, statement: ast.AST) -> tuple[str, list[ast.stmt], int]:
        """Return the block that a statement is part of: its field of the node around it, its statements, the place.

        The field is empty for what is no statement, and for the node of the body.
        """
        return self._blocks.get(statement, ("", [], 0))

    @cached_property
    def _blocks(self) -> dict[ast.AST, tuple[str, list[ast.stmt], int]]:
        found: dict[ast.AST, tuple[str, list[ast.stmt], int]] = {}
        for node, above in self._parents.items():
            if not isinstance(node, ast.stmt) or node in found:
                continue
            for field in BLOCKS:
                block = getattr(above, field, None)
                if type(block) is list:
                    for place, statement in enumerate(block):
                        found[statement] = (field, block, place)
        return found

    @cached_property
    def _nonlocal_names(self) -> frozenset[str]:
        return frozenset(name for scope in self.scopes for name in scope.nonlocals)

    def is_nonlocal_inside(self, name: str, scope: Scope) -> bool:
        """Return whether a `nonlocal` statement in a scope, or inside it, names a variable."""
        return name in self._nonlocal_names and any(name in other.nonlocals for other in scope.walk())

    def imported(self, name: str, scope: Scope) -> str:
        """Return what an `import` lets `name` mean in `scope`, such as `time.sleep`; empty if that is uncertain."""
        origins = set()
        for binding in self.bindings(name, scope):
            if not isinstance(binding.node, ast.alias):
                return ""
            statement = self.parent(binding.node)
            if isinstance(statement, ast.ImportFrom):
                origins.add(f"{statement.module}.{binding.node.name}")
            else:
                origins.add(binding.node.name if binding.node.asname else name)
        return origins.pop() if len(origins) == 1 else ""

    def global_bindings(self, name: str) -> list[Binding]:
        """Return the places that give the program global `name` a value, in the order of the text."""
        found = self._global_bindings.get(name)
        if found is None:
            found = [binding for scope in self.declaring(name) for binding in scope.bindings.get(name, ())]
            found.sort(key=lambda binding: (binding.line, binding.column))
            self._global_bindings[name] = found
        return found

    def late_globals(self) -> tuple[LateGlobal, ...]:
        """Return the `global` statements that come too late, in the order of the text."""
        late = []
        for scope in self.scopes:
            for name, statements in scope.globals.items():
                if name in scope.parameters:
                    continue
                uses = [self.place(read) for read in scope.reads.get(name, ())]
                uses += [(binding.line, binding.column) for binding in scope.bindings.get(name, ())]
                first = min(uses, default=None)
                for statement in statements:
                    if first is not None and first < self.place(statement):
                        late.append(LateGlobal(name, statement, scope, first[0]))
        return tuple(sorted(late, key=lambda item: (_position(item.statement), item.name)))


_place: Final = attrgetter("lineno", "col_offset")


def _position(node: ast.AST) -> tuple[int, int]:
    return getattr(node, "lineno", 0), getattr(node, "col_offset", 0)


class _Walk:
    """Visits every node once; `kind` is how a stored name is bound."""

    __slots__ = ("stack", "symbols")

    def __init__(self, symbols: Symbols) -> None:
        self.symbols = symbols
        self.stack: list[tuple[ast.AST, Scope, str]] = []

    def run(self) -> None:
        body = self.symbols.body
        if isinstance(body.node, ast.FunctionDef):
            self._parameters(body.node.args, body, body, body.node)
            if body.node.returns is not None:
                self._push(body.node.returns, body, body.node)
        for statement in body.statements:
            self._push(statement, body, body.node)
        while self.stack:
            node, scope, kind = self.stack.pop()
            visit = _VISITS.get(type(node))
            if visit is not None:
                visit(self, node, scope, kind)
            else:
                self._below(node, scope)

    def _push(self, node: ast.AST | None, scope: Scope, parent: ast.AST, kind: str = "assign") -> None:
        if node is not None:
            self._note(node, scope, parent)
            self.stack.append((node, scope, kind))

    def _note(self, node: ast.AST, scope: Scope, parent: ast.AST) -> None:
        self.symbols._parents[node] = parent
        self.symbols._scope_of[node] = scope

    def _push_all(self, nodes: Iterable[ast.AST], scope: Scope, parent: ast.AST) -> None:
        for node in nodes:
            self._push(node, scope, parent)

    def _below(self, node: ast.AST, scope: Scope, kind: str = "assign") -> None:
        """Visit the nodes directly inside a node; constants and names that are read, which most are, at once."""
        parents, scope_of, push = self.symbols._parents, self.symbols._scope_of, self.stack.append
        what = type(node)
        if what is ast.Call:
            below: list[Any] = [node.func, *node.args, *node.keywords]  # type: ignore[attr-defined]
        elif what is ast.List or what is ast.Tuple:
            below = node.elts  # type: ignore[attr-defined]
        elif what is ast.keyword or what is ast.Expr:
            below = [node.value]  # type: ignore[attr-defined]
        elif what is ast.UnaryOp:
            below = [node.operand]  # type: ignore[attr-defined]
        elif what is ast.BinOp:
            below = [node.left, node.right]  # type: ignore[attr-defined]
        else:
            below = children(node)
        for child in below:
            parents[child] = node
            scope_of[child] = scope
            what = type(child)
            if what is ast.Name and type(child.ctx) is ast.Load:
                scope.reads.setdefault(child.id, []).append(child)
            elif what is not ast.Constant:
                push((child, scope, kind))

    def _bind(self, name: str, node: ast.AST, scope: Scope, kind: str) -> None:
        line, column = self.symbols.place(node)
        scope.bindings.setdefault(name, []).append(Binding(name, node, kind, line, column))

    def _parameters(self, args: ast.arguments, inner: Scope, outer: Scope, parent: ast.AST) -> None:
        self._note(args, outer, parent)
        for argument in (*args.posonlyargs, *args.args, args.vararg, *args.kwonlyargs, args.kwarg):
            if argument is not None:
                inner.parameters[argument.arg] = argument
                self._bind(argument.arg, argument, inner, "parameter")
                self._note(argument, inner, args)
                self._push(argument.annotation, outer, argument)
        for default in (*args.defaults, *args.kw_defaults):
            self._push(default, outer, args)

    # Visits, by kind of node

    def name(self, node: ast.Name, scope: Scope, kind: str) -> None:
        if isinstance(node.ctx, ast.Load):
            scope.reads.setdefault(node.id, []).append(node)
            return
        if kind == "augmented":
            scope.reads.setdefault(node.id, []).append(node)
        if kind == "walrus":
            while scope.kind == "comprehension" and scope.parent is not None:
                scope = scope.parent
        self._bind(node.id, node, scope, "delete" if isinstance(node.ctx, ast.Del) else kind)

    def spread(self, node: ast.AST, scope: Scope, kind: str) -> None:
        self._below(node, scope, kind)

    def call(self, node: ast.Call, scope: Scope, kind: str) -> None:
        scope.calls.append(node)
        self._below(node, scope)

    def function(self, node: ast.FunctionDef, scope: Scope, kind: str) -> None:
        self._bind(node.name, node, scope, "def")
        inner = Scope(self.symbols._declared, "function", node.name, node, scope)
        self._push_all(node.decorator_list, scope, node)
        self._parameters(node.args, inner, scope, node)
        self._push(node.returns, scope, node)
        self._push_all(node.body, inner, node)

    def anonymous(self, node: ast.Lambda, scope: Scope, kind: str) -> None:
        inner = Scope(self.symbols._declared, "lambda", "", node, scope)
        self._parameters(node.args, inner, scope, node)
        self._push(node.body, inner, node)

    def cls(self, node: ast.ClassDef, scope: Scope, kind: str) -> None:
        self._bind(node.name, node, scope, "class")
        inner = Scope(self.symbols._declared, "class", node.name, node, scope)
        self._push_all([*node.decorator_list, *node.bases, *node.keywords], scope, node)
        self._push_all(node.body, inner, node)

    def comprehension(self, node: ast.ListComp, scope: Scope, kind: str) -> None:
        inner = Scope(self.symbols._declared, "comprehension", "", node, scope)
        for index, generator in enumerate(node.generators):
            self._note(generator, inner, node)
            self._push(generator.target, inner, generator, "for")
            self._push(generator.iter, scope if index == 0 else inner, generator)
            self._push_all(generator.ifs, inner, generator)
        for field in ("elt", "key", "value"):
            self._push(getattr(node, field, None), inner, node)

    def loop(self, node: ast.For, scope: Scope, kind: str) -> None:
        self._push(node.target, scope, node, "for")
        self._push_all([node.iter, *node.body, *node.orelse], scope, node)

    def withitem(self, node: ast.withitem, scope: Scope, kind: str) -> None:
        self._push(node.context_expr, scope, node)
        self._push(node.optional_vars, scope, node, "with")

    def assignment(self, node: ast.AugAssign | ast.AnnAssign | ast.NamedExpr, scope: Scope, kind: str) -> None:
        self._push(node.target, scope, node, _ASSIGNMENTS[type(node)])
        self._push(getattr(node, "annotation", None), scope, node)
        self._push(node.value, scope, node)

    def declaration(self, node: ast.Global | ast.Nonlocal, scope: Scope, kind: str) -> None:
        for name in node.names:
            if isinstance(node, ast.Global):
                self.symbols._declared.add(name)
                scope.globals.setdefault(name, []).append(node)
            else:
                scope.nonlocals.setdefault(name, []).append(node)

    def imports(self, node: ast.Import | ast.ImportFrom, scope: Scope, kind: str) -> None:
        for alias in node.names:
            self._note(alias, scope, node)
            name = alias.asname or (alias.name.partition(".")[0] if isinstance(node, ast.Import) else alias.name)
            if name != "*":
                self._bind(name, alias, scope, "import")

    def handler(self, node: ast.ExceptHandler, scope: Scope, kind: str) -> None:
        if node.name:
            self._bind(node.name, node, scope, "except")
        self._below(node, scope)

    def pattern(self, node: ast.AST, scope: Scope, kind: str) -> None:
        name = getattr(node, "rest", None) if isinstance(node, ast.MatchMapping) else getattr(node, "name", None)
        if name:
            self._bind(name, node, scope, "match")
        self._below(node, scope)


_ASSIGNMENTS: Final = {ast.AugAssign: "augmented", ast.AnnAssign: "annotated", ast.NamedExpr: "walrus"}
_VISITS: dict[type[ast.AST], Callable[[_Walk, Any, Scope, str], None]] = {
    ast.Name: _Walk.name,
    ast.Tuple: _Walk.spread,
    ast.List: _Walk.spread,
    ast.Starred: _Walk.spread,
    ast.Call: _Walk.call,
    ast.FunctionDef: _Walk.function,
    ast.AsyncFunctionDef: _Walk.function,
    ast.Lambda: _Walk.anonymous,
    ast.ClassDef: _Walk.cls,
    **dict.fromkeys(_COMPREHENSIONS, _Walk.comprehension),
    ast.For: _Walk.loop,
    ast.AsyncFor: _Walk.loop,
    ast.withitem: _Walk.withitem,
    **dict.fromkeys(_ASSIGNMENTS, _Walk.assignment),
    ast.Global: _Walk.declaration,
    ast.Nonlocal: _Walk.declaration,
    ast.Import: _Walk.imports,
    ast.ImportFrom: _Walk.imports,
    ast.ExceptHandler: _Walk.handler,
    ast.MatchAs: _Walk.pattern,
    ast.MatchStar: _Walk.pattern,
    ast.MatchMapping: _Walk.pattern,
}
