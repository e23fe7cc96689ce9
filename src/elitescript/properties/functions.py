"""Functions of expressions that compute a value from values: one row each."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final

from elitescript.properties.units import DEGREES, RAD, Unit, power
from elitescript.records import NamedTuple


class Function(NamedTuple):
    """A function of numbers."""

    compute: Callable[..., Any]
    """Computes the value; may raise ArithmeticError or ValueError."""
    least: int
    """Arguments at least."""
    most: int | None
    """Arguments at most; None for any number."""
    unit: Callable[[Unit], Unit]
    """Returns the unit of the result for that of the arguments."""
    summary: str
    takes: Unit = None
    """Unit of the arguments; None for any."""
    takes_list: bool = False
    """Whether one list may stand for the arguments."""


def _same(unit: Unit) -> Unit:
    return unit


def _none(_: Unit) -> Unit:
    return None


def _rounded(value: float, digits: int | None = None) -> float:
    # Of integers too, but never of one with negative digits: that is a power of ten of any size.
    return round(value) if digits is None else round(float(value), digits)


def _sum(*values: float) -> float:
    return sum(values)


FUNCTIONS: Final[dict[str, Function]] = {
    "abs": Function(abs, 1, 1, _same, "size of a number"),
    "min": Function(min, 1, None, _same, "smallest of numbers, or of a list", takes_list=True),
    "max": Function(max, 1, None, _same, "largest of numbers, or of a list", takes_list=True),
    "sum": Function(_sum, 1, None, _same, "sum of numbers, or of a list", takes_list=True),
    "round": Function(_rounded, 1, 2, _same, "rounded to a whole number, or to 0 to 15 digits"),
    "sqrt": Function(math.sqrt, 1, 1, lambda unit: power(unit, 0.5), "square root"),
    "hypot": Function(math.hypot, 1, None, _same, "root of the sum of squares, as of a distance"),
    "degrees": Function(math.degrees, 1, 1, lambda _: DEGREES, "an angle in degrees", RAD),
    "radians": Function(math.radians, 1, 1, lambda _: RAD, "an angle in radians", DEGREES),
    "sin": Function(math.sin, 1, 1, _none, "sine of an angle in radians", RAD),
    "cos": Function(math.cos, 1, 1, _none, "cosine of an angle in radians", RAD),
}
"""By name; `len` is beside them, since it takes texts, lists and tables."""

DIGITS_MAX: Final = 15
EXPONENT_MAX: Final = 10


def powered(base: float, exponent: float) -> float:
    """Return a power of two numbers, computed with floats, so that it never has more digits than one.

    Raises:
        ValueError: it is no real number.
        OverflowError: it is too large.
    """
    return math.pow(base, exponent)
