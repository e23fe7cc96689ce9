"""Lets a debugger attach to a program that runs, at next to no cost while none is attached.

A probe is `if @watched: @at(n)` before statement n: nothing is counted, and while `@watched` is empty nothing is called.
A body of a loop or function that is short and has no loop or function inside is there twice, below its checkpoint:

    if @tick():          work is paid for: the body as it is
        ...
    else:                each `@tick()` is refused while a debugger looks; rarely otherwise
        @cp()
        ...              the body with probes

So loops that only compute, which are what takes time, run without probes. Loops that pay at their start are left as
they are: while a debugger looks, payments are refused, and the loop below with its checkpoints runs.

The tree itself stays as it is: `with_switches` returns another one, which shares all nodes that it does not change.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from typing import Final

from elitescript.language.checkpoints import body_start, is_checkpoint, is_payment
from elitescript.language.hooks import AT, WATCHED

TWICE_MAX: Final = 100
"""Most statements of a body that is there twice."""

_LOAD: Final = ast.Load()
_REPEATED: Final = (ast.For, ast.While)
_INNER: Final = (*_REPEATED, ast.FunctionDef, ast.ClassDef)
_DECLARATIONS: Final = (ast.Global, ast.Nonlocal)

_Lists = list[tuple[list[ast.stmt], list[ast.stmt], bool]]


def with_switches(module: ast.Module, numbers: Mapping[ast.stmt, int]) -> ast.Module:
    """Return a module with probes.

    Args:
        module: a program that has its checkpoints.
        numbers: of the statements that get a probe.
    """
    made: list[ast.stmt] = []
    lists: _Lists = [(module.body, made, False)]
    while lists:
        body, target, is_second = lists.pop()
        for statement in body:
            if is_second and isinstance(statement, _DECLARATIONS):
                # The first copy of the body has it, which counts for the whole function.
                target.append(ast.copy_location(ast.Pass(), statement))
                continue
            number = numbers.get(statement)
            if number is not None:
                target.append(_probe(statement, number))
            target.append(_copy(statement, lists, is_second))
    return ast.Module(body=made, type_ignores=[])


def _copy(statement: ast.stmt, lists: _Lists, is_second: bool) -> ast.stmt:
    """Return a statement whose bodies are new lists, and add these to what is to be filled."""
    if is_checkpoint(statement):
        return statement
    if isinstance(statement, _REPEATED):
        body = _switched(statement.body, 0, lists, is_second)
        return _with(statement, body=body, orelse=_later(statement.orelse, lists, is_second))
    if isinstance(statement, ast.FunctionDef):
        return _with(statement, body=_switched(statement.body, body_start(statement.body), lists, is_second))
    if isinstance(statement, ast.If):
        body = statement.body if is_payment(statement) else _later(statement.body, lists, is_second)
        return _with(statement, body=body, orelse=_later(statement.orelse, lists, is_second))
    if isinstance(statement, ast.With | ast.ClassDef):
        return _with(statement, body=_later(statement.body, lists, is_second))
    if isinstance(statement, ast.Try):
        handlers = [_with(handler, body=_later(handler.body, lists, is_second)) for handler in statement.handlers]
        bodies = {name: _later(getattr(statement, name), lists, is_second) for name in ("body", "orelse", "finalbody")}
        return _with(statement, handlers=handlers, **bodies)
    if isinstance(statement, ast.Match):
        cases = [_with(case, body=_later(case.body, lists, is_second)) for case in statement.cases]
        return _with(statement, cases=cases)
    return statement


def _later(body: list[ast.stmt], lists: _Lists, is_second: bool) -> list[ast.stmt]:
    target: list[ast.stmt] = []
    lists.append((body, target, is_second))
    return target


def _switched(body: list[ast.stmt], at: int, lists: _Lists, is_second: bool) -> list[ast.stmt]:
    """Return the body of a loop or function that has its checkpoint at an index, twice if it may be."""
    rest = body[at + 1 :]
    if at >= len(body) or not is_checkpoint(body[at]) or not _may_be_twice(rest):
        return _later(body, lists, is_second)
    checkpoint = body[at]
    assert isinstance(checkpoint, ast.If)
    assert isinstance(checkpoint.test, ast.UnaryOp)
    probed: list[ast.stmt] = list(checkpoint.body)
    lists.append((rest, probed, True))
    return [*body[:at], ast.copy_location(ast.If(checkpoint.test.operand, rest, probed), checkpoint)]


def _may_be_twice(body: list[ast.stmt]) -> bool:
    """Return whether a body is short, and has no loop, function or class inside."""
    count = 0
    stack: list[ast.AST] = [*body]
    while stack:
        node = stack.pop()
        count += isinstance(node, ast.stmt)
        if isinstance(node, _INNER) or count > TWICE_MAX:
            return False
        if isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
            stack += [item for name in _BODIES for item in getattr(node, name, ())]
    return bool(body)


_BODIES: Final = ("body", "orelse", "finalbody", "handlers", "cases")


def _with(node: ast.AST, **changed: object) -> ast.AST:
    """Return a node like another one, with other fields."""
    fields = {name: getattr(node, name, None) for name in node._fields}
    return ast.copy_location(type(node)(**{**fields, **changed}), node)


def _probe(statement: ast.stmt, number: int) -> ast.If:
    """Return `if @watched: @at(number)`, at the start of a statement and without extent."""
    line, offset = statement.lineno, statement.col_offset
    place = {"lineno": line, "col_offset": offset, "end_lineno": line, "end_col_offset": offset}
    call = ast.Call(ast.Name(AT, _LOAD, **place), [ast.Constant(number, **place)], [], **place)
    return ast.If(ast.Name(WATCHED, _LOAD, **place), [ast.Expr(call, **place)], [], **place)
