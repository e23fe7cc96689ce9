"""Judges comparisons and conditions by the descriptions of their sides: the rules W240, W241 and W242.

A module of its own, because short programs do without the evaluation that it needs.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, shown_source
from elitescript.said import said
from elitescript.values.description import (
    BOOL,
    FLOAT,
    LIST,
    LITERAL,
    MEASURED,
    NONE,
    NUMBER,
    OUTSIDE,
    ROW,
    SET,
    TEXT,
    TUPLE,
    WHOLE,
    Value,
)
from elitescript.values.operators import are_of_other_kinds, compare, is_equal, truth
from elitescript.values.results import POSITION
from elitescript.values.words import phrase


def never_equal(program: AnalysedProgram) -> Iterator[Finding]:
    """Report comparisons whose outcome does not depend on what happens."""
    for node in program.nodes(ast.Compare):
        if len(node.ops) == 1:
            found = list(_comparison(program, node))
            if not found and _asks_for_identity(node):
                found = [_identity(program, node)]
            yield from found


def _asks_for_identity(node: ast.Compare) -> bool:
    """Return whether `is` stands beside a text or a number."""
    other = node.comparators[0]
    is_plain = isinstance(other, ast.Constant) and isinstance(other.value, (str, bytes, int, float))
    return is_plain and isinstance(node.ops[0], (ast.Is, ast.IsNot)) and not isinstance(ast.literal_eval(other), bool)


def _identity(program: AnalysedProgram, node: ast.Compare) -> Finding:
    sign, right = ("is", "==") if isinstance(node.ops[0], ast.Is) else ("is not", "!=")
    text = said("`{sign}` asks whether both sides are one object, not whether they are equal", sign=sign)
    if _is_measured(program.values.of(node.left)):
        return Finding(node, text, _nearness(program.values.of(node.left), node.left))
    wanted = f"{ast.unparse(node.left)} {right} {ast.unparse(node.comparators[0])}"
    # Between the sides there are the words alone, and perhaps brackets and comments: then nothing is replaced.
    left, other = program.span(node.left), program.span(node.comparators[0])
    between = program.source.line(left.end_line)[left.end_column - 1 : other.column - 1]
    fix = None
    if left.end_line == other.line and between.split() == sign.split():
        edit = Edit(left.end_line, left.end_column, other.line, other.column, f" {right} ")
        fix = Fix(said("write {sign}", sign=right), (edit,), safe=True)
    return Finding(node, text, said("write {wanted}", wanted=wanted), fix)


def _comparison(program: AnalysedProgram, node: ast.Compare) -> Iterator[Finding]:
    values = program.values
    op, sides = node.ops[0], (node.left, node.comparators[0])
    left, right = (values.of(side) for side in sides)
    if not left.is_known or not right.is_known or NONE in (left.kinds, right.kinds):
        return
    # `{{NAME}}` is a set in Python, and a place to fill in in a template.
    if (left.kinds | right.kinds) & SET:
        return
    if all(isinstance(side, ast.Constant) for side in sides):
        return
    if any(_may_be_written_elsewhere(program, side, value) for side, value in zip(sides, (left, right), strict=True)):
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
        if _is_truth_beside_number(left, right) or _is_truth_beside_number(right, left):
            yield Finding(node, _told(program, node, left, right), "ask for the value itself, or for `not` it")
            return
    analog = _analog(program, node)
    if analog is not None:
        yield analog
        return
    known = _by_range(program, node)
    if known is not None:
        side = sides[0] if _is_from_outside(left) else sides[1]
        text = said(
            "{operand}: {expression} is always true" if known else "{operand}: {expression} is never true",
            operand=_said(program, side, values.of(side)),
            expression=shown_source(program, node),
        )
        yield Finding(node, text, "compare it with a value that it can have")


def _may_be_written_elsewhere(program: AnalysedProgram, node: ast.expr, value: Value) -> bool:
    """Return whether another text, such as a secondary program, may give a global another value."""
    # What the program itself fetches from outside, nothing else gives it.
    if not isinstance(node, ast.Name) or value.may & OUTSIDE:
        return False
    return program.symbols.scope_of(node).home(node.id) is None


def _differ_in_length(left: Value, right: Value) -> bool:
    a, b = left.shape, right.shape
    if a is None or b is None or is_equal(left, right) is not False:
        return False
    return a.most < b.least or b.most < a.least


def _is_truth_beside_number(value: Value, other: Value) -> bool:
    """Return whether True or False, which the program has not written itself, is compared with another number."""
    is_truth = value.kinds == BOOL and not value.must & LITERAL
    return is_truth and other.has_constant and not other.kinds & ~NUMBER and other.constant not in (0, 1)


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


_CURRENT_MOST_A: Final = 0.025
_VOLTAGE_MOST_V: Final = 11.0
"""More than an analog input measures."""
_ANALOG_UNIT: Final = "A or V"
_MILLIAMPERES: Final = 20
"""Most that such an input measures, and what people write for it."""
_DOMAIN: Final = "set_standard_analog_input_domain"


def _analog(program: AnalysedProgram, node: ast.Compare) -> Finding | None:
    """Return the finding of an analog input that is compared with more than it ever measures."""
    sides = [(node.left, node.comparators[0]), (node.comparators[0], node.left)]
    for side, other in sides:
        value, limit = program.values.of(side), program.values.of(other)
        if value.role != _ANALOG_UNIT or not value.must & MEASURED or not limit.has_constant or limit.kinds & ~NUMBER:
            continue
        called = program.derived(CalledCommands)
        domains = {called.number(found, "domain") for found in called.of(_DOMAIN)}
        is_current = domains == {0}
        most = _CURRENT_MOST_A if is_current else _VOLTAGE_MOST_V
        if limit.constant > most:
            range_text = "a current of 0.004 to 0.02 A" if is_current else "0 to 10 V, or 0.004 to 0.02 A"
            text = said(
                "{expression} is {range_text}, and never reaches {limit:g}",
                expression=shown_source(program, side),
                range_text=range_text,
                limit=limit.constant,
            )
            hint = (
                said("{limit:g} mA are {meant:g} A", limit=limit.constant, meant=limit.constant / 1000)
                if limit.constant <= _MILLIAMPERES
                else ""
            )
            return Finding(node, text, hint)
    return None


def _said(program: AnalysedProgram, node: ast.expr, value: Value) -> str:
    return said("{expression} is {words}", expression=shown_source(program, node), words=phrase(value))


def _told(program: AnalysedProgram, node: ast.Compare, left: Value, right: Value) -> str:
    """Return what is wrong with a comparison for equality."""
    sides = [(node.left, left), (node.comparators[0], right)]
    if isinstance(node.left, ast.Constant):
        sides.reverse()
    (one, value), (other, compared) = sides
    is_equality = isinstance(node.ops[0], (ast.Eq, ast.Is))
    what = shown_source(program, other)
    if not isinstance(other, ast.Constant):
        what = said("{what}, which is {words}", what=what, words=phrase(compared))
    return said(
        "{operand}: never equal to {what}" if is_equality else "{operand}: always different from {what}",
        operand=_said(program, one, value),
        what=what,
    )


def _advice(left: Value, right: Value) -> str:
    both = left.kinds | right.kinds
    if both & TEXT and both & NUMBER:
        if (left.must & OUTSIDE and left.kinds == TEXT) or (right.must & OUTSIDE and right.kinds == TEXT):
            return "to_num turns a text into a number"
        return "write the number, True or False without quotation marks"
    if both & LIST:
        return "compare an element of the list, `x[0]`"
    return "compare it with a value of its own kind"


def always_true(program: AnalysedProgram) -> Iterator[Finding]:
    """Report conditions that are no question."""
    for choice in program.nodes(ast.BoolOp):
        yield from _alternatives(program, choice)
    for chain in program.nodes(ast.Compare):
        yield from _bits_between(program, chain)
    conditions: list[ast.expr] = [statement.test for statement in program.nodes(ast.If)]
    conditions += [statement.test for statement in program.nodes(ast.While)]
    conditions += [expression.test for expression in program.nodes(ast.IfExp)]
    while conditions:
        node = conditions.pop()
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            conditions.append(node.operand)
        elif isinstance(node, ast.BoolOp):
            conditions += node.values
        elif isinstance(node, ast.Compare):
            yield from _position_as_truth(program, node)
        else:
            yield from _truth(program, node)


def _bits_between(program: AnalysedProgram, node: ast.Compare) -> Iterator[Finding]:
    """Yield `1 < x & x < 10`, where `&` binds closer than the comparisons beside it."""
    for part in node.comparators[:-1]:
        if isinstance(part, ast.BinOp) and isinstance(part.op, (ast.BitAnd, ast.BitOr)):
            sign, word = ("&", "and") if isinstance(part.op, ast.BitAnd) else ("|", "or")
            text = said(
                "`{sign}` binds closer than the comparisons: {expression} is one number between them",
                sign=sign,
                expression=shown_source(program, part),
            )
            yield Finding(node, text, said("write `{word}` between conditions", word=word))
            return


def _alternatives(program: AnalysedProgram, node: ast.BoolOp) -> Iterator[Finding]:
    """Yield the values that stand alone behind `or`: `x == 1 or 2`."""
    first = node.values[0]
    if isinstance(first, ast.BoolOp):
        # `x and y == 1 or 2`: `and` binds closer.
        first = first.values[-1]
    if not isinstance(node.op, ast.Or) or not isinstance(first, ast.Compare) or not isinstance(first.ops[0], ast.Eq):
        return
    for part in node.values[1:]:
        if isinstance(part, ast.BoolOp):
            # `x == 1 or 2 and y`.
            part = part.values[0]
        if isinstance(part, ast.Constant) and part.value and not isinstance(part.value, bool):
            left = ast.unparse(first.left)
            text = said("{expression} alone is always true", expression=shown_source(program, part))
            yield Finding(
                part,
                text,
                said("write the comparison again: {left} == {expression}", left=left, expression=ast.unparse(part)),
            )
            return


def _position_as_truth(program: AnalysedProgram, node: ast.Compare) -> Iterator[Finding]:
    if len(node.ops) != 1 or not isinstance(node.ops[0], (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)):
        return
    other = node.comparators[0]
    if isinstance(other, ast.Constant) and isinstance(other.value, bool):
        value = program.values.of(node.left)
        if _is_position(value):
            yield Finding(node, *_position_words(program, node.left))


def _truth(program: AnalysedProgram, node: ast.expr) -> Iterator[Finding]:
    if isinstance(node, (ast.Constant, ast.List, ast.Tuple)):
        return
    value = program.values.of(node)
    if not value.is_known:
        return
    if _is_position(value):
        yield Finding(node, *_position_words(program, node))
    elif not value.kinds & ~ROW and value.must & OUTSIDE and truth(value) is True:
        text = said(
            "{expression} is a list that is never empty, which is always true", expression=shown_source(program, node)
        )
        yield Finding(node, text, "ask for its first element, which says how many values came")


def _is_position(value: Value) -> bool:
    return value.role == POSITION and not value.kinds & ~WHOLE and (value.low < 0 or value.has_constant)


def _position_words(program: AnalysedProgram, node: ast.expr) -> tuple[str, str]:
    text = said(
        "{expression} is a position: 0 at the start, which is false; -1 for none, which is true",
        expression=shown_source(program, node),
    )
    return text, said("ask {expression} >= 0", expression=ast.unparse(node))


def measured_exactly(program: AnalysedProgram) -> Iterator[Finding]:
    """Report `==` and `!=` with a measured value."""
    for node in program.nodes(ast.Compare):
        if len(node.ops) != 1 or not isinstance(node.ops[0], (ast.Eq, ast.NotEq, ast.In, ast.NotIn)):
            continue
        sides: tuple[ast.expr, ...] = (node.left, node.comparators[0])
        if isinstance(node.ops[0], (ast.In, ast.NotIn)):
            choices = node.comparators[0]
            if not isinstance(choices, (ast.List, ast.Tuple)) or not choices.elts:
                continue
            sides = (node.left, choices.elts[0])
        values = [program.values.of(side) for side in sides]
        measured = [_is_measured(value) for value in values]
        if any(measured) and not all(measured) and all(map(_has_numbers, values)):
            side = sides[measured.index(True)]
            text = said(
                "{expression} is measured, and never exactly equal to a planned value on an arm",
                expression=shown_source(program, side),
            )
            yield Finding(node, text, _nearness(values[0], side))


def _is_measured(value: Value) -> bool:
    return bool(value.must & MEASURED) and (value.kinds == FLOAT or not value.kinds & ~ROW)


def _has_numbers(value: Value) -> bool:
    return value.is_known and (not value.kinds & ~NUMBER or not value.kinds & ~ROW)


def _nearness(value: Value, side: ast.expr) -> str:
    if value.kinds & NUMBER:
        return "ask whether the difference is small: abs(a - b) < 0.001"
    if value.role == "pose":
        return "ask whether the distance is small: point_dist(a, b) < 0.001"
    return "ask whether each difference is small: all(abs(x - y) < 0.001 for x, y in zip(a, b))"
