"""A loop that waits for a variable that nothing changes: no statement in it, no function, no other thread.

An input that was read once, in front of the loop, keeps that value. A loop whose condition is certainly false is a part
that is switched off, and one with the plain condition `running` may be meant to have no end: both are left alone. A
limit beside another condition that nothing counts towards is found too, and a number that is counted in steps such as
0.1, which no computer holds exactly, and waited for with `!=`.

    def job():
      go = get_standard_digital_in(0)
      while not go:                               # W259: nothing in the loop reads the input again
        sleep(0.1)
      end
      while not get_standard_digital_in(0):       # fine
        sleep(0.1)
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said
from elitescript.values.description import NUMBER, OUTSIDE, SCALAR, Value
from elitescript.values.operators import truth

_FOREIGN: Final = frozenset(("exec", "eval", "interpreter_mode"))
_PLAIN: Final = (
    *(ast.Name, ast.Constant, ast.Compare, ast.BoolOp, ast.UnaryOp, ast.BinOp, ast.expr_context),
    *(ast.cmpop, ast.boolop, ast.unaryop, ast.operator),
)
_LIMITS: Final = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
_LEAVING: Final = (ast.Break, ast.Return, ast.Raise, ast.Yield, ast.Assert)
_WAITING: Final = frozenset(("sleep", "sync", "textmsg", "get_steptime", "print", "str"))
"""What a loop calls that only waits."""


@rule(code="W259", since="0.3", instead_of=("W204",), needs_all_lines=True, needs_values=True)
def endless_wait(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such loop."""
    if any(name in scope.reads for scope in program.symbols.scopes for name in _FOREIGN):
        return
    for loop in program.nodes(ast.While):
        yield from _forgotten_counts(program, loop)
        yield from _missed_numbers(program, loop)
        names = _names(loop.test)
        if (
            not names
            or truth(program.values.of(loop.test)) is False
            or not all(_stays(program, name, loop) for name in names)
        ):
            continue
        values = [program.values.of(name) for name in names]
        is_outside = any(value.must & OUTSIDE for value in values)
        if not is_outside and (isinstance(loop.test, ast.Name) or not _only_waits(loop)):
            continue
        if not _leaves(program, loop):
            yield _told(program, loop, names, values)


def _forgotten_counts(program: AnalysedProgram, loop: ast.While) -> Iterator[Finding]:
    """Report the limit beside another condition that nothing counts towards: `get_flag(0) and waited < 2`."""
    if not isinstance(loop.test, ast.BoolOp) or not isinstance(loop.test.op, ast.And):
        return
    for part in loop.test.values:
        is_limit = (
            isinstance(part, ast.Compare) and isinstance(part.left, ast.Name) and isinstance(part.ops[0], _LIMITS)
        )
        if not is_limit or not isinstance(part, ast.Compare) or not isinstance(part.left, ast.Name):
            continue
        names = _names(part)
        value = program.values.of(part.left)
        is_start = value.has_constant and not value.kinds & ~NUMBER and not part.left.id.isupper()
        is_asked = any(isinstance(node, ast.Call) for other in loop.test.values for node in ast.walk(other))
        if names and is_start and is_asked and _stays(program, part.left, loop):
            text = said(
                "nothing changes `{name}` in this loop: {condition} stays as it is",
                name=part.left.id,
                condition=shown_source(program, part),
            )
            yield Finding(part, text, said("count it in the loop: {name} = {name} + ...", name=part.left.id))


_TURNS_MAX: Final = 10_000
"""Turns of a loop that are counted through."""
_NEAR: Final = 1e-6


def _missed_numbers(program: AnalysedProgram, loop: ast.While) -> Iterator[Finding]:
    """Report `while x != 1.0` where x goes past the number in steps that are not exact."""
    test = loop.test
    if (
        not isinstance(test, ast.Compare)
        or not isinstance(test.left, ast.Name)
        or not isinstance(test.ops[0], ast.NotEq)
    ):
        return
    name, symbols = test.left, program.symbols
    home = symbols.scope_of(name).home(name.id)
    bindings = [] if home is None else home.bindings[name.id]
    goal = program.values.of(test.comparators[0])
    if len(test.ops) != 1 or len(bindings) != 2 or not goal.has_constant or goal.kinds & ~NUMBER:
        return
    start, step = _start(program, bindings[0].node), _step(program, bindings[1].node, loop)
    if start is None or step is None or not step:
        return
    number, limit = start, goal.constant
    for _ in range(_TURNS_MAX):
        if number == limit:
            return
        if abs(number - limit) < _NEAR:
            text = said(
                "`{name}` comes to {number}, and never exactly to {goal}", name=name.id, number=repr(number), goal=limit
            )
            sign = "<" if step > 0 else ">"
            hint = said(
                "ask for less, with half a step of room: while {name} {sign} {goal}",
                name=name.id,
                sign=sign,
                goal=repr(limit - step / 2),
            )
            yield Finding(test, text, hint)
            return
        number += step


