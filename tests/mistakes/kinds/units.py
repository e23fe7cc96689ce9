"""Mistakes of units: the number is right in another one."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import degrees

from tests.mistakes.planting import Edit, Program, kind

GROUP = "units"
_JOINT_ROLES = ("joints",)
_POSE_UNIT = "m, rad"
_LONGEST_MS = 60_000.0


def number_of(node: ast.expr | None) -> float | None:
    """Return the number that is written; None if it is none."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = number_of(node.operand)
        return None if inner is None else -inner
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return float(node.value)
    return None


def written(number: float) -> str:
    """Return a number as a person writes it."""
    return f"{number:.6g}"


def _scaled(program: Program, unit: str, factor: float, meanings: tuple[str, ...] = ()) -> Iterator[Edit]:
    """Yield the arguments of a unit, or the constant behind one, as numbers of another unit."""
    for _, _, _, value in program.arguments(
        lambda quantity: quantity.unit == unit and fits(quantity.meaning, meanings)
    ):
        literal = program.literal(value)
        number = number_of(literal)
        if literal is not None and number:
            yield Edit(literal, written(number * factor))


def fits(meaning: str, meanings: tuple[str, ...]) -> bool:
    """Whether a meaning is one of those, if there are some."""
    return not meanings or meaning in meanings


@kind(GROUP, "milliseconds for seconds")
def milliseconds(program: Program) -> Iterator[Edit]:
    for edit in _scaled(program, "s", 1000.0):
        # Longer times are hardly written in milliseconds.
        if (number_of(ast.parse(edit.new, mode="eval").body) or 0.0) < _LONGEST_MS:
            yield edit


@kind(GROUP, "degrees for radians: joint positions")
def joints_in_degrees(program: Program) -> Iterator[Edit]:
    for node in _lists(program, lambda meaning, unit: meaning == "joints"):
        yield Edit(node, f"[{', '.join(written(round(degrees(number_of(n) or 0.0))) for n in node.elts)}]")


@kind(GROUP, "degrees for radians: orientation of a pose")
def pose_in_degrees(program: Program) -> Iterator[Edit]:
    for node in _lists(program, lambda meaning, unit: unit == _POSE_UNIT):
        angles = [number_of(n) or 0.0 for n in node.elts[3:]]
        if any(angles):
            plain = [program.source(n) for n in node.elts[:3]]
            yield Edit(node, f"[{', '.join(plain + [written(round(degrees(angle))) for angle in angles])}]")


@kind(GROUP, "degrees where `d2r` was")
def without_d2r(program: Program) -> Iterator[Edit]:
    for command, call, given in program.calls:
        if command.name == "d2r" and "d" in given and abs(number_of(given["d"][1]) or 0.0) > 7.0:
            yield Edit(call, program.source(given["d"][1]))


@kind(GROUP, "millimetres for metres: position of a pose")
def pose_in_millimetres(program: Program) -> Iterator[Edit]:
    for node in _lists(program, lambda meaning, unit: unit == _POSE_UNIT):
        numbers = [number_of(n) for n in node.elts[:3]]
        if any(numbers):
            first = [
                program.source(n) if m is None else written(m * 1000)
                for n, m in zip(node.elts[:3], numbers, strict=True)
            ]
            yield Edit(node, f"[{', '.join(first + [program.source(n) for n in node.elts[3:]])}]")


@kind(GROUP, "millimetres for metres: one coordinate")
def coordinate_in_millimetres(program: Program) -> Iterator[Edit]:
    for node in _lists(program, lambda meaning, unit: unit == _POSE_UNIT):
        for element in node.elts[:3]:
            if abs(number_of(element) or 0.0) >= 0.01:
                yield Edit(element, written(number_of(element) * 1000))  # type: ignore[operator]


@kind(GROUP, "millimetres a second for metres a second")
def speed_in_millimetres(program: Program) -> Iterator[Edit]:
    yield from _scaled(program, "m/s", 1000.0)


@kind(GROUP, "degrees a second for radians a second")
def speed_in_degrees(program: Program) -> Iterator[Edit]:
    yield from _scaled(program, "rad/s", degrees(1.0))


@kind(GROUP, "blend radius in millimetres")
def radius_in_millimetres(program: Program) -> Iterator[Edit]:
    yield from _scaled(program, "m", 1000.0, ("blend radius",))


@kind(GROUP, "grams for kilograms")
def grams(program: Program) -> Iterator[Edit]:
    yield from _scaled(program, "kg", 1000.0)


@kind(GROUP, "per cent for a fraction")
def per_cent(program: Program) -> Iterator[Edit]:
    for command, _, param, value in program.arguments(lambda quantity: True):
        literal = program.literal(value)
        number = number_of(literal)
        is_fraction = param.quantity.meaning == "fraction" or param.name == "alpha"
        if is_fraction and literal is not None and number and command.name:
            yield Edit(literal, written(number * 100))


def _lists(program: Program, wanted: object) -> Iterator[ast.List]:
    """Yield the lists of six literals that go to a parameter, also through one variable."""
    seen = set()
    for _, _, param, value in program.arguments(lambda quantity: wanted(quantity.meaning, quantity.unit)):  # type: ignore[operator]
        literal = program.literal(value)
        if isinstance(literal, ast.List) and len(literal.elts) == 6 and literal not in seen:
            seen.add(literal)
            if param.name and any(number_of(element) for element in literal.elts):
                yield literal
