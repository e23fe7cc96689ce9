"""Values that nodes hold: quantities with their own text, expressions as cells, positions of the arm."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from math import isnan, radians
from typing import Final

from elitescript.records import record

Joints = tuple[float, float, float, float, float, float]
Pose = tuple[float, float, float, float, float, float]
"""x, y, z in m; rx, ry, rz in rad, about fixed axes."""


class Quantity(float):
    """A number in SI units with the text that a file has for it, which goes into the script unchanged."""

    __slots__ = ("_text",)

    _text: str

    def __new__(cls, value: float, text: str = "") -> Quantity:
        """Make a quantity; without a text it gets the one that Java writes."""
        made = float.__new__(cls, value)
        object.__setattr__(made, "_text", text or java_text(float(value)))
        return made

    @property
    def text(self) -> str:
        """The number as it is written."""
        return self._text

    def __reduce__(self) -> tuple[object, ...]:
        return Quantity, (float(self), self._text)


def number_text(value: float) -> str:
    """Return a number as it stands in a script: the text of its file, else as Java writes it."""
    return value.text if isinstance(value, Quantity) else java_text(value)


def java_text(value: float) -> str:
    """Return a number as Java's `Double.toString` writes it, which is how a pendant writes numbers: `7.5E-7`."""
    value = float(value)
    if isnan(value):
        return "NaN"
    text = repr(value)
    size = abs(value)
    if size in (0.0, float("inf")) or 1e-3 <= size < 1e7:
        return text.replace("inf", "Infinity") if "e" not in text else f"{value:.1f}"
    digits, exponent = f"{value:.17e}".split("e")
    for places in range(18):
        digits, exponent = f"{value:.{places}e}".split("e")
        if float(f"{digits}e{exponent}") == value:
            break
    return f"{digits if '.' in digits else f'{digits}.0'}E{int(exponent)}"


_NAN: Final = Quantity(float("nan"), "NaN")
"""One object, so that positions with it compare equal."""
UNTAUGHT: Final[Joints] = (_NAN, _NAN, _NAN, _NAN, _NAN, _NAN)
"""Joint positions of a waypoint that has never been taught."""


# ---------------------------------------------------------------- expressions


@record
class TextCell:
    """A sign or a piece of text of an expression, as it stands in the script.

    Attributes:
        script: in the script.
        shown: on the pendant.
    """

    script: str
    shown: str = ""


@record
class VariableCell:
    """A variable in an expression."""

    name: str
    is_global: bool = False
    """A variable of the configuration, which all tasks share."""


@record
class PinCell:
    """An input or output in an expression."""

    pin: str


@record
class UnknownCell:
    """A cell that gives no text."""

    kind: str


Cell = TextCell | VariableCell | PinCell | UnknownCell


@record
class Expression:
    """Cells, whose texts one after the other are the expression."""

    cells: tuple[Cell, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.cells)

    def text(self, read: Callable[[str], str] = lambda pin: pin) -> str:
        """Return it as it stands in a script; `read` gives the call that reads a pin."""
        return "".join(
            cell.script
            if isinstance(cell, TextCell)
            else cell.name
            if isinstance(cell, VariableCell)
            else read(cell.pin)
            if isinstance(cell, PinCell)
            else ""
            for cell in self.cells
        )

    @property
    def names(self) -> Iterable[str]:
        """The variables in it, in their order."""
        return (cell.name for cell in self.cells if isinstance(cell, VariableCell))


def expression(text: str) -> Expression:
    """Return a text as an expression of signs, one a cell, as it is typed on a pendant."""
    return Expression(tuple(TextCell(sign) for sign in text))


SIGNS: Final = {"≠": "!=", "≥": ">=", "≤": "<=", "\xd7": "*", "÷": "/"}
"""Signs of a pendant's keyboard that stand for signs of the language. *Assumed*: no tree with its script shows them."""


# ---------------------------------------------------------------- units

UNITS: Final[dict[str, tuple[str, str]]] = {
    "length": ("M", "Length$Unit"),
    "speed": ("M_S", "Speed$Unit"),
    "acceleration": ("M_S2", "Acceleration$Unit"),
    "angular speed": ("RAD_S", "AngularSpeed$Unit"),
    "angular acceleration": ("RAD_S2", "AngularAcceleration$Unit"),
    "time": ("S", "Time$Unit"),
    "force": ("N", "Force$Unit"),
    "current": ("A", "Current$Unit"),
    "voltage": ("V", "Voltage$Unit"),
}
"""Unit of SI as files name it, and the end of the name of its class, by kind of quantity."""

UNIT_CLASS: Final = "cn.elibot.robot.plugin.domain.value."

_LENGTHS: Final = {"M": 1.0, "MM": 1e-3, "CM": 1e-2, "IN": 0.0254, "INCH": 0.0254}
_ANGLES: Final = {"RAD": 1.0, "DEG": radians(1.0)}
FACTORS: Final[dict[str, float]] = {
    **{f"{unit}{per}": factor for unit, factor in (_LENGTHS | _ANGLES).items() for per in ("", "_S", "_S2")},
    "S": 1.0,
    "MS": 1e-3,
    "MIN": 60.0,
    "N": 1.0,
    "A": 1.0,
    "MA": 1e-3,
    "V": 1.0,
    "MV": 1e-3,
}
"""What a number in a unit is multiplied with. *Assumed* but for those of SI, which real files have."""

_NUMBER: Final = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|NaN")


def quantity(text: str, unit: str = "") -> Quantity | None:
    """Return a number with its unit as a quantity, None for what is none."""
    text = text.strip()
    if not _NUMBER.fullmatch(text) or (factor := FACTORS.get(unit.upper() if unit else "S")) is None:
        return None
    return Quantity(float(text), text) if factor == 1.0 else Quantity(float(text) * factor)


def six(text: str) -> Joints | None:
    """Return six numbers with commas between them, None for anything else."""
    parts = text.split(",")
    if len(parts) != 6 or not all(_NUMBER.fullmatch(part.strip()) for part in parts):
        return None
    numbers = (Quantity(float(part), part.strip()) for part in parts)
    return tuple(_NAN if isnan(number) else number for number in numbers)  # type: ignore[return-value]


def is_taught(values: Iterable[float]) -> bool:
    """Return whether numbers of a position are numbers."""
    return not any(isnan(value) for value in values)