def _start(program: AnalysedProgram, node: ast.AST) -> float | None:
    """Return the number that an assignment gives a variable; None if it is none."""
    above = program.symbols.parent(node)
    if not isinstance(above, ast.Assign) or above.targets != [node]:
        return None
    value = program.values.of(above.value)
    return float(value.constant) if value.has_constant and not value.kinds & ~NUMBER else None


def _step(program: AnalysedProgram, node: ast.AST, loop: ast.While) -> float | None:
    """Return what each turn of a loop adds to a variable, if it does nothing else with it."""
    above = program.symbols.parent(node)
    if above not in loop.body or not isinstance(node, ast.Name):
        return None
    if isinstance(above, ast.AugAssign):
        op, part = above.op, above.value
    elif isinstance(above, ast.Assign) and isinstance(above.value, ast.BinOp):
        op, part = above.value.op, above.value.right
        if not isinstance(above.value.left, ast.Name) or above.value.left.id != node.id:
            return None
    else:
        return None
    value = program.values.of(part)
    if not isinstance(op, (ast.Add, ast.Sub)) or not value.has_constant or value.kinds & ~NUMBER:
        return None
    return float(value.constant) if isinstance(op, ast.Add) else -float(value.constant)


def _told(program: AnalysedProgram, loop: ast.While, names: list[ast.Name], values: list[Value]) -> Finding:
    listed = " and ".join(dict.fromkeys(f"`{name.id}`" for name in names))
    text = said(
        "nothing changes {listed} while this loop waits: {expression} stays as it is",
        listed=listed,
        expression=shown_source(program, loop.test),
    )
    hint = "give it a new value in the loop, or in a thread"
    if any(value.must & OUTSIDE for value in values):
        hint = "read it again in each turn of the loop"
    return Finding(program.header_span(loop), text, hint)


def _names(test: ast.expr) -> list[ast.Name]:
    """Return the names in a condition of plain variables; none if anything else is in it."""
    nodes = list(ast.walk(test))
    if not all(isinstance(node, _PLAIN) for node in nodes):
        return []
    return [node for node in nodes if isinstance(node, ast.Name)]


def _stays(program: AnalysedProgram, node: ast.Name, loop: ast.While) -> bool:
    """Return whether a variable keeps its value in a loop, whatever else runs."""
    symbols = program.symbols
    scope = symbols.scope_of(node)
    home = scope.home(node.id)
    value = program.values.of(node)
    is_given = node.id in scope.parameters and not value.must & OUTSIDE
    if home is None or home is not scope or value.kinds & ~SCALAR or is_given:
        return False
    if symbols.is_nonlocal_inside(node.id, home) or node.id in program.presets:
        return False
    # A function that assigns a variable of its own instead is told by another rule.
    if any(inner is not home and _is_inside(inner, home) for inner in symbols.owners(node.id)):
        return False
    last = loop.end_lineno or loop.lineno
    return not any(loop.lineno <= binding.line <= last for binding in home.bindings[node.id])


def _is_inside(scope: Scope | None, outer: Scope) -> bool:
    while scope is not None and scope is not outer:
        scope = scope.parent
    return scope is outer


def _only_waits(loop: ast.While) -> bool:
    calls = [node for statement in loop.body for node in ast.walk(statement) if isinstance(node, ast.Call)]
    return all(isinstance(call.func, ast.Name) and call.func.id in _WAITING for call in calls)


def _leaves(program: AnalysedProgram, loop: ast.While) -> bool:
    """Return whether anything but its condition may end a loop."""
    for statement in loop.body:
        for node in ast.walk(statement):
            if isinstance(node, _LEAVING):
                return True
            if isinstance(node, ast.Call):
                if not isinstance(node.func, ast.Name):
                    return True
                if program.symbols.scope_of(node).resolve(node.func.id) is not Resolution.BUILTIN:
                    return True
                if node.func.id in ("halt", "exit", "quit"):
                    return True
    return program.is_tried(loop)
