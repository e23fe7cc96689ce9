"""Inserts checkpoints, at which a running script can be paused, stopped and counted.

A checkpoint is the expression `@tick() or @cp()`. It stands at the start of every loop body, at
the entry of every function, in every comprehension and lambda, so that no code of a script runs
for long without one. Each costs one call of a built-in function.

A short loop (`for`, or a list that one makes) over `range` of a small number, with a body that only computes, is there
twice: `if range is @range and @pay(n)` it runs without checkpoints, having used up its n units of work at once; else
with one in each pass. Nothing in such a body uses up work, so every other checkpoint finds the same count either way.
No loop of a text that has `try`, `with` or a class is taken for short: a program could go on after a loop that has paid
for passes that it did not make, and operators of its own have checkpoints, which would come behind the payment. So it
is with names of known functions that a text binds. What a later text brings (a class, another `max`), or a generator
that such a body runs through, can shift the count by less than what was paid, never without end.

A function that calls nothing keeps its checkpoint. Its operators may run methods of the program, also of a class that
comes with a later text, so that a recursion may lead through it; and the unit of work of a call has to be counted.

A `while` loop in which the program waits stands behind a mark; see `waiting_loops`.

Every `try` with handlers gets a first handler that lets a stop pass, so that `except:` cannot
swallow it.
"""

from __future__ import annotations

import ast
from typing import Any, Final

from elitescript.language.hooks import CHECKPOINT, LOOP, PAY, RANGE, STOP, TICK
from elitescript.language.kinds import is_text
from elitescript.language.nodes import Census
from elitescript.language.probes import is_probe

PAID_MAX: Final = 100
"""Most units of work that a loop pays at its start; so many passes, with those of loops in it, have no checkpoint."""
_PAID_MIN: Final = 8
"""Fewer cost no more than paying them at once."""
_COMPUTING: Final = frozenset(["abs", "float", "int", "len", "max", "min", "round", "str"])
"""Functions that the body of a short loop may call: they take no time and use up no work."""
_COUNTING_EACH: Final = (ast.Try, ast.With, ast.ClassDef)
"""A text with one of these may go on after an exception, or have operators of its own."""
_OPEN: Final = (
    *(ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.Yield, ast.YieldFrom),
    *(ast.Await, ast.Starred),
)
"""Expressions that have checkpoints of their own, or that leave the loop."""

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
    replaced: dict[ast.AST, ast.AST] = {**_prepaid(census)}
    if census.of(ast.While):
        # Imported late: many programs have none.
        from elitescript.language.waiting_loops import waiting_loops

        replaced.update((loop, _marked(loop)) for loop in waiting_loops(census))
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
    if replaced:
        census.replace(replaced)


def body_start(body: list[ast.stmt]) -> int:
    """Return the index of the first statement behind the docstring of a function."""
    return 1 if is_text(body[0]) else 0


def is_checkpoint(statement: ast.stmt) -> bool:
    """Return whether a statement was put in by `insert_checkpoints`."""
    if not isinstance(statement, ast.If) or not isinstance(statement.test, ast.UnaryOp):
        return False
    call = statement.test.operand
    return isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == TICK


def is_payment(statement: ast.stmt) -> bool:
    """Return whether a statement stands for a short loop: paid for at its start, or else with a checkpoint a pass."""
    if not isinstance(statement, ast.If) or not isinstance(statement.test, ast.BoolOp):
        return False
    paying = statement.test.values[-1]
    return isinstance(paying, ast.Call) and isinstance(paying.func, ast.Name) and paying.func.id == PAY


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


def _marked(loop: ast.While) -> ast.If:
    """Return a loop behind its mark, `if @loop(("@loop", line)):`, which is always true.

    No other constant is like that of a mark, so two programs whose lines alone differ have equal code but for marks.
    """
    mark = _call(LOOP, loop)
    constant: Any = (LOOP, loop.lineno)
    mark.args.append(ast.copy_location(ast.Constant(constant), mark))
    return ast.copy_location(ast.If(mark, [loop], []), mark)


def _expression(where: ast.expr) -> ast.BoolOp:
    tick = _call(TICK, where)
    return ast.copy_location(ast.BoolOp(_OR, [tick, _call(CHECKPOINT, where)]), tick)


def _stop_handler(statement: ast.Try) -> ast.ExceptHandler:
    name = _call(STOP, statement).func
    raising = ast.copy_location(ast.Raise(None, None), name)
    return ast.copy_location(ast.ExceptHandler(name, None, [raising]), name)


# Short loops


