"""A condition that is always true, or that means something else than it says.

`str_find` returns a position: 0, which is false, for a text that begins with what is looked for, and -1, which is
true, where nothing was found. A reading of several numbers is a list with at least one element, which is true.
`x == 1 or 2` is true whatever `x` is.

    def job():
      if str_find(socket_read_string(), "OK"):    # W241: >= 0 if it was found
        halt()
      end
      if socket_read_ascii_float(3):              # W241: [0] is how many came
        halt()
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.values.description import OUTSIDE, ROW, WHOLE, Value
from elitescript.values.operators import truth
from elitescript.values.results import POSITION


@rule(code="W241", since="0.3")
def always_true(program: AnalysedProgram) -> Iterator[Finding]:
    """Report conditions that are no question."""
    conditions: list[ast.expr] = [statement.test for statement in program.nodes(ast.If)]
    conditions += [statement.test for statement in program.nodes(ast.While)]
    conditions += [choice.test for choice in program.nodes(ast.IfExp)]
    while conditions:
        node = conditions.pop()
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            conditions.append(node.operand)
        elif isinstance(node, ast.BoolOp):
            yield from _alternatives(program, node)
            conditions += node.values
        elif isinstance(node, ast.Compare):
            yield from _position_as_truth(program, node)
        else:
            yield from _truth(program, node)


def _alternatives(program: AnalysedProgram, node: ast.BoolOp) -> Iterator[Finding]:
    """Yield the values that stand alone behind `or`: `x == 1 or 2`."""
    first = node.values[0]
    if not isinstance(node.op, ast.Or) or not isinstance(first, ast.Compare) or not isinstance(first.ops[0], ast.Eq):
        return
    for part in node.values[1:]:
        if isinstance(part, ast.Constant) and part.value and not isinstance(part.value, bool):
            left = ast.unparse(first.left)
            text = f"{shown_source(program, part)} alone is always true"
            yield Finding(part, text, f"write the comparison again: {left} == {ast.unparse(part)}")
            return


def _position_as_truth(program: AnalysedProgram, node: ast.Compare) -> Iterator[Finding]:
    if len(node.ops) != 1 or not isinstance(node.ops[0], (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)):
        return
    other = node.comparators[0]
    if isinstance(other, ast.Constant) and isinstance(other.value, bool):
        value = program.values.of(node.left)
        if _is_position(value):
            yield Finding(node, *_position(program, node.left))


def _truth(program: AnalysedProgram, node: ast.expr) -> Iterator[Finding]:
    if isinstance(node, (ast.Constant, ast.List, ast.Tuple)):
        return
    value = program.values.of(node)
    if not value.is_known:
        return
    if _is_position(value):
        yield Finding(node, *_position(program, node))
    elif not value.kinds & ~ROW and value.must & OUTSIDE and truth(value) is True:
        text = f"{shown_source(program, node)} is a list that is never empty, which is always true"
        yield Finding(node, text, "ask for its first element, which says how many values came")


def _is_position(value: Value) -> bool:
    return value.role == POSITION and not value.kinds & ~WHOLE and (value.low < 0 or value.has_constant)


def _position(program: AnalysedProgram, node: ast.expr) -> tuple[str, str]:
    text = f"{shown_source(program, node)} is a position: 0 at the start, which is false; -1 for none, which is true"
    return text, f"ask {ast.unparse(node)} >= 0"
