"""Signals of a controller as RTSI shows them, by the names of `messages.signals`."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Final

from elitescript.messages.signals import SIGNALS, Value, signal_name
from elitescript.protocol.binary import WireValue

_SCALARS: Final = (
    ("standard_analog_in", "standard_analog_input#", 2),
    ("standard_analog_out", "standard_analog_output#", 2),
    ("tool_analog_in", "tool_analog_input", 1),
    ("tool_analog_out", "tool_analog_output", 1),
    ("tool_voltage", "tool_output_voltage", 1),
)
"""Families with one RTSI variable for each point."""
_DIGITAL: Final = (("standard_digital", 0), ("configurable_digital", 16), ("tool_digital", 24))
"""Families in the words of digital levels, with their first bit."""
_SIDES: Final = ("input", "output")

FAST: Final = (
    "actual_digital_input_bits",
    "actual_digital_output_bits",
    *(
        variable.replace("#", str(index)) if "#" in variable else variable
        for _, variable, size in _SCALARS
        for index in range(size)
    ),
    *(f"{side}_bit_registers{first}_to_{first + 31}" for side in _SIDES for first in (0, 32)),
)
"""Variables of the recipe that is read with every picture."""

REGISTERS: Final = tuple(
    f"{side}_{kind}_register{index}"
    for side in _SIDES
    for kind, family in (("int", f"{side}_int_register"), ("double", f"{side}_float_register"))
    for index in range(SIGNALS[family].size)
)
"""Variables of a recipe of its own, with less haste."""

REGISTERS_HZ: Final = 5.0


def signals_of(values: Mapping[str, WireValue]) -> dict[str, Value]:
    """Return the signals that RTSI values show and that are not at their default, in the order of the table."""
    found: dict[str, dict[int, Value]] = {}

    def put(family: str, index: int, value: WireValue | None) -> None:
        if value is not None and not isinstance(value, tuple) and isfinite(value):
            is_whole = SIGNALS[family].kind == "int"
            found.setdefault(family, {})[index] = round(value) if is_whole and isinstance(value, float) else value

    for direction, word in (("in", "actual_digital_input_bits"), ("out", "actual_digital_output_bits")):
        for place, first in _DIGITAL:
            family = f"{place}_{direction}"
            for index in range(SIGNALS[family].size):
                put(family, index, _bit(values.get(word), first + index))
    for family, variable, size in _SCALARS:
        for index in range(size):
            put(family, index, values.get(variable.replace("#", str(index))))
    for side in _SIDES:
        for first in (0, 32):
            for bit in range(32):
                level = _bit(values.get(f"{side}_bit_registers{first}_to_{first + 31}"), bit)
                put(f"{side}_bool_register", first + bit, level)
        for kind, family in (("int", f"{side}_int_register"), ("double", f"{side}_float_register")):
            for index in range(SIGNALS[family].size):
                put(family, index, values.get(f"{side}_{kind}_register{index}"))
    return {
        signal_name(row, index): value
        for name, row in SIGNALS.items()
        for index, value in sorted(found.get(name, {}).items())
        if value != row.default
    }


def _bit(word: WireValue | None, bit: int) -> bool | None:
    return bool(word >> bit & 1) if isinstance(word, int) else None
