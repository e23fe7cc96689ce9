"""Compares what numbers are with what a parameter takes: degrees for radians, a count for one of what was counted."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.plausibility import OF_ANGLES, SURELY_DEGREES, Doubt
from elitescript.commands.definition.quantities import Vector
from elitescript.commands.definition.registry import Command, Param
from elitescript.said import Said, said
from elitescript.values.description import FLOAT, INT
from elitescript.values.program import Values
from elitescript.values.results import ELEMENT_ROLES

_LENGTH, _ANGLE, _DEGREES, _COUNT = "m", "rad", "deg", "count"
_PHYSICAL: Final = frozenset((_LENGTH, _ANGLE, "m/s", "rad/s", "m/s^2", "rad/s^2", "s", "N", "kg"))
_WORDS: Final = {_LENGTH: Said("a length"), _ANGLE: Said("an angle")}


def quantity_doubts(values: Values, command: Command, param: Param, node: ast.expr) -> Iterator[Doubt]:
    """Yield the doubts about a number, or about the elements of a list, that are not what a parameter takes."""
    quantity = param.quantity
    if not isinstance(quantity, Vector):
        if isinstance(node, (ast.Constant, ast.UnaryOp)) and command.name in OF_ANGLES:
            yield from _written(values, node)
        elif not isinstance(node, ast.Constant):
            doubt = _doubt(node, values.of(node).role, quantity.unit, None)
            if doubt is not None:
                yield doubt
        return
    if quantity.unit not in ELEMENT_ROLES and quantity.unit not in _PHYSICAL:
        return
    units = ELEMENT_ROLES.get(quantity.unit, (quantity.unit,) * (quantity.count or 0))
    if isinstance(node, (ast.List, ast.Tuple)):
        parts: list[ast.expr | None] = list(node.elts)
        roles = ["" if isinstance(part, ast.Constant) else values.of(part).role for part in node.elts]
    else:
        items = values.of(node).items or ()
        parts, roles = [None] * len(items), [item.role for item in items]
    for index, (part, role, unit) in enumerate(zip(parts, roles, units, strict=False)):
        doubt = _doubt(part, role, unit, index) if role else None
        if doubt is not None:
            yield doubt
            return


def _doubt(node: ast.expr | None, role: str, unit: str, index: int | None) -> Doubt | None:
    place = "" if index is None else f"[{index}]"
    if role == _DEGREES and unit == _ANGLE:
        return Doubt("W230", said("{place} is in degrees", place=place), "angles are in radians: d2r(...)", index)
    if role == _ANGLE and unit == _DEGREES:
        return Doubt("W230", said("{place} is in radians already", place=place), "d2r is not needed here", index)
    if role == _COUNT and unit in _PHYSICAL:
        text = said("{place} is how many numbers came, and no number of them", place=place)
        return Doubt("W239", text, "the first element of a reading is their number, [1] the first of them", index)
    # With a factor, an angle becomes the length of an arc: only an element as it stands is known.
    if isinstance(node, ast.Subscript) and {role, unit} == {_LENGTH, _ANGLE}:
        text = said("{place} is {given}, where {wanted} belongs", place=place, given=_WORDS[role], wanted=_WORDS[unit])
        return Doubt("W239", text, "a pose is [x, y, z, Rx, Ry, Rz]: m, m, m, rad, rad, rad", index)
    return None


def _written(values: Values, node: ast.expr) -> Iterator[Doubt]:
    """Yield the doubt about an angle that is written as degrees: `sin(90)`."""
    value = values.of(node)
    if not value.has_constant or value.kinds & ~(INT | FLOAT):
        return
    number = value.constant
    if abs(number) > SURELY_DEGREES and number == int(number):
        yield Doubt(
            "W230",
            said(" is {number:g} rad, more than a full turn", number=number),
            said("{number:g} looks like degrees: write d2r({number:g})", number=number),
        )
