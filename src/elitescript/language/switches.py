"""Lets a debugger attach to a program that runs, at next to no cost while none is attached.

A probe is `if @watched: @at(n)` before statement n: nothing is counted, and nothing called while `@watched` is empty.
The statements with which a body of a loop or function begins, as far as they only compute, are there twice, below its
checkpoint:

    if @tick():          work is paid for: the statements as they are
        ...
    else:                each `@tick()` is refused while a debugger looks; rarely otherwise
        @cp()
        ...              the statements with probes, and the probe of the one behind them
    ...                  the rest of the body, with probes from its second statement on

So what takes most of the time runs without probes. A thread that waits stands in no statement that only computes, so
that no probe is missed when it goes on. Loops that pay at their start are left as they are: while a debugger looks,
payments are refused, and the loop below with its checkpoints runs. A `while` has its probe before it and at the end of
each pass; a `continue` goes without.

The tree itself stays as it is: `with_switches` returns another one, which shares all nodes that it does not change.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Final, TypeVar

from elitescript.language.checkpoints import body_start, is_checkpoint, is_closed, is_payment
from elitescript.language.hooks import AT, WATCHED
from elitescript.records import NamedTuple

TWICE_MAX: Final = 100
"""Most statements of a body that are there twice."""

Node = TypeVar("Node", bound=ast.AST)
_LOAD: Final = ast.Load()
_INNER: Final = (ast.For, ast.While, ast.FunctionDef, ast.ClassDef)
_COMPOUND: Final = frozenset((*_INNER, ast.If, ast.With, ast.Try, ast.Match))
_NOWHERE: Final[dict[str, int]] = {"lineno": 1, "col_offset": 0, "end_lineno": 1, "end_col_offset": 0}
_WATCHED: Final = ast.Name(WATCHED, _LOAD, **_NOWHERE)
_AT: Final = ast.Name(AT, _LOAD, **_NOWHERE)
"""The same in all probes, as no error ever comes from there: making nodes is what takes time."""
_BODIES: Final = ("body", "orelse", "finalbody", "handlers", "cases")
_DECLARATIONS: Final = (ast.Global, ast.Nonlocal)


def with_switches(module: ast.Module, numbers: Mapping[ast.stmt, int]) -> ast.Module:
    """Return a module with probes.

    Args:
        module: a program that has its checkpoints.
        numbers: of the statements that get a probe.
    """
    return ast.Module(body=_Copier(numbers).copied(module.body), type_ignores=[])


class _Waiting(NamedTuple):
    """A body that is to be copied."""

    body: list[ast.stmt]
    target: list[ast.stmt]
    is_second: bool
    """Whether the body is there without probes, too."""
    last: ast.If | None = None
    """Probe at its end."""
    skips_first: bool = False
    """Whether the probe of its first statement stands elsewhere."""


class _Copier:
    """Copies bodies, not deeper by its own calls than one, however deep they are nested."""

    def __init__(self, numbers: Mapping[ast.stmt, int]) -> None:
        self._numbers = numbers
        self._waiting: list[_Waiting] = []

    def copied(self, body: list[ast.stmt]) -> list[ast.stmt]:
        made = self._later(body, False)
        while self._waiting:
            self._fill(self._waiting.pop())
        return made

    def _fill(self, waiting: _Waiting) -> None:
        target, is_second = waiting.target, waiting.is_second
        for statement in waiting.body:
            if is_second and isinstance(statement, _DECLARATIONS):
                # The first copy of the body has it, which counts for the whole function.
                target.append(ast.copy_location(ast.Pass(), statement))
                continue
            if not waiting.skips_first or statement is not waiting.body[0]:
                probe = self._probe(statement)
                target += [] if probe is None else [probe]
            is_compound = type(statement) in _COMPOUND
            target.append(self._copy(statement, is_second) if is_compound else statement)
        if waiting.last is not None:
            target.append(waiting.last)

    def _later(self, body: list[ast.stmt], is_second: bool, last: ast.If | None = None) -> list[ast.stmt]:
        """Return the list that the copy of a body will be in."""
        target: list[ast.stmt] = []
        self._waiting.append(_Waiting(body, target, is_second, last))
        return target

    def _probe(self, statement: ast.stmt) -> ast.If | None:
        """Return the probe of a statement; None for one that is not counted."""
        number = self._numbers.get(statement)
        return None if number is None else _probe(statement, number)

    def _copy(self, statement: ast.stmt, is_second: bool) -> ast.stmt:
        """Return a statement whose bodies are copies."""

        def copied(name: str, owner: ast.AST = statement) -> list[ast.stmt]:
            return self._later(getattr(owner, name), is_second)

        if is_checkpoint(statement):
            return statement
        match statement:
            case ast.While() | ast.For():
                last = self._probe(statement) if isinstance(statement, ast.While) else None
                return _with(statement, body=self._switched(statement.body, 0, last), orelse=copied("orelse"))
            case ast.FunctionDef():
                return _with(statement, body=self._switched(statement.body, body_start(statement.body)))
            case ast.If():
                body = statement.body if is_payment(statement) else copied("body")
                return _with(statement, body=body, orelse=copied("orelse"))
            case ast.With() | ast.ClassDef():
                return _with(statement, body=copied("body"))
            case ast.Try():
                handlers = [_with(handler, body=copied("body", handler)) for handler in statement.handlers]
                bodies = {name: copied(name) for name in ("body", "orelse", "finalbody")}
                return _with(statement, handlers=handlers, **bodies)
            case ast.Match():
                return _with(statement, cases=[_with(case, body=copied("body", case)) for case in statement.cases])
        return statement

    def _switched(self, body: list[ast.stmt], at: int, last: ast.If | None = None) -> list[ast.stmt]:
        """Return the body of a loop or function that has its checkpoint at an index; its begin is there twice."""
        if at >= len(body) or not is_checkpoint(body[at]):
            return self._later(body, False, last)
        checkpoint, begin = body[at], _computing(body[at + 1 :])
        rest = body[at + 1 + len(begin) :]
        assert isinstance(checkpoint, ast.If)
        assert isinstance(checkpoint.test, ast.UnaryOp)
        probed = [*checkpoint.body]
        switch = ast.If(checkpoint.test.operand, begin or [ast.copy_location(ast.Pass(), checkpoint)], probed)
        made = [*body[:at], ast.copy_location(switch, checkpoint)]
        if rest:
            self._waiting.append(_Waiting(begin, probed, True, self._probe(rest[0])))
            self._waiting.append(_Waiting(rest, made, False, last, skips_first=True))
        else:
            self._waiting.append(_Waiting(begin, probed, True, last))
        return made


def _computing(body: list[ast.stmt]) -> list[ast.stmt]:
    """Return the statements with which a body begins that only compute and have no loop, function or class inside."""
    count = 0
    for index, statement in enumerate(body):
        stack: list[ast.AST] = [statement]
        while stack:
            node = stack.pop()
            count += isinstance(node, ast.stmt)
            if isinstance(node, _INNER) or count > TWICE_MAX:
                return body[:index]
            if isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
                stack += [item for name in _BODIES for item in getattr(node, name, ())]
        if not is_closed(statement):
            return body[:index]
    return body


def _with(node: Node, **changed: object) -> Node:
    """Return a node like another one, with other fields."""
    fields = {name: getattr(node, name, None) for name in node._fields}
    return ast.copy_location(type(node)(**{**fields, **changed}), node)


def _probe(statement: ast.stmt, number: int) -> ast.If:
    """Return `if @watched: @at(number)`, at the start of a statement and without extent."""
    line, offset = statement.lineno, statement.col_offset
    place: dict[str, int] = {"lineno": line, "col_offset": offset, "end_lineno": line, "end_col_offset": offset}
    argument = ast.Constant(value=number, **place)  # type: ignore[arg-type]
    return ast.If(_WATCHED, [ast.Expr(ast.Call(_AT, [argument], [], **place), **place)], [], **place)
