"""Follows which local variables have a value where they are read."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from functools import cached_property
from typing import Final

from elitescript.language.nodes import children
from elitescript.language.scopes import Binding, Scope
from elitescript.lint.flow import Flow, takes_all
from elitescript.lint.placing import conditions
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple

_UNSET: Final = ("delete", "except", "match")
"""Bindings of names that may lose their value again, or get it in a way that is not followed."""
_FOREIGN: Final = frozenset(("exec", "eval", "interpreter_mode", "globals", "locals", "vars"))
"""Functions after which other texts may give variables a value."""
_DEEPEST: Final = 60

Branch = ast.If | ast.For | ast.While | ast.Match | ast.Try
"""A statement of which some ways give a variable a value, and others do not."""


class Unassigned(NamedTuple):
    """A variable that is read where it may have no value.

    Attributes:
        node: where it is read.
        scope: the function.
        branch: the statement of which some ways give it a value; None where nothing before it does.
    """

    node: ast.Name
    scope: Scope
    branch: Branch | None


class Assignments:
    """The variables of one program that are read without a value.

    Args:
        program: the program.
    """

    __slots__ = ("__dict__", "_program")

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program

    @cached_property
    def found(self) -> tuple[Unassigned, ...]:
        """The first reading of each variable that has no value, or may have none, in the order of the scopes."""
        program = self._program
        if any(name in scope.reads for scope in program.symbols.scopes for name in _FOREIGN):
            return ()
        flow = Flow(program)
        found: list[Unassigned] = []
        for scope in program.symbols.scopes:
            if scope.kind not in ("function", "body"):
                continue
            names = {
                name
                for name, bindings in scope.bindings.items()
                if scope.has_local(name)
                and name in scope.reads
                and name not in scope.parameters
                and not program.symbols.is_nonlocal_inside(name, scope)
                and name not in program.presets
                and not any(binding.kind in _UNSET for binding in bindings)
                and not _is_set_before(program, scope, bindings[0])
            }
            if names:
                follower = _Follower(program, scope, names, flow)
                follower.block(scope.statements, 0)
                found += follower.found.values()
        return tuple(found)


def _is_set_before(program: AnalysedProgram, scope: Scope, first: Binding) -> bool:
    """Return whether an assignment, the first of its variable, stands in front of all readings in its own block."""
    symbols = program.symbols
    statement = symbols.parent(first.node)
    if not isinstance(statement, ast.Assign) or not isinstance(first.node, ast.Name):
        return False
    _, block, _ = symbols.block_of(statement)
    last = block[-1]
    begin, end = (statement.end_lineno, statement.end_col_offset), (last.end_lineno, last.end_col_offset)
    for read in symbols.reads_of(first.name, scope):
        if not begin <= (read.lineno, read.col_offset) < end:
            inner = symbols.scope_of(read)
            # Functions are run later.
            if inner is scope or inner.kind == "comprehension":
                return False
    return True


class _Follower:
    """Follows the statements of one function; `sure` are the names that have a value, `log` in which order they got it.

    A branch takes back what it has added, so that it costs what it adds.
    """

    __slots__ = ("branches", "flow", "found", "log", "loops", "names", "program", "scope", "seen", "spans", "sure")

    def __init__(self, program: AnalysedProgram, scope: Scope, names: set[str], flow: Flow) -> None:
        self.program, self.scope, self.names, self.flow = program, scope, names, flow
        self.sure: set[str] = set()
        self.log: list[str] = []
        self.seen: set[str] = set()
        self.branches: dict[str, Branch | None] = {}
        self.loops: list[tuple[int, list[set[str]]]] = []
        self.spans: list[tuple[int, int]] = []
        self.found: dict[str, Unassigned] = {}

    # What is bound and read

    def bind(self, name: str) -> None:
        if name in self.names:
            self.seen.add(name)
            if name not in self.sure:
                self.sure.add(name)
                self.log.append(name)

    def take_back(self, mark: int) -> list[str]:
        """Take back what was added since a mark, and return it."""
        added = self.log[mark:]
        del self.log[mark:]
        self.sure.difference_update(added)
        return added

    def keep(self, ends: Sequence[list[str] | set[str]], branch: Branch | None) -> None:
        """Go on with what all branches have given a value."""
        if not ends:
            return
        both = set(ends[0]).intersection(*ends[1:])
        for end in ends:
            for name in end:
                if name in both:
                    self.bind(name)
                else:
                    self.branches[name] = branch if self.branches.get(name, branch) is branch else None

    def read(self, root: ast.AST | None) -> None:
        """Look at the names that an expression reads, and bind those that it assigns."""
        if root is None:
            return
        if type(root) is ast.Constant:
            return
        stack = [root]
        while stack:
            node = stack.pop()
            if isinstance(node, ast.Name):
                if node.id in self.names:
                    if isinstance(node.ctx, ast.Load):
                        self.look(node)
                    elif self.program.symbols.scope_of(node) is self.scope:
                        self.bind(node.id)
            elif not isinstance(node, ast.Lambda):
                stack.extend(children(node))

    def look(self, node: ast.Name) -> None:
        name = node.id
        if name in self.sure or name in self.found:
            return
        inner = self.program.symbols.scope_of(node)
        if inner is not self.scope and inner.home(name) is not self.scope:
            return
        branch = None
        if name in self.seen:
            branch = self.branches.get(name)
            if branch is None:
                return
        elif self._may_be_bound_in_an_earlier_turn(node):
            return
        self.found[name] = Unassigned(node, self.scope, branch)

    def _may_be_bound_in_an_earlier_turn(self, node: ast.Name) -> bool:
        """Return whether a loop around a reading gives the variable a value, and the first turn may not come here."""
        lines = [binding.line for binding in self.scope.bindings[node.id] if not self._needs_a_value(binding)]
        around = [any(first <= line <= last for line in lines) for first, last in self.spans]
        if not any(around):
            return False
        return not all(around) or any(
            not isinstance(statement, (ast.For, ast.While)) for statement, _ in conditions(self.program.symbols, node)
        )

    def _needs_a_value(self, binding: Binding) -> bool:
        """Return whether an assignment reads its own variable, so that it gives it no first value."""
        if binding.kind == "augmented":
            return True
        above = next(iter(self.program.symbols.ancestors(binding.node)), None)
        return isinstance(above, ast.Assign) and _reads(binding.name, above.value)

    # Statements

    def block(self, statements: Sequence[ast.stmt], depth: int) -> bool:
        """Follow statements; return whether what stands behind them is reached."""
        if depth > _DEEPEST:
            self.names = set()
            return True
        return all(self.statement(statement, depth + 1) for statement in statements)

    def statement(self, node: ast.stmt, depth: int) -> bool:
        kind = type(node)
        if isinstance(node, ast.Expr):
            self.read(node.value)
            return not (isinstance(node.value, ast.Call) and self.flow.never_returns(node.value))
        if isinstance(node, ast.Assign):
            self.read(node.value)
            for target in node.targets:
                self.read(target)
        elif isinstance(node, ast.AugAssign):
            self.read(node.value)
            if isinstance(node.target, ast.Name):
                if node.target.id in self.names:
                    self.look(node.target)
                self.bind(node.target.id)
            else:
                self.read(node.target)
        elif isinstance(node, ast.AnnAssign):
            if node.value is not None:
                self.read(node.value)
                self.read(node.target)
        elif isinstance(node, (ast.Return, ast.Raise)):
            for child in children(node):
                self.read(child)
            return False
        elif kind is ast.Break:
            if self.loops:
                mark, breaks = self.loops[-1]
                breaks.append(set(self.log[mark:]))
            return False
        elif kind is ast.Continue:
            return False
        elif isinstance(node, ast.If):
            return self.branch(node, depth)
        elif isinstance(node, (ast.While, ast.For)):
            return self.loop(node, depth)
        elif isinstance(node, ast.Try):
            return self.attempt(node, depth)
        elif isinstance(node, ast.With):
            for item in node.items:
                self.read(item.context_expr)
                self.read(item.optional_vars)
            return self.block(node.body, depth)
        elif isinstance(node, ast.Match):
            self.read(node.subject)
            return self.choice(node, depth)
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            self.bind(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            for alias in node.names:
                self.bind(alias.asname or alias.name.partition(".")[0])
        elif isinstance(node, ast.Assert):
            self.read(node.test)
        return True

    def branch(self, node: ast.If, depth: int) -> bool:
        mark = len(self.log)
        ends: list[list[str]] = []
        current = node
        while True:
            self.read(current.test)
            tested = self.log[mark:]
            if self.block(current.body, depth):
                ends.append(self.take_back(mark))
            else:
                self.take_back(mark)
            for name in tested:
                self.bind(name)
            rest = current.orelse
            if len(rest) == 1 and isinstance(rest[0], ast.If):
                current = rest[0]
                continue
            if self.block(rest, depth):
                ends.append(self.take_back(mark))
            else:
                self.take_back(mark)
            break
        self.keep(ends, node)
        return bool(ends)

    def choice(self, node: ast.Match, depth: int) -> bool:
        mark = len(self.log)
        ends: list[list[str]] = []
        for case in node.cases:
            self.read(case.guard)
            is_reached = self.block(case.body, depth)
            added = self.take_back(mark)
            if is_reached:
                ends.append(added)
        if not any(takes_all(case) for case in node.cases):
            ends.append([])
        self.keep(ends, node)
        return bool(ends)

    def loop(self, node: ast.While | ast.For, depth: int) -> bool:
        is_endless = isinstance(node, ast.While) and isinstance(node.test, ast.Constant) and bool(node.test.value)
        self.read(node.iter if isinstance(node, ast.For) else node.test)
        mark = len(self.log)
        breaks: list[set[str]] = []
        self.loops.append((mark, breaks))
        self.spans.append((node.lineno, node.end_lineno or node.lineno))
        if isinstance(node, ast.For):
            self.read(node.target)
        self.block(node.body, depth)
        self.loops.pop()
        self.spans.pop()
        added = self.take_back(mark)
        if is_endless:
            self.keep(breaks, None)
            return bool(breaks)
        # What follows an `else` of a loop may be another case than no turn at all.
        self.keep([added, []], None if node.orelse else node)
        self.block(node.orelse, depth)
        return True

    def attempt(self, node: ast.Try, depth: int) -> bool:
        mark = len(self.log)
        ends: list[list[str]] = []
        is_reached = self.block(node.body, depth) and self.block(node.orelse, depth)
        body = self.take_back(mark)
        if is_reached:
            ends.append(body)
        before = {name: self.branches[name] for name in body if name in self.branches}
        for name in body:
            self.branches[name] = None
        for handler in node.handlers:
            is_reached = self.block(handler.body, depth)
            added = self.take_back(mark)
            if is_reached:
                ends.append(added)
        for name in body:
            self.branches.pop(name, None)
        self.branches |= before
        if ends:
            self.keep(ends, node)
        return self.block(node.finalbody, depth) and bool(ends)


def _reads(name: str, value: ast.AST) -> bool:
    """Return whether an expression reads a variable whenever it is computed."""
    if isinstance(value, ast.Name):
        return value.id == name
    if isinstance(
        value, (ast.Lambda, ast.IfExp, ast.BoolOp, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
    ):
        return False
    return any(_reads(name, part) for part in children(value))