def _prepaid(census: Census) -> dict[ast.AST, ast.If | ast.IfExp]:
    """Return what stands for short loops and lists; called before these have checkpoints."""
    if any(map(census.of, _COUNTING_EACH)):
        return {}
    units = {loop: count for loop in census.of(ast.For) if (count := _units(loop))}
    inner = {statement for loop in units for statement in loop.body}
    found: dict[ast.AST, ast.If | ast.IfExp] = {}
    for loop, count in units.items():
        if loop not in inner and count >= _PAID_MIN:
            found[loop] = ast.copy_location(ast.If(_payment(loop.iter, count), [_bare(loop)], [loop]), loop)
    for made in census.of(ast.ListComp):
        generator = made.generators[0]
        count = _passes(generator.target, generator.iter)
        if len(made.generators) == 1 and count >= _PAID_MIN and all(map(is_closed, (made.elt, *generator.ifs))):
            alike = ast.comprehension(generator.target, generator.iter, list(generator.ifs), 0)
            bare = ast.copy_location(ast.ListComp(made.elt, [alike]), made)
            found[made] = ast.copy_location(ast.IfExp(_payment(generator.iter, count), bare, made), made)
    return {} if found and _binds_a_known_function(census) else found


def _binds_a_known_function(census: Census) -> bool:
    """Return whether a text gives something else the name of a function that short loops call."""
    return (
        any(function.name in _COMPUTING for function in census.of(ast.FunctionDef))
        or any(name.id in _COMPUTING for name in census.of(ast.Name) if isinstance(name.ctx, ast.Store))
        or any(parameter.arg in _COMPUTING for parameter in census.of(ast.arg))
        or any((alias.asname or alias.name) in _COMPUTING for alias in census.of(ast.alias))
    )


def _passes(target: ast.expr, values: ast.expr) -> int:
    """Return how many passes `for target in values` makes; 0 if that is not a small number in the text."""
    if not isinstance(values, ast.Call) or not isinstance(values.func, ast.Name) or values.func.id != "range":
        return 0
    if len(values.args) != 1 or values.keywords or not isinstance(target, ast.Name):
        return 0
    limit = values.args[0]
    if not isinstance(limit, ast.Constant) or type(limit.value) is not int:
        return 0
    return limit.value if 0 < limit.value <= PAID_MAX else 0


def _units(loop: ast.For) -> int:
    """Return how many passes a loop makes, with those of the loops in it; 0 for one that is not short."""
    count = _passes(loop.target, loop.iter) if all(map(is_probe, loop.orelse)) else 0
    if not count:
        return 0
    inner = 0
    for statement in loop.body:
        if isinstance(statement, ast.For):
            passes = _units(statement)
            if not passes:
                return 0
            inner += passes
        elif not _only_computes(statement):
            return 0
    units = count * (1 + inner)
    return units if units <= PAID_MAX else 0


def _only_computes(statement: ast.stmt) -> bool:
    """Return whether a statement goes on to the next one, takes no time and uses up no work."""
    if is_probe(statement):
        return True
    if isinstance(statement, ast.If):
        return is_closed(statement.test) and all(map(_only_computes, (*statement.body, *statement.orelse)))
    return isinstance(statement, ast.Assign | ast.AugAssign | ast.Expr | ast.Pass) and is_closed(statement)


def is_closed(node: ast.AST) -> bool:
    """Return whether nothing in a node has a checkpoint of its own, or calls what may take time or use up work."""
    for part in ast.walk(node):
        if isinstance(part, _OPEN) or (isinstance(part, ast.Call) and not _calls_a_known_function(part)):
            return False
    return True


def _calls_a_known_function(call: ast.Call) -> bool:
    function = call.func
    if call.keywords:
        # Such as `key`, a function of the program.
        return False
    if isinstance(function, ast.Attribute):
        return function.attr == "append"
    return isinstance(function, ast.Name) and function.id in _COMPUTING


def _payment(values: ast.expr, count: int) -> ast.BoolOp:
    """Return `range is @range and @pay(count)`, at the place of `range`."""
    assert isinstance(values, ast.Call)
    paying = _call(PAY, values)
    paying.args.append(ast.copy_location(ast.Constant(count), paying))
    built_in = ast.copy_location(ast.Name(RANGE, _LOAD), values.func)
    is_built_in = ast.copy_location(ast.Compare(values.func, [ast.Is()], [built_in]), values.func)
    return ast.copy_location(ast.BoolOp(_AND, [is_built_in, paying]), values.func)


def _bare(loop: ast.For) -> ast.For:
    """Return a loop that stays without checkpoints; it shares its statements with the first one."""
    body = [_bare(statement) if isinstance(statement, ast.For) else statement for statement in loop.body]
    return ast.copy_location(ast.For(loop.target, loop.iter, body, loop.orelse), loop)
