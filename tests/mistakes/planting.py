"""Plants one mistake into a sound program: where it can stand, and the text that has it."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import Final, TypeVar

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.quantities import Quantity
from elitescript.commands.definition.registry import Command, Param
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.lint.arguments import arrange

COMMANDS: Final = {command.name: command for command in CATALOGUE}

_Node = TypeVar("_Node", bound=ast.AST)


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of a text that is one mistake.

    Attributes:
        at: the expression or statement that is replaced.
        new: the text that takes its place.
        names: names that the mistake is about, beside those that the statement binds: a report that names one of them,
            or stands in a line with one of them, is about the mistake.
        and_at: further places and their texts, if one mistake changes several.
    """

    at: ast.AST
    new: str
    names: frozenset[str] = frozenset()
    and_at: tuple[tuple[ast.AST, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Mistake:
    """One planted mistake.

    Attributes:
        kind: name of its kind.
        program: name of the program.
        text: the program with the mistake.
        lines: lines of the statement, of several if the mistake changes several.
        names: see `Edit`.
        was, now: what stood there, and what stands there.
    """

    kind: str
    program: str
    text: str
    lines: frozenset[int]
    names: frozenset[str]
    was: str
    now: str


class Program:
    """The text of a sound program, taken apart.

    Args:
        name: for reports.
        text: the text.
        lines: lines that its run has passed; mistakes are planted nowhere else. None for all.
    """

    def __init__(self, name: str, text: str, lines: frozenset[int] | None = None) -> None:
        self.name = name
        self.text = text
        self.lines = lines
        self.tree = parse(SourceFile(name, text)).tree
        self._starts = [0]
        for line in text.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        self.parents = {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}

    # ------------------------------------------------------------ places

    def span(self, node: ast.AST) -> tuple[int, int]:
        """Return begin and end of a node in the text."""
        assert isinstance(node, ast.expr | ast.stmt | ast.ExceptHandler | ast.keyword | ast.arg)
        assert node.end_lineno is not None and node.end_col_offset is not None
        return (
            self._starts[node.lineno - 1] + node.col_offset,
            self._starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def source(self, node: ast.AST) -> str:
        """Return the text of a node."""
        begin, end = self.span(node)
        return self.text[begin:end]

    def statement(self, node: ast.AST) -> ast.stmt:
        """Return the statement in which a node stands."""
        while not isinstance(node, ast.stmt):
            node = self.parents[node]
        return node

    def function(self, node: ast.AST) -> ast.FunctionDef | None:
        """Return the function in which a node stands."""
        while node in self.parents:
            node = self.parents[node]
            if isinstance(node, ast.FunctionDef):
                return node
        return None

    def head(self, statement: ast.stmt) -> frozenset[int]:
        """Return the lines of a statement, of one that holds others those of its first line."""
        last = statement.end_lineno or statement.lineno
        body = getattr(statement, "body", None)
        if body:
            last = max(statement.lineno, body[0].lineno - 1)
            test = getattr(statement, "test", getattr(statement, "iter", None))
            last = min(last, getattr(test, "end_lineno", statement.lineno))
        return frozenset(range(statement.lineno, last + 1))

    def is_run(self, node: ast.AST) -> bool:
        """Whether the run has passed the statement of a node."""
        return self.lines is None or self.statement(node).lineno in self.lines

    # ------------------------------------------------------------ what is there

    def every(self, kind: type[_Node]) -> Iterator[_Node]:
        """Yield the nodes of a kind whose statements were run, in the order of the text."""
        for node in self._nodes:
            if isinstance(node, kind) and self.is_run(node):
                yield node

    @cached_property
    def _nodes(self) -> list[ast.AST]:
        # What is put in by the parser has no text of its own.
        placed = [node for node in ast.walk(self.tree) if getattr(node, "end_lineno", None) and node.lineno > 0]  # type: ignore[attr-defined]
        return sorted(placed, key=lambda node: (node.lineno, node.col_offset))  # type: ignore[attr-defined]

    @cached_property
    def functions(self) -> dict[str, ast.FunctionDef]:
        """Functions by name, without the program itself."""
        found = [node for node in self._nodes if isinstance(node, ast.FunctionDef) and self.function(node) is not None]
        return {node.name: node for node in found}

    @cached_property
    def bound(self) -> frozenset[str]:
        """Names that the program gives a value."""
        names = {node.id for node in self._nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        return frozenset(names | {node.arg for node in self._nodes if isinstance(node, ast.arg)} | set(self.functions))

    @cached_property
    def calls(self) -> list[tuple[Command, ast.Call, dict[str, tuple[Param, ast.expr]]]]:
        """Calls of commands with their arguments by parameter."""
        found = []
        for node in self.every(ast.Call):
            if isinstance(node.func, ast.Name) and node.func.id in COMMANDS and node.func.id not in self.bound:
                command = COMMANDS[node.func.id]
                given = arrange(command, node, {}).given
                found.append((command, node, {param.name: (param, value) for param, value in given}))
        return found

    def arguments(self, wanted: Callable[[Quantity], bool]) -> Iterator[tuple[Command, ast.Call, Param, ast.expr]]:
        """Yield the arguments whose quantity is a wanted one."""
        for command, call, given in self.calls:
            for param, value in given.values():
                if wanted(param.quantity):
                    yield command, call, param, value

    def literal(self, value: ast.expr) -> ast.expr | None:
        """Return what a value is written as: itself, or what the only assignment of its name gives it."""
        if not isinstance(value, ast.Name):
            return value
        given = [node for node in self._nodes if isinstance(node, ast.Assign) and _is_target(node, value.id)]
        others = [node for node in self._nodes if isinstance(node, ast.Name) and node.id == value.id]
        stored = [node for node in others if isinstance(node.ctx, ast.Store)]
        params = [node for node in self._nodes if isinstance(node, ast.arg) and node.arg == value.id]
        if len(given) == len(stored) == 1 and not params and self.is_run(given[0]):
            return given[0].value
        return None

    def names_of(self, node: ast.AST) -> frozenset[str]:
        """Return the names to which a value goes from where it stands: those that its statement binds, parameters of
        the called function, the function that returns it.
        """
        names: set[str] = set()
        inner = node
        while not isinstance(inner, ast.stmt):
            outer = self.parents[inner]
            if isinstance(outer, ast.Call) and isinstance(outer.func, ast.Name) and outer.func.id in self.functions:
                names.update(_parameters(self.functions[outer.func.id], outer, inner))
            inner = outer
        names.update(_targets(inner))
        if isinstance(inner, ast.Return) and (function := self.function(inner)) is not None:
            names.add(function.name)
        return frozenset(names)

    def _loop_around(self, node: ast.AST) -> frozenset[int]:
        outer = self.parents[self.statement(node)]
        return self.head(outer) if isinstance(outer, ast.While | ast.For) else frozenset()

    # ------------------------------------------------------------ planting

    def planted(self, kind: str, edit: Edit) -> Mistake | None:
        """Return a mistake; None if it changes nothing that is read: the trees are the same."""
        places = sorted([(edit.at, edit.new), *edit.and_at], key=lambda place: self.span(place[0]), reverse=True)
        text = self.text
        for node, new in places:
            begin, end = self.span(node)
            text = text[:begin] + new + text[end:]
        if text == self.text or _is_same(text, self):
            return None
        lines: set[int] = set()
        names = set(edit.names)
        for node, new in places:
            lines |= self.head(self.statement(node))
            if new == "pass":
                # What is missing is missing in the loop around it.
                lines |= self._loop_around(node)
            if "\n" in new:
                lines |= set(range(max(lines), max(lines) + new.count("\n") + 1))
            names |= self.names_of(node)
        was = " ".join(self.source(edit.at).split())
        now = " ".join(edit.new.split())
        return Mistake(kind, self.name, text, frozenset(lines), frozenset(names), was, now)


def _is_same(text: str, program: Program) -> bool:
    parsed = parse(SourceFile(program.name, text))
    return not parsed.has_errors and ast.dump(parsed.tree) == ast.dump(program.tree)


def _is_target(statement: ast.Assign, name: str) -> bool:
    return any(isinstance(target, ast.Name) and target.id == name for target in statement.targets)


def _targets(statement: ast.stmt) -> set[str]:
    """Return the names that a statement gives a value, those of changed lists too."""
    places: list[ast.expr] = []
    if isinstance(statement, ast.Assign):
        places = statement.targets
    elif isinstance(statement, ast.AugAssign | ast.AnnAssign | ast.For):
        places = [statement.target]
    found = {node.id for place in places for node in ast.walk(place) if isinstance(node, ast.Name)}
    if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call):
        method = statement.value.func
        if isinstance(method, ast.Attribute) and isinstance(method.value, ast.Name):
            found.add(method.value.id)
    return found


def _parameters(function: ast.FunctionDef, call: ast.Call, inner: ast.AST) -> list[str]:
    """Return the parameter that gets an argument."""
    named = [keyword.arg for keyword in call.keywords if inner in (keyword, keyword.value) and keyword.arg]
    args = function.args.args
    return named + [args[at].arg for at, value in enumerate(call.args) if value is inner and at < len(args)]


# ---------------------------------------------------------------- kinds


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of mistake.

    Attributes:
        name: what is wrong, in a few words.
        group: heading of the table.
        places: yields the changes that plant it in a program.
    """

    name: str
    group: str
    places: Callable[[Program], Iterator[Edit]]


KINDS: Final[list[Kind]] = []
"""In the order of the table; filled by `kinds`."""


def kind(group: str, name: str) -> Callable[[Callable[[Program], Iterator[Edit]]], Callable[[Program], Iterator[Edit]]]:
    """Register a kind of mistakes."""

    def register(places: Callable[[Program], Iterator[Edit]]) -> Callable[[Program], Iterator[Edit]]:
        KINDS.append(Kind(name, group, places))
        return places

    return register


def plant(programs: list[Program], count: int, seed: int) -> tuple[list[Mistake], int]:
    """Return planted mistakes of all kinds in turn, no two alike, and how many changes were left out because the
    program is the same to the language.
    """
    queues: list[list[tuple[Program, Edit]]] = []
    for row in KINDS:
        found = [(program, edit) for program in programs for edit in row.places(program)]
        Random(f"{seed}: {row.name}").shuffle(found)
        queues.append(found)
    mistakes: list[Mistake] = []
    texts: set[str] = set()
    same = 0
    while len(mistakes) < count and any(queues):
        for row, queue in zip(KINDS, queues, strict=True):
            while queue and len(mistakes) < count:
                program, edit = queue.pop()
                mistake = program.planted(row.name, edit)
                if mistake is None:
                    same += 1
                elif mistake.text not in texts:
                    texts.add(mistake.text)
                    mistakes.append(mistake)
                    break
    return mistakes, same


def misspelt(name: str) -> str:
    """Return a name with two letters in each other's place, or with one left out."""
    for at in range(1, len(name) - 1):
        if name[at] != name[at + 1] and name[at].isalpha() and name[at + 1].isalpha():
            return name[:at] + name[at + 1] + name[at] + name[at + 2 :]
    return name + name[-1] if name else name


NUMBER: Final = re.compile(r"-?\d")
