"""Inserts checkpoints, at which a running script can be paused, stopped and counted.

A checkpoint is the expression `@tick() or @cp()`. It stands at the start of every loop body, at
the entry of every function, in every comprehension and lambda, so that no code of a script runs
for long without one. Each costs one call of a built-in function.

Every `try` with handlers gets a first handler that lets a stop pass, so that `except:` cannot
swallow it.
"""

from __future__ import annotations

import ast

from elitescript.language.hooks import CHECKPOINT, STOP, TICK
from elitescript.language.kinds import is_text
from elitescript.language.nodes import Census

_LOAD = ast.Load()
_OR = ast.Or()
_AND = ast.And()
_NOT = ast.Not()


def insert_checkpoints(census: Census) -> None:
    """Insert checkpoints and stop handlers into the tree. New nodes get the line of what they guard.

    Raises:
        ValueError: the tree holds nodes of unknown kinds, which might be loops.
    """
    if census.unknown:
        raise ValueError(f"unknown kind of node: {type(census.unknown[0]).__name__}")
    for loop in census.of(ast.For):
        loop.body.insert(0, _statement(loop))
    for repetition in census.of(ast.While):
        repetition.body.insert(0, _statement(repetition))
    for function in census.of(ast.FunctionDef):
        function.body.insert(body_start(function.body), _statement(function))
    for anonymous in census.of(ast.Lambda):
        value = anonymous.body
        anonymous.body = ast.copy_location(ast.BoolOp(_AND, [_expression(value), value]), value)
    for generator in census.of(ast.comprehension):
        generator.ifs.insert(0, _expression(generator.iter))
    for statement in census.of(ast.Try):
        if statement.handlers:
            statement.handlers.insert(0, _stop_handler(statement))


def body_start(body: list[ast.stmt]) -> int:
    """Return the index of the first statement behind the docstring of a function."""
    return 1 if is_text(body[0]) else 0


def is_checkpoint(statement: ast.stmt) -> bool:
    """Return whether a statement was put in by `insert_checkpoints`."""
    if not isinstance(statement, ast.If) or not isinstance(statement.test, ast.UnaryOp):
        return False
    call = statement.test.operand
    return isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == TICK


def _call(name: str, where: ast.expr | ast.stmt) -> ast.Call:
    """Return a call of a hook, at the start of `where` and without extent."""
    line, offset = where.lineno, where.col_offset
    function = ast.Name(name, _LOAD, lineno=line, col_offset=offset, end_lineno=line, end_col_offset=offset)
    return ast.Call(function, [], [], lineno=line, col_offset=offset, end_lineno=line, end_col_offset=offset)


def _statement(where: ast.stmt) -> ast.If:
    # The same as the expression as a statement, but without a value to throw away.
    tick = _call(TICK, where)
    test = ast.copy_location(ast.UnaryOp(_NOT, tick), tick)
    body = ast.copy_location(ast.Expr(_call(CHECKPOINT, where)), tick)
    return ast.copy_location(ast.If(test, [body], []), tick)


def _expression(where: ast.expr) -> ast.BoolOp:
    tick = _call(TICK, where)
    return ast.copy_location(ast.BoolOp(_OR, [tick, _call(CHECKPOINT, where)]), tick)


def _stop_handler(statement: ast.Try) -> ast.ExceptHandler:
    name = _call(STOP, statement).func
    raising = ast.copy_location(ast.Raise(None, None), name)
    return ast.copy_location(ast.ExceptHandler(name, None, [raising]), name)
