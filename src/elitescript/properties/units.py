"""Units of expressions: products of s, m, rad and others, so that a length is never compared with an angle.

A unit is a tuple of names with their exponents, in the order of the names. None is the unit of numbers that may be of
any: literals, registers, globals, ratios.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

Unit = tuple[tuple[str, float], ...] | None


def unit(text: str) -> Unit:
    """Return a unit from its text, such as `rad/s`; None for an empty one."""
    if not text:
        return None
    above, _, below = text.partition("/")
    return product(((above, 1.0),), ((below, -1.0),) if below else None)


def product(first: Unit, second: Unit) -> Unit:
    """Return the unit of a product."""
    exponents = dict(first or ())
    for name, exponent in second or ():
        exponents[name] = exponents.get(name, 0.0) + exponent
    return tuple(sorted((name, exponent) for name, exponent in exponents.items() if exponent)) or None


def power(base: Unit, exponent: float) -> Unit:
    """Return the unit of a power."""
    return tuple((name, its * exponent) for name, its in base or ()) or None if exponent else None


def common(units: Iterable[Unit]) -> Unit:
    """Return the unit that numbers share; those of any unit take it.

    Raises:
        UnitsDiffer: two contradict each other.
    """
    found: Unit = None
    for one in units:
        if one is not None and found is not None and one != found:
            raise UnitsDiffer(found, one)
        found = found if one is None else one
    return found


class UnitsDiffer(Exception):
    """Two units that contradict each other."""

    def __init__(self, first: Unit, second: Unit) -> None:
        super().__init__()
        self.first = first
        self.second = second


def unit_text(of: Unit) -> str:
    """Return a unit as text, such as `m/s^2`; empty for None."""
    if of is None:
        return ""
    above = " ".join(_factor(name, exponent) for name, exponent in of if exponent > 0)
    below = "/".join(_factor(name, -exponent) for name, exponent in of if exponent < 0)
    return f"{above or '1'}/{below}" if below else above


def _factor(name: str, exponent: float) -> str:
    return name if exponent == 1.0 else f"{name}^{exponent:g}"


S: Final = unit("s")
M: Final = unit("m")
RAD: Final = unit("rad")
DEGREES: Final = unit("°")
RAD_PER_S: Final = unit("rad/s")
M_PER_S: Final = unit("m/s")
