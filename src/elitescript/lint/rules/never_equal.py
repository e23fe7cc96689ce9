"""A comparison that can never, or always, be true, because both sides are of other kinds, lengths or ranges.

Inputs are True and False, registers are numbers, and what a peer sends is text: none of them equals a value of another
kind. A register of MODBUS is never below 0. Comparisons of constants with each other, and with None, are not counted:
programs switch parts on and off with them.

    def job():
      if get_standard_digital_in(0) == "True":    # W240: an input is True or False
        halt()
      end
      if socket_read_string() == 1:               # W240: to_num turns a text into a number
        halt()
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.values.description import LIST, NONE, NUMBER, OUTSIDE, TEXT, TUPLE, Value
from elitescript.values.operators import are_of_other_kinds, compare, is_equal
from elitescript.values.results import POSITION
from elitescript.values.words import words


@rule(code="W240", since="0.3", instead_of=("W242",))
def never_equal(program: AnalysedProgram) -> Iterator[Finding]:
    """Report comparisons whose outcome does not depend on what happens."""
    for node in program.nodes(ast.Compare):
        if len(node.ops) == 1:
            yield from _comparison(program, node)


def _comparison(program: AnalysedProgram, node: ast.Compare) -> Iterator[Finding]:
    values = program.values
    op, sides = node.ops[0], (node.left, node.comparators[0])
    left, right = (values.of(side) for side in sides)
    if not left.is_known or not right.is_known or NONE in (left.kinds, right.kinds):
        return
    if all(isinstance(side, ast.Constant) for side in sides):
        return
    if isinstance(op, (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)):
        if are_of_other_kinds(left, right):
            yield Finding(node, _told(program, node, left, right), _advice(left, right))
            return
        are_lists = (left.kinds, right.kinds) in ((LIST, LIST), (TUPLE, TUPLE))
        if are_lists and (left.must | right.must) & OUTSIDE and _differ_in_length(left, right):
            hint = "lists are equal if they have the same number of equal elements"
            yield Finding(node, _told(program, node, left, right), hint)
            return
    known = _by_range(program, node)
    if known is not None:
        side = next(side for side, value in zip(sides, (left, right), strict=True) if _is_from_outside(value))
        text = f"{_said(program, side, values.of(side))}: {shown_source(program, node)} is "
        yield Finding(node, f"{text}{'always' if known else 'never'} true", "compare it with a value that it can have")


def _differ_in_length(left: Value, right: Value) -> bool:
    a, b = left.shape, right.shape
    if a is None or b is None or is_equal(left, right) is not False:
        return False
    return a.most < b.least or b.most < a.least


def _is_from_outside(value: Value) -> bool:
    return bool(value.must & OUTSIDE) or value.role == POSITION


def _by_range(program: AnalysedProgram, node: ast.Compare) -> bool | None:
    """Return the outcome of a comparison of numbers if a value from outside has a range that decides it."""
    sides = []
    for side in (node.left, node.comparators[0]):
        value = program.values.of(side)
        if isinstance(side, ast.Name):
            # What conditions around it say does not count: they may be there twice for safety.
            value = program.values.variable(side.id, program.symbols.scope_of(side))
        if not value.kinds or value.kinds & ~NUMBER:
            return None
        sides.append(value)
    left, right = sides
    if not (_is_from_outside(left) or _is_from_outside(right)) or (left.must & right.must & OUTSIDE):
        return None
    outcome = compare(node.ops[0], left, right)
    if outcome is None or not any(
        isinstance(side, ast.Constant) or value.has_constant
        for side, value in zip((node.left, node.comparators[0]), sides, strict=True)
    ):
        return None
    return outcome


def _said(program: AnalysedProgram, node: ast.expr, value: Value) -> str:
    return f"{shown_source(program, node)} is {words(value)}"


def _told(program: AnalysedProgram, node: ast.Compare, left: Value, right: Value) -> str:
    """Return what is wrong with a comparison for equality."""
    sides = [(node.left, left), (node.comparators[0], right)]
    if isinstance(node.left, ast.Constant):
        sides.reverse()
    (one, value), (other, compared) = sides
    outcome = "never equal to" if isinstance(node.ops[0], (ast.Eq, ast.Is)) else "always different from"
    what = shown_source(program, other)
    if not isinstance(other, ast.Constant):
        what = f"{what}, which is {words(compared)}"
    return f"{_said(program, one, value)}: {outcome} {what}"


def _advice(left: Value, right: Value) -> str:
    both = left.kinds | right.kinds
    if both & TEXT and both & NUMBER:
        if (left.must & OUTSIDE and left.kinds == TEXT) or (right.must & OUTSIDE and right.kinds == TEXT):
            return "to_num turns a text into a number"
        return "write the number, True or False without quotation marks"
    if both & LIST:
        return "compare an element of the list, `x[0]`"
    return "compare it with a value of its own kind"
