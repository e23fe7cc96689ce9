"""Shows values with their units: radians as degrees, metres as millimetres; names and units of elements of lists."""

from __future__ import annotations

from math import degrees, radians
from typing import Any, Final

from elitescript.commands.definition.quantities import Optionally, Quantity, Vector
from elitescript.lint.constants import Unknown

_LONGEST: Final = 60
_DIGITS: Final = 5


def number_text(value: float) -> str:
    """Return a number with few digits: `1.5708`, `90`."""
    return str(value) if isinstance(value, int) else f"{value:.{_DIGITS}g}"


def value_text(value: Any, longest: int = _LONGEST) -> str:
    """Return a value as source text, shortened; `...` stands for what is not known."""
    text = _source(value)
    return text if len(text) <= longest else text[: longest - 3] + "..."


def _source(value: Any) -> str:
    if isinstance(value, Unknown):
        return value.text
    if isinstance(value, float):
        return number_text(value)
    if isinstance(value, (list, tuple)):
        items = ", ".join(map(_source, value))
        comma = "," if isinstance(value, tuple) and len(value) == 1 else ""
        return f"[{items}]" if isinstance(value, list) else f"({items}{comma})"
    return repr(value)


def converted(value: Any, unit: str) -> str:
    """Return a number of an SI unit in another common unit, such as `90 deg` or `250 mm/s`; may be empty."""
    if not isinstance(value, (int, float)) or isinstance(value, bool) or not value:
        return ""
    try:
        number = float(value)
    except OverflowError:
        return ""
    word, slash, rest = unit.partition("/")
    if word == "rad":
        return f"{number_text(degrees(number))} deg{slash}{rest}"
    if word == "m":
        return f"{number_text(number * 1000.0)} mm{slash}{rest}"
    if unit == "deg":
        return f"{number_text(radians(number))} rad"
    if unit == "s" and abs(number) < 1.0:
        return f"{number_text(number * 1000.0)} ms"
    return ""


def with_unit(value: Any, unit: str) -> str:
    """Return a value, its unit, and in brackets what it is in another unit: `0.25 m/s (250 mm/s)`."""
    other = converted(value, unit)
    text = f"{value_text(value)} {unit}".rstrip()
    return f"{text} ({other})" if other else text


def vector_of(quantity: Quantity) -> Vector | None:
    """Return the kind of list that a quantity is; None if it is none."""
    inner = quantity.inner if isinstance(quantity, Optionally) else quantity
    return inner if isinstance(inner, Vector) else None


def element_names(quantity: Quantity) -> tuple[str, ...]:
    """Return the names of the elements of a list: `x`, `y`, `z`, `Rx` ...; none if they have none."""
    vector = vector_of(quantity)
    return tuple(vector.names.strip("[]").split(", ")) if vector is not None and vector.names else ()


def element_unit(quantity: Quantity, index: int) -> str:
    """Return the unit of one element of a list: of a pose m for the first three and rad for the others."""
    first, comma, second = quantity.unit.partition(", ")
    return second if comma and index >= 3 else first
