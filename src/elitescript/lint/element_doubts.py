"""Finds degrees and millimetres beside elements of poses and joint positions: `p[2] = p[2] + 50`, `if q[0] > 90`."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.plausibility import POSE_MOST_M, SURELY_DEGREES, Doubt, number_text
from elitescript.lint.constants import Unknown
from elitescript.lint.program import AnalysedProgram, Doubted
from elitescript.said import said

_UNITS: Final = ("m", "rad")
_LIST_UNITS: Final = {"pose": ("m",) * 3 + ("rad",) * 3, "joints": ("rad",) * 6, "tcp": ("m",) * 3 + ("rad",) * 3}
_ORDER: Final = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


def element_doubts(program: AnalysedProgram) -> list[Doubted]:
    """Return the numbers that are hardly metres or radians, where one of them is set, added or compared."""
    return list(_found(program))


def _found(program: AnalysedProgram) -> Iterator[Doubted]:
    for node in program.nodes(ast.Assign):
        for target in node.targets:
            if isinstance(target, ast.Subscript):
                yield from _judged(program, node.value, _unit_of_element(program, target), ast.unparse(target))
    for operation in program.nodes(ast.BinOp):
        if isinstance(operation.op, (ast.Add, ast.Sub)):
            for side, other in ((operation.left, operation.right), (operation.right, operation.left)):
                yield from _beside(program, side, other)
    for comparison in program.nodes(ast.Compare):
        if len(comparison.ops) == 1 and isinstance(comparison.ops[0], _ORDER):
            left, right = comparison.left, comparison.comparators[0]
            yield from _beside(program, left, right)
            yield from _beside(program, right, left)


def _beside(program: AnalysedProgram, side: ast.expr, other: ast.expr) -> Iterator[Doubted]:
    if isinstance(other, ast.Constant) and isinstance(side, (ast.Subscript, ast.Name)):
        value = program.values.of(side)
        if value.role in _UNITS and value.is_number:
            yield from _judged(program, other, value.role, ast.unparse(side))


def _unit_of_element(program: AnalysedProgram, target: ast.Subscript) -> str:
    """Return the unit of an element of a pose or of joint positions; empty if it is none."""
    if not isinstance(target.value, ast.Name):
        return ""
    units = _LIST_UNITS.get(program.values.of(target.value).role, ())
    index = program.constants.value(target.slice, program.symbols.scope_of(target))
    return units[index] if isinstance(index, int) and -len(units) <= index < len(units) else ""


def _judged(program: AnalysedProgram, node: ast.expr, unit: str, place: str) -> Iterator[Doubted]:
    if not unit:
        return
    scope = program.symbols.scope_of(node)
    number = program.constants.bounds(node, scope)
    if isinstance(number, (Unknown, bool)) or not isinstance(number, (int, float)):
        return
    if unit == "m" and abs(number) > POSE_MOST_M:
        text = said(
            "`{place}` is in metres, and {number} m is no length of an arm", place=place, number=number_text(number)
        )
        hint = said(
            "{number:g} looks like millimetres: {number:g} mm are {meant:g} m", number=number, meant=number / 1000.0
        )
        yield Doubted(node, Doubt("W231", text, hint), None, node, scope)
    elif unit == "rad" and abs(number) > SURELY_DEGREES:
        text = said(
            "`{place}` is in radians, and {number} rad is more than a full turn",
            place=place,
            number=number_text(number),
        )
        hint = said("{number:g} looks like degrees: write d2r({number:g})", number=number)
        yield Doubted(node, Doubt("W230", text, hint), None, node, scope)
