"""Signals of a controller that its picture shows: which variables are read, and how often."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import Final

from elitescript.client.rtsi_signals import POINTS, levels_of
from elitescript.messages.signals import SIGNALS, Value, parse_signal_name
from elitescript.protocol.binary import WireValue

FAST: Final = tuple(name for name in POINTS if "_register" not in name or "_to_" in name)
"""Variables of the recipe that is read with every picture."""

REGISTERS: Final = tuple(name for name in POINTS if "_int_register" in name or "_double_register" in name)
"""Variables of a recipe of its own, with less haste."""

REGISTERS_HZ: Final = 5.0

_ORDER: Final = {name: place for place, name in enumerate(SIGNALS)}


def signals_of(values: Mapping[str, WireValue]) -> dict[str, Value]:
    """Return the signals that RTSI values show and that are not at their default, in the order of the table."""
    found: list[tuple[int, int, str, Value]] = []
    for variable in POINTS:
        number = values.get(variable)
        if number is not None and not isinstance(number, tuple) and isfinite(number):
            for name, level in levels_of(variable, number).items():
                row, index = parse_signal_name(name)
                if level != row.default:
                    found.append((_ORDER[row.name], index, name, level))
    return {name: level for *_, name, level in sorted(found)}
