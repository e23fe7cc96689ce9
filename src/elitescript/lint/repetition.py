"""Analyses how loops end: what they call, change and wait for, and their ways out."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.hooks import LINE
from elitescript.language.symbols import Resolution, Scope
from elitescript.lint.program import AnalysedProgram

_QUICK_BUILTINS: Final = frozenset(
    """
    abs all any bin bool bytearray bytes chr complex dict divmod enumerate float format frozenset hash hex id int
    isinstance len list long max min oct ord pow print range repr reversed round set sorted str sum tuple type unichr
    zip
    """.split()  # noqa: SIM905
) | {LINE}
_QUICK_METHODS: Final = frozenset(
    """
    append encode endswith extend format insert items keys lower replace split startswith strip upper values
    """.split()  # noqa: SIM905
)
"""Methods that no object which waits has."""

_MOST_GUARDS: Final = 60
"""Conditions around one way out; an `elif` chain that is longer is not followed."""

_CLOCK: Final = frozenset("time monotonic perf_counter time_ns monotonic_ns perf_counter_ns".split())  # noqa: SIM905
_ENDING: Final = frozenset(("halt", "random"))
"""Commands after which a loop may end by itself: one stops the program, one gives another value each time."""


class Work:
    """Effects of a part of a program.

    Attributes:
        is_uncertain: it may wait, or may leave in a way that is not followed.
        exits: for each way out, the conditions under which it is taken.
        changed: names that it binds, or whose objects it may change.
        read: names that it reads.
    """

    __slots__ = ("changed", "exits", "is_uncertain", "read")

    def __init__(self) -> None:
        self.is_uncertain = False
        self.exits: list[list[ast.expr]] = []
        self.changed: set[str] = set()
        self.read: set[str] = set()


class Analyst:
    """Analyses the loops of one program, and the functions that they call."""

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self._symbols = program.symbols
        self._functions: dict[Scope, Work] = {}
        self._own_methods = {name for scope in self._symbols.scopes if scope.kind == "class" for name in scope.bindings}

    def is_busy(self, loop: ast.While) -> bool:
        """Return whether a loop never waits, and nothing that it does itself can end it."""
        work = Work()
        if isinstance(loop.test, ast.Constant):
            if not loop.test.value:
                return False
        else:
            work.exits.append([loop.test])
            self._expression(loop.test, work)
        self._block(loop.body, [], work, is_nested=False)
        if work.is_uncertain or self._program.is_tried(loop):
            return False
        return all(guards and all(self._comes_from_outside(test, work) for test in guards) for guards in work.exits)

    def polls(self, loop: ast.While) -> bool:
        """Return whether a loop asks a signal in its condition, never waits, and else only counts: it looks at the same
        moment again and again, until its counter ends it.
        """
        work = Work()
        self._expression(loop.test, work)
        self._block(loop.body, [], work, is_nested=False)
        if work.is_uncertain or self._program.is_tried(loop) or not work.changed:
            return False
        parts = loop.test.values if isinstance(loop.test, ast.BoolOp) else [loop.test]
        return all(map(_is_count, loop.body)) and any(
            self._asks(part) and self._comes_from_outside(part, work) for part in parts
        )

    def _asks(self, test: ast.expr) -> bool:
        """Return whether a condition calls a command that reads a signal or a sensor, perhaps through a function."""
        open_nodes: list[ast.AST] = [test]
        seen: set[ast.AST] = set()
        while open_nodes:
            for call in ast.walk(open_nodes.pop()):
                if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
                    continue
                scope = self._symbols.scope_of(call.func)
                command = self._program.command(call.func.id, scope)
                if command is not None and command.details.result.origin in ("signal", "measured"):
                    return True
                functions = {target.node for target in self._symbols.definitions(call.func.id, scope)} - seen
                seen |= functions
                open_nodes += functions
        return False

    # Statements

    def _block(self, statements: list[ast.stmt], guards: list[ast.expr], work: Work, *, is_nested: bool) -> None:
        for statement in statements:
            if work.is_uncertain:
                return
            self._statement(statement, guards, work, is_nested=is_nested)

    def _statement(self, node: ast.stmt, guards: list[ast.expr], work: Work, *, is_nested: bool) -> None:
        if len(guards) > _MOST_GUARDS:
            work.is_uncertain = True
        elif isinstance(node, ast.If):
            self._expression(node.test, work)
            inner = [*guards, node.test]
            self._block(node.body, inner, work, is_nested=is_nested)
            self._block(node.orelse, inner, work, is_nested=is_nested)
        elif isinstance(node, ast.Break):
            if not is_nested:
                work.exits.append(guards)
        elif isinstance(node, (ast.Return, ast.Raise, ast.Assert)):
            if is_nested:
                work.is_uncertain = True
            work.exits.append([*guards, node.test] if isinstance(node, ast.Assert) else guards)
            self._expressions(node, work)
        elif isinstance(node, ast.Try):
            self._try(node, guards, work, is_nested=is_nested)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            work.changed.update(alias.asname or alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, (ast.For, ast.While)):
            self._expression(node.iter if isinstance(node, ast.For) else node.test, work)
            if isinstance(node, ast.For):
                self._expression(node.target, work)
            self._block([*node.body, *node.orelse], guards, work, is_nested=True)
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            work.changed.add(node.name)
        elif isinstance(node, (ast.With, ast.Match)):
            work.is_uncertain = True
        else:
            self._expressions(node, work)

    def _try(self, node: ast.Try, guards: list[ast.expr], work: Work, *, is_nested: bool) -> None:
        """Add what a `try` does; where a handler leaves, an exception may be the way out, which is not followed."""
        self._block([*node.body, *node.orelse, *node.finalbody], guards, work, is_nested=is_nested)
        exits = len(work.exits)
        for handler in node.handlers:
            if handler.name:
                work.changed.add(handler.name)
            self._block(handler.body, guards, work, is_nested=is_nested)
        if len(work.exits) > exits:
            work.is_uncertain = True

    def _expressions(self, node: ast.AST, work: Work) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                self._expression(child, work)

    # Expressions

    def _expression(self, root: ast.expr, work: Work) -> None:
        for node in _executed(root):
            if isinstance(node, ast.Name):
                (work.read if isinstance(node.ctx, ast.Load) else work.changed).add(node.id)
            elif isinstance(node, (ast.Attribute, ast.Subscript)):
                if not isinstance(node.ctx, ast.Load):
                    _touch(node, work)
            elif isinstance(node, ast.Call):
                self._call(node, work)
            elif isinstance(node, (ast.Yield, ast.YieldFrom, ast.Await)):
                work.is_uncertain = True

    def _call(self, call: ast.Call, work: Work) -> None:
        if any(keyword.arg == "key" for keyword in call.keywords):
            work.is_uncertain = True
        function = call.func
        if isinstance(function, ast.Attribute):
            self._method(call, function, work)
        elif isinstance(function, ast.Name):
            self._function(call, function, work)
        else:
            work.is_uncertain = True

    def _method(self, call: ast.Call, function: ast.Attribute, work: Work) -> None:
        base = function.value
        if isinstance(base, ast.Name) and self._symbols.imported(base.id, self._symbols.scope_of(base)) == base.id:
            is_quick = base.id == "math" or (base.id == "time" and function.attr in _CLOCK)
        else:
            is_quick = isinstance(base, ast.Constant) or (
                function.attr in _QUICK_METHODS and function.attr not in self._own_methods
            )
            _touch(function, work)
            _touch_arguments(call, work)
        work.is_uncertain = work.is_uncertain or not is_quick

    def _function(self, call: ast.Call, function: ast.Name, work: Work) -> None:
        name = function.id
        scope = self._symbols.scope_of(function)
        if scope.resolve(name) is Resolution.BUILTIN:
            command = self._program.command(name, scope)
            if command is not None:
                work.is_uncertain = work.is_uncertain or command.waits or name in _ENDING
            elif name not in _QUICK_BUILTINS:
                work.is_uncertain = True
            return
        bindings = self._symbols.bindings(name, scope)
        targets = self._symbols.definitions(name, scope)
        if not targets or any(binding.kind != "def" for binding in bindings):
            work.is_uncertain = True
            return
        _touch_arguments(call, work)
        for target in targets:
            inner = self._work_of(target)
            work.is_uncertain = work.is_uncertain or inner.is_uncertain
            work.changed |= inner.changed
            work.read |= inner.read

    def _work_of(self, scope: Scope) -> Work:
        """Return what a function of the program does; a recursive call adds nothing."""
        if scope not in self._functions:
            work = self._functions[scope] = Work()
            node = scope.node
            if not isinstance(node, ast.FunctionDef) or node.decorator_list:
                work.is_uncertain = True
                return work
            self._block(node.body, [], work, is_nested=False)
            if any(isinstance(inner, (ast.Raise, ast.Assert)) for inner in ast.walk(node)):
                work.is_uncertain = True
            own = {name for name in scope.bindings if scope.has_local(name)}
            work.changed -= own - set(scope.parameters)
            work.exits.clear()
        return self._functions[scope]

    # Conditions

    def _comes_from_outside(self, test: ast.expr, work: Work) -> bool:
        """Return whether nothing that the loop does can change a condition; an input or another thread may."""
        condition = Work()
        self._expression(test, condition)
        if condition.is_uncertain or condition.changed:
            return False
        return not condition.read & work.changed


def _is_count(statement: ast.stmt) -> bool:
    """Return whether a statement does nothing, counts, or leaves because of a count."""
    if isinstance(statement, ast.If):
        leaves = all(isinstance(inner, (ast.Break, ast.Return)) or _is_count(inner) for inner in statement.body)
        return isinstance(statement.test, ast.Compare) and leaves and not statement.orelse
    if isinstance(statement, ast.AugAssign):
        return isinstance(statement.value, (ast.Constant, ast.Name))
    if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.BinOp):
        return all(isinstance(side, (ast.Constant, ast.Name)) for side in (statement.value.left, statement.value.right))
    return isinstance(statement, ast.Pass)


def _executed(root: ast.expr) -> Iterator[ast.AST]:
    """Yield the nodes of an expression that are evaluated with it: not those inside a lambda."""
    stack: list[ast.AST] = [root]
    while stack:
        node = stack.pop()
        yield node
        if not isinstance(node, ast.Lambda):
            stack.extend(ast.iter_child_nodes(node))


def _touch(node: ast.expr, work: Work) -> None:
    """Count the name that an attribute or element belongs to as changed."""
    while isinstance(node, (ast.Attribute, ast.Subscript)):
        node = node.value
    if isinstance(node, ast.Name):
        work.changed.add(node.id)


def _touch_arguments(call: ast.Call, work: Work) -> None:
    for argument in (*call.args, *(keyword.value for keyword in call.keywords)):
        for node in _executed(argument):
            if isinstance(node, ast.Name):
                work.changed.add(node.id)
