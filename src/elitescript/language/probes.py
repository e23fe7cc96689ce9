"""Counts statements: puts a probe before each statement of a text, for a debugger or for coverage.

Nothing is inserted unless `Options.probes` asks for it. A probe uses up no work, has the place of its statement and
changes no result: work, ticks, lines, alarms and events are those of a run without probes.

`STEPS_PROBES`, for a debugger: before statement N stands

    if not @steps[N](): @step(N)()

`@steps` is a list of built-in functions, one for each statement. Each is `pop` of a list of a debugger: one of true
values above a false one, which leads to `@step` after a number of statements; or one of false values, for a breakpoint.
So a statement that does not stop costs one call of `list.pop`, as a checkpoint does, and needs as much stack. What
`@step` returns is called, in the place of the statement, and must return True. The condition of a `while` is a
statement each time it is computed.

`HITS_PROBES`, for coverage: before statement N stands `@hits[N] += 1`; a `while` counts once. A side of a branch on
which no statement stands has a counter of its own, in an `else` or a `case _` that is put in.

`ATTACH_PROBES`, for a debugger that may come later: statements get the same numbers and no counters; what stands before
them, and where, is in `switches`.

Statements are numbered in the order of the text, from `Options.first_probe`; the counters of sides follow. Counted are
all but `global`, `nonlocal`, constants on lines of their own (docstrings), `$ LINE` marks, and statements in line 0,
which are not of the text.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Final, TypeVar

from elitescript.language.hooks import HITS, LINE, STEP, STEPS
from elitescript.language.kinds import is_text
from elitescript.language.nodes import Census
from elitescript.language.parser import character_offset
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple

STEPS_PROBES: Final = "steps"
HITS_PROBES: Final = "coverage"
ATTACH_PROBES: Final = "attach"

_BODIES: Final = ("body", "orelse", "finalbody")
_ENDS: Final = {
    ast.If: "test",
    ast.While: "test",
    ast.For: "iter",
    ast.Match: "subject",
    ast.With: "items",
    ast.FunctionDef: "",
    ast.ClassDef: "",
    ast.Try: "",
}
"""Statements that hold others: the part with which their first line ends; empty for the end of the row."""

_Node = TypeVar("_Node", bound=ast.AST)
_LOAD = ast.Load()
_STORE = ast.Store()
_NOT = ast.Not()
_ADD = ast.Add()
_OR = ast.Or()
_AND = ast.And()


class CountedStatement(NamedTuple):
    """A statement that is counted. Of one that holds others the place is its first line.

    Attributes:
        number: of its counter.
        line, column, end_line, end_column: place, from 1, in characters, end exclusive.
        function: dotted names of the functions and classes around it; empty in the body of the program.
    """

    number: int
    line: int
    column: int
    end_line: int
    end_column: int
    function: str


class CountedBranch(NamedTuple):
    """A side of a branch.

    Attributes:
        statement: number of the `if`, `for`, `while` or `match`.
        number: counter of the side: how often it was taken.
        line: first line of the side; that of the statement for a side without text.
    """

    statement: int
    number: int
    line: int


class CountedFunction(NamedTuple):
    """A function of a text.

    Attributes:
        name: dotted, as `CountedStatement.function`.
        line, end_line: of the `def`, and of its last statement.
        number: counter of its first statement, which counts its calls; -1 if nothing in it is counted.
    """

    name: str
    line: int
    end_line: int
    number: int


class ProbeTable(NamedTuple):
    """What the numbers of the probes of a text mean.

    Attributes:
        first: number of the first probe.
        size: counters, of statements and of sides.
        statements: in the order of the text and of their numbers.
        branches: in the order of the text; none without `HITS_PROBES`.
        functions: in the order of the text.
    """

    first: int = 0
    size: int = 0
    statements: Sequence[CountedStatement] = ()
    branches: tuple[CountedBranch, ...] = ()
    functions: tuple[CountedFunction, ...] = ()


NO_PROBES: Final = ProbeTable()


def insert_probes(census: Census, body: list[ast.stmt], source: SourceFile, kind: str, first: int) -> ProbeTable:
    """Put a probe before each statement. Called before checkpoints are inserted.

    Args:
        census: of the tree.
        body: of the program.
        source: the text.
        kind: `STEPS_PROBES` or `HITS_PROBES`.
        first: number of the first probe.
    """
    insertion = _Insertion(source, kind, first)
    table = insertion.table(body)
    insertion.insert(census)
    return table


def is_probe(statement: ast.stmt) -> bool:
    """Return whether a statement was put in by `insert_probes`."""
    if isinstance(statement, ast.AugAssign):
        target = statement.target
        return isinstance(target, ast.Subscript) and isinstance(target.value, ast.Name) and target.value.id == HITS
    if not isinstance(statement, ast.If) or not isinstance(statement.test, ast.UnaryOp):
        return False
    call = statement.test.operand
    if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Subscript):
        return False
    return isinstance(call.func.value, ast.Name) and call.func.value.id == STEPS


def number_statements(body: list[ast.stmt], source: SourceFile, first: int) -> tuple[ProbeTable, dict[ast.stmt, int]]:
    """Return the table of `STEPS_PROBES`, and the numbers of the statements; nothing is inserted."""
    insertion = _Insertion(source, ATTACH_PROBES, first)
    return insertion.table(body), insertion.numbers


class _Insertion:
    def __init__(self, source: SourceFile, kind: str, first: int) -> None:
        self._source = source
        self._is_of_coverage = kind == HITS_PROBES
        self._first = self._next = first
        self.numbers: dict[ast.stmt, int] = {}
        self._branches: list[CountedBranch] = []
        self._lists: list[tuple[list[ast.stmt], str]] = []

    def table(self, body: list[ast.stmt]) -> ProbeTable:
        """Number the statements, and count the sides of branches if that is asked for."""
        self._lists, functions = _walk(body)
        found = [(statement, name) for statements, name in self._lists for statement in statements]
        found = [item for item in found if _is_counted(item[0])]
        found.sort(key=lambda item: (item[0].lineno, item[0].col_offset))
        statements = []
        for statement, name in found:
            self.numbers[statement] = self._next
            statements.append(CountedStatement(self._next, *self._place(statement), name))
            self._next += 1
        if self._is_of_coverage:
            for statement, _ in found:
                self._count_sides(statement)
        counted = tuple(
            CountedFunction(name, node.lineno, node.end_lineno or node.lineno, self._calls(node))
            for name, node in sorted(functions, key=lambda item: (item[1].lineno, item[1].col_offset))
        )
        return ProbeTable(self._first, self._next - self._first, tuple(statements), tuple(self._branches), counted)

    def insert(self, census: Census) -> None:
        """Put the probes in, behind `table`."""
        for statements, _ in self._lists:
            self._fill(statements)
        if not self._is_of_coverage:
            for repetition in census.of(ast.While):
                if repetition in self.numbers:
                    probe = self._step_expression(repetition, self.numbers[repetition])
                    both = ast.BoolOp(_AND, [probe, repetition.test])
                    repetition.test = ast.copy_location(both, repetition.test)

    def _place(self, statement: ast.stmt) -> tuple[int, int, int, int]:
        line, column = statement.lineno, self._column(statement.lineno, statement.col_offset)
        end: ast.AST = statement
        if type(statement) in _ENDS:
            field = _ENDS[type(statement)]
            if not field:
                return line, column, line, max(column + 1, len(self._source.line(line).rstrip()) + 1)
            part = getattr(statement, field)
            end = part[-1].context_expr if isinstance(part, list) else part
        end_line = getattr(end, "end_lineno", None) or line
        return line, column, end_line, self._column(end_line, getattr(end, "end_col_offset", None) or 0)

    def _column(self, line: int, offset: int) -> int:
        return character_offset(self._source.line(line), offset) + 1

    # ---------------------------------------------------------------- sides

    def _count_sides(self, statement: ast.stmt) -> None:
        if isinstance(statement, ast.Match):
            for case in statement.cases:
                self._add_side(statement, case.body)
            last = statement.cases[-1]
            if last.guard is not None or not _takes_all(last.pattern):
                nothing = ast.match_case(_at(ast.MatchAs(None, None), statement), None, [])
                statement.cases.append(nothing)
                self._add_side(statement, nothing.body)
        elif isinstance(statement, ast.For) or (
            isinstance(statement, ast.If | ast.While) and not isinstance(statement.test, ast.Constant)
        ):
            self._add_side(statement, statement.body)
            self._add_side(statement, statement.orelse)

    def _add_side(self, statement: ast.stmt, side: list[ast.stmt]) -> None:
        number = self.numbers[statement]
        line = side[0].lineno if side else statement.lineno
        first = next((self.numbers[inner] for inner in side if inner in self.numbers), None)
        if first is None:
            first = self._own_counter(statement, side)
        self._branches.append(CountedBranch(number, first, line))

    def _own_counter(self, where: ast.stmt, side: list[ast.stmt]) -> int:
        number, self._next = self._next, self._next + 1
        side.insert(0, self._hit(where, number))
        return number

    def _calls(self, function: ast.FunctionDef) -> int:
        first = next((self.numbers[inner] for inner in function.body if inner in self.numbers), None)
        if first is not None:
            return first
        if not self._is_of_coverage:
            return -1
        number, self._next = self._next, self._next + 1
        function.body.append(self._hit(function, number))
        return number

    # ---------------------------------------------------------------- probes

    def _fill(self, statements: list[ast.stmt]) -> None:
        filled: list[ast.stmt] = []
        for statement in statements:
            number = self.numbers.get(statement)
            if number is not None and self._is_of_coverage:
                filled.append(self._hit(statement, number))
            elif number is not None and not isinstance(statement, ast.While):
                filled.append(self._step(statement, number))
            filled.append(statement)
        statements[:] = filled

    def _hit(self, where: ast.stmt, number: int) -> ast.AugAssign:
        target = _at(ast.Subscript(_name(HITS, where), _constant(number, where), _STORE), where)
        return _at(ast.AugAssign(target, _ADD, _constant(1, where)), where)

    def _step(self, where: ast.stmt, number: int) -> ast.If:
        test = _at(ast.UnaryOp(_NOT, _taking(where, number)), where)
        return _at(ast.If(test, [_at(ast.Expr(_stopping(where, number)), where)], []), where)

    def _step_expression(self, where: ast.stmt, number: int) -> ast.expr:
        return _at(ast.BoolOp(_OR, [_taking(where, number), _stopping(where, number)]), where)


def _walk(body: list[ast.stmt]) -> tuple[list[tuple[list[ast.stmt], str]], list[tuple[str, ast.FunctionDef]]]:
    """Return all lists of statements with the name of the function around them, and all functions by name."""
    lists: list[tuple[list[ast.stmt], str]] = []
    functions: list[tuple[str, ast.FunctionDef]] = []
    stack = [(body, "")]
    while stack:
        statements, name = stack.pop()
        lists.append((statements, name))
        for statement in statements:
            inner = name
            if isinstance(statement, ast.FunctionDef | ast.ClassDef):
                inner = f"{name}.{statement.name}" if name else statement.name
            if isinstance(statement, ast.FunctionDef):
                functions.append((inner, statement))
            stack += [(part, inner) for field in _BODIES if (part := getattr(statement, field, None))]
            if isinstance(statement, ast.Try):
                stack += [(handler.body, inner) for handler in statement.handlers]
            elif isinstance(statement, ast.Match):
                stack += [(case.body, inner) for case in statement.cases]
    return lists, functions


def _takes_all(pattern: ast.pattern) -> bool:
    """Return whether a pattern matches everything: behind its case Python allows none."""
    if isinstance(pattern, ast.MatchOr):
        return _takes_all(pattern.patterns[-1])
    return isinstance(pattern, ast.MatchAs) and (pattern.pattern is None or _takes_all(pattern.pattern))


def _is_counted(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.Global | ast.Nonlocal) or is_text(statement) or not statement.lineno:
        return False
    if not isinstance(statement, ast.Expr):
        return True
    value = statement.value
    if isinstance(value, ast.Constant):
        return False
    return not (isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == LINE)


def _at(node: _Node, where: ast.stmt) -> _Node:
    """Give a node the start of a statement as its place, without extent."""
    line, offset = where.lineno, where.col_offset
    for name, value in (("lineno", line), ("col_offset", offset), ("end_lineno", line), ("end_col_offset", offset)):
        setattr(node, name, value)
    return node


def _name(name: str, where: ast.stmt) -> ast.Name:
    return _at(ast.Name(name, _LOAD), where)


def _constant(value: int, where: ast.stmt) -> ast.Constant:
    return _at(ast.Constant(value), where)


def _taking(where: ast.stmt, number: int) -> ast.Call:
    entry = _at(ast.Subscript(_name(STEPS, where), _constant(number, where), _LOAD), where)
    return _at(ast.Call(entry, [], []), where)


def _stopping(where: ast.stmt, number: int) -> ast.Call:
    asking = _at(ast.Call(_name(STEP, where), [_constant(number, where)], []), where)
    return _at(ast.Call(asking, [], []), where)
