"""A path of many short moves without a blend radius: the arm stops at each of its points.

Found are loops of 30 turns and more whose move goes less than 5 mm further in each turn.

    def job():
      for i in range(200):
        movel([0.4, -0.2 + 0.001 * i, 0.4, 3.14, 0, 0])             # N224: 200 stops
      end
      for i in range(200):
        movel([0.4, -0.2 + 0.001 * i, 0.4, 3.14, 0, 0], r=0.0004)   # fine
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import hypot
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.placing import loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_LEAST_TURNS: Final = 30
_LONGEST_M: Final = 0.005
_COORDINATES: Final = 3


@rule(code="N224", since="0.3", needs_values=True)
def stops_at_points(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the move of each such loop."""
    steps_of: dict[ast.stmt, dict[str, float]] = {}
    for found in program.derived(CalledCommands).of("movel"):
        loop = next(loops(program.symbols, found.call), None)
        node = found.given.get("p")
        if loop is None or node is None or not _stops(program, found):
            continue
        if loop not in steps_of:
            steps_of[loop] = _steps(program, loop, found.scope)
        steps = steps_of[loop]
        turns = _turns(program, loop, steps)
        if turns is None or turns < _LEAST_TURNS:
            continue
        way = _way(program, node, loop, steps, found.scope)
        if way is not None and 0 < way < _LONGEST_M:
            text = said(
                "the arm stops at each of {turns:g} points that are {way_mm:.3g} mm apart",
                turns=turns,
                way_mm=way * 1000,
            )
            yield Finding(found.call, text, "a blend radius, r, of less than half of the step goes through them")


def _stops(program: AnalysedProgram, found: Called) -> bool:
    node = found.given.get("r")
    return found.is_complete and (node is None or program.constants.value(node, found.scope) == 0)


def _number(program: AnalysedProgram, node: ast.expr, scope: Scope) -> float | None:
    value = program.constants.value(node, scope)
    return float(value) if isinstance(value, (int, float)) else None


def _steps(program: AnalysedProgram, loop: ast.For | ast.While, scope: Scope) -> dict[str, float]:
    """Return by how much variables, and elements as they are written, grow in each turn of a loop."""
    found: dict[str, float] = {}
    every = loop.iter if isinstance(loop, ast.For) else None
    if isinstance(every, ast.Call) and isinstance(every.func, ast.Name) and every.func.id == "range":
        step = _number(program, every.args[2], scope) if len(every.args) > 2 else 1.0
        if step is not None and isinstance(loop, ast.For):
            found[ast.unparse(loop.target)] = step
    for statement in loop.body:
        if isinstance(statement, ast.AugAssign) and isinstance(statement.op, (ast.Add, ast.Sub)):
            step = _number(program, statement.value, scope)
            name = ast.unparse(statement.target)
        elif isinstance(statement, ast.Assign) and isinstance(statement.value, ast.BinOp):
            name = ast.unparse(statement.targets[0])
            if ast.unparse(statement.value.left) != name or not isinstance(statement.value.op, (ast.Add, ast.Sub)):
                continue
            step = _number(program, statement.value.right, scope)
        else:
            continue
        if step is not None:
            found[name] = step
    return found


def _turns(program: AnalysedProgram, loop: ast.For | ast.While, steps: dict[str, float]) -> float | None:
    """Return how often a loop turns; None if that is not certain."""
    if isinstance(loop, ast.For):
        shape = program.values.of(loop.iter).shape
        return None if shape is None or shape.least != shape.most else shape.least
    test = loop.test
    if not isinstance(test, ast.Compare) or len(test.ops) != 1 or not isinstance(test.ops[0], (ast.Lt, ast.LtE)):
        return None
    step = steps.get(ast.unparse(test.left))
    last = _number(program, test.comparators[0], program.symbols.scope_of(loop))
    return None if not step or last is None else last / step


def _way(
    program: AnalysedProgram, node: ast.expr, loop: ast.For | ast.While, steps: dict[str, float], scope: Scope
) -> float | None:
    """Return how far a pose goes in each turn, m; None if that is not certain."""
    if isinstance(node, ast.List):
        parts = [_growth(program, part, steps, scope) for part in node.elts[:_COORDINATES]]
        return None if None in parts else hypot(*(part for part in parts if part is not None))
    if isinstance(node, ast.Name):
        grown = [steps.get(f"{node.id}[{index}]", 0.0) for index in range(_COORDINATES)]
        return hypot(*grown) if any(grown) else None
    return None


def _growth(program: AnalysedProgram, node: ast.expr, steps: dict[str, float], scope: Scope) -> float | None:
    """Return by how much an expression grows in each turn; None if that is not certain."""
    step = steps.get(ast.unparse(node))
    if step is not None:
        return step
    if _number(program, node, scope) is not None:
        return 0.0
    if isinstance(node, ast.BinOp):
        left, right = (_growth(program, side, steps, scope) for side in (node.left, node.right))
        if left is None or right is None:
            return None
        if isinstance(node.op, ast.Add):
            return left + right
        if isinstance(node.op, ast.Sub):
            return left - right
        factors = [_number(program, side, scope) for side in (node.left, node.right)]
        if isinstance(node.op, ast.Mult):
            if factors[0] is not None:
                return factors[0] * right
            return left * factors[1] if factors[1] is not None else None
        if isinstance(node.op, ast.Div) and factors[1]:
            return left / factors[1]
    return None
