"""Signals of a controller as its RTSI variables show them, by the names of `messages.signals`."""

from __future__ import annotations

from typing import Final

from elitescript.messages.signals import Value, parse_signal_name, point_names
from elitescript.protocol.rtsi.variables import BIT_REGISTERS, WORDS

_DIGITAL_PLACES: Final = (("standard_digital", 0), ("configurable_digital", 16), ("tool_digital", 24))
"""Families in the words of digital levels, with their first bit."""
_WORD_BITS: Final = 32


def _digital(direction: str) -> tuple[str, ...]:
    points = [""] * _WORD_BITS
    for place, first in _DIGITAL_PLACES:
        names = point_names(f"{place}_{direction}")
        points[first : first + len(names)] = names
    return tuple(points)


def _registers(side: str) -> dict[str, tuple[str, ...]]:
    bits = point_names(f"{side}_bool_register")
    found = {
        f"{side}_bit_registers{first}_to_{first + _WORD_BITS - 1}": bits[first : first + _WORD_BITS] for first in WORDS
    }
    found |= {f"{side}_bit_register{index}": (bits[index],) for index in BIT_REGISTERS}
    for kind, family in (("int", f"{side}_int_register"), ("double", f"{side}_float_register")):
        found |= {f"{side}_{kind}_register{index}": (name,) for index, name in enumerate(point_names(family))}
    return found


POINTS: Final[dict[str, tuple[str, ...]]] = {
    "actual_digital_input_bits": _digital("in"),
    "actual_digital_output_bits": _digital("out"),
    **{
        f"standard_analog_{direction}put{index}": (name,)
        for direction in ("in", "out")
        for index, name in enumerate(point_names(f"standard_analog_{direction}"))
    },
    "tool_analog_input": point_names("tool_analog_in"),
    "tool_analog_output": point_names("tool_analog_out"),
    "tool_output_voltage": point_names("tool_voltage"),
    **_registers("output"),
    **_registers("input"),
}
"""For each variable that shows signals their names: one, or of a word one for each bit, the lowest first; empty for a
bit without a signal."""


def levels_of(variable: str, number: float) -> dict[str, Value]:
    """Return the signals that a value of a variable shows, each in the form of its kind.

    Raises:
        ValueError: the number is not finite where a whole one is due.
    """
    points = POINTS[variable]
    if len(points) > 1:
        word = int(number)
        return {name: bool(word >> bit & 1) for bit, name in enumerate(points) if name}
    kind = parse_signal_name(points[0])[0].kind
    return {points[0]: bool(number) if kind == "bool" else round(number) if kind == "int" else float(number)}
