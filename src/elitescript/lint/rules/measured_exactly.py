"""Measured values compared exactly.

A sensor never gives exactly the number that was planned. The simulated arm is exact unless its plant has a lag or
noise, so such a comparison works here, and waits for ever on an arm.

    def job():
      home = [0, -1.57, 1.57, -1.57, -1.57, 0]
      movej(home)
      while get_actual_joint_positions() != home: # W242: norm of the differences < 0.001
        sync()
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.values.description import FLOAT, MEASURED, NUMBER, ROW, Value


@rule(code="W242", since="0.3")
def measured_exactly(program: AnalysedProgram) -> Iterator[Finding]:
    """Report `==` and `!=` with a measured value."""
    for node in program.nodes(ast.Compare):
        if len(node.ops) != 1 or not isinstance(node.ops[0], (ast.Eq, ast.NotEq)):
            continue
        sides = (node.left, node.comparators[0])
        values = [program.values.of(side) for side in sides]
        measured = [_is_measured(value) for value in values]
        if any(measured) and not all(measured) and all(map(_has_numbers, values)):
            side = sides[measured.index(True)]
            text = f"{shown_source(program, side)} is measured, and never exactly equal to a planned value on an arm"
            yield Finding(node, text, _advice(values[0], side))


def _is_measured(value: Value) -> bool:
    return bool(value.must & MEASURED) and (value.kinds == FLOAT or not value.kinds & ~ROW)


def _has_numbers(value: Value) -> bool:
    return value.is_known and (not value.kinds & ~NUMBER or not value.kinds & ~ROW)


def _advice(value: Value, side: ast.expr) -> str:
    if value.kinds & NUMBER:
        return "ask whether the difference is small: abs(a - b) < 0.001"
    if value.role == "pose":
        return "ask whether the distance is small: point_dist(a, b) < 0.001"
    return "ask whether each difference is small: all(abs(x - y) < 0.001 for x, y in zip(a, b))"
