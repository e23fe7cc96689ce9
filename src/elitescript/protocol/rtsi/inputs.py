"""The table of RTSI input variables: names, types, and their requests to the machine.

An *effect* belongs to one or a few variables together, such as a mask and its levels. It is applied with every package
that holds any of its variables, with the newest value of each that the client has sent; before the client has sent all
of them there is no effect (*assumed*).

Clients repeat all their values whenever one changes. Outputs, speed and analog channels are written each time, since a
program may have changed them in between. A register belongs to one client at a time and is written only with a new
value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import isfinite
from typing import Final, TypeAlias

from elitescript.messages.enums import AnalogDomain
from elitescript.messages.machine import MachineRequest, SetAnalogDomain, SetAnalogFraction, SetSpeedScale, WriteSignal
from elitescript.messages.signals import SIGNALS
from elitescript.messages.snapshot import Snapshot
from elitescript.protocol.binary import (
    BOOL,
    DOUBLE,
    INT32,
    UINT8,
    UINT16,
    UINT32,
    VECTOR6D,
    WireType,
    WireValue,
    packed_bits,
)
from elitescript.protocol.rtsi.variables import ASSUMED, BIT_REGISTERS, CLIENT, THIRD, WORDS
from elitescript.records import NamedTuple

Values: TypeAlias = Mapping[str, WireValue]

_ANALOG_OUT: Final = "standard_analog_out"
_WRENCH: Final = "external_force_torque"
_ALL_BITS: Final = 2**32 - 1


class InputVariable(NamedTuple):
    """One row: a variable, or a family of numbered ones."""

    name: str
    """`#` stands for the index of a family."""
    type: WireType
    unit: str
    summary: str
    indices: range = range(1)
    evidence: str = CLIENT


INPUT_ROWS: Final[tuple[InputVariable, ...]] = (
    InputVariable("speed_slider_mask", UINT32, "", "1: the fraction applies; 0: it does not"),
    InputVariable("speed_slider_fraction", DOUBLE, "", "speed slider, 0 to 1"),
    InputVariable("standard_digital_output_mask", UINT16, "", "bit i: output i is to be set"),
    InputVariable("standard_digital_output", UINT16, "", "bit i: level of output i"),
    InputVariable("configurable_digital_output_mask", UINT8, "", "bit i: output i is to be set"),
    InputVariable("configurable_digital_output", UINT8, "", "bit i: level of output i"),
    InputVariable("tool_digital_output_mask", UINT8, "", "bit i: pin i is to be set"),
    InputVariable("tool_digital_output", UINT8, "", "bit i: level of pin i"),
    InputVariable("standard_analog_output_mask", UINT8, "", "bit i: output i is to be set"),
    InputVariable(
        "standard_analog_output_type",
        UINT8,
        "",
        "bit i: domain of output i, 0 current, 1 voltage; without effect where the mask has 0",
        evidence=f"{CLIENT}; use of the mask {ASSUMED}",
    ),
    InputVariable(
        "standard_analog_output_#",
        DOUBLE,
        "",
        "fraction of the range of the domain, 0 to 1: 4 to 20 mA or 0 to 10 V",
        range(2),
    ),
    InputVariable(
        _WRENCH,
        VECTOR6D,
        "N, N m",
        "readings of a client's force sensor; used once a program has enabled them",
        evidence=f"{CLIENT}, documented",
    ),
    *(
        InputVariable(
            f"input_bit_registers{first}_to_{first + 31}",
            UINT32,
            "",
            f"boolean registers {first} to {first + 31}; the lowest bit is register {first}",
        )
        for first in WORDS
    ),
    InputVariable("input_bit_register#", BOOL, "", "boolean register", BIT_REGISTERS, THIRD),
    InputVariable(
        "input_int_register#",
        INT32,
        "",
        "integer register",
        range(SIGNALS["input_int_register"].size),
        f"{THIRD}; range {ASSUMED}",
    ),
    InputVariable(
        "input_double_register#",
        DOUBLE,
        "",
        "float register",
        range(SIGNALS["input_float_register"].size),
        f"{THIRD}; range {ASSUMED}",
    ),
)

INPUTS: Final[dict[str, WireType]] = {
    row.name.replace("#", str(index)): row.type for row in INPUT_ROWS for index in row.indices
}
"""Every name that an input recipe may hold."""


class Arrival(NamedTuple):
    """A package of inputs and the data for its effects."""

    values: Values
    """Newest value of every variable that the client has sent, those of the package included."""
    previous: Values
    """The same before the package."""
    snapshot: Snapshot
    """Of the last tick."""
    problems: dict[str, str]
    """Values that could not be applied, by variable; filled by effects."""

    def integer(self, name: str) -> int:
        """Return the value of an integer variable."""
        value = self.values[name]
        assert isinstance(value, int)
        return value

    def real(self, name: str) -> float:
        """Return the value of a DOUBLE."""
        value = self.values[name]
        assert isinstance(value, float)
        return value


Requests: TypeAlias = Iterator[MachineRequest]


class InputEffect(NamedTuple):
    """Effect of some variables together."""

    variables: tuple[str, ...]
    requests: Callable[[Arrival], Requests]


def _is_fraction(arrival: Arrival, name: str) -> bool:
    if 0.0 <= arrival.real(name) <= 1.0:
        return True
    arrival.problems[name] = f"{name} must be in [0, 1], got {arrival.real(name):g}; it was not applied"
    return False


def _speed_slider(arrival: Arrival) -> Requests:
    if arrival.integer("speed_slider_mask") & 1 and _is_fraction(arrival, "speed_slider_fraction"):
        yield SetSpeedScale(arrival.real("speed_slider_fraction"))


def _digital_outputs(place: str) -> InputEffect:
    family, levels = f"{place}_digital_out", f"{place}_digital_output"
    size, mask = SIGNALS[family].size, f"{levels}_mask"

    def requests(arrival: Arrival) -> Requests:
        chosen, word = arrival.integer(mask), arrival.integer(levels)
        if chosen >> size:
            arrival.problems[mask] = f"{mask} is {chosen:#x}, but there are {size} outputs; the others were not set"
        for index in range(size):
            if chosen >> index & 1:
                yield WriteSignal(family, index, bool(word >> index & 1))

    return InputEffect((mask, levels), requests)


def _analog_output(index: int) -> InputEffect:
    mask, domains, fraction = (f"standard_analog_output_{part}" for part in ("mask", "type", str(index)))

    def requests(arrival: Arrival) -> Requests:
        if arrival.integer(mask) >> index & 1 and _is_fraction(arrival, fraction):
            domain = AnalogDomain(arrival.integer(domains) >> index & 1)
            yield SetAnalogDomain(_ANALOG_OUT, index, domain)
            yield SetAnalogFraction(_ANALOG_OUT, index, arrival.real(fraction))

    return InputEffect((mask, domains, fraction), requests)


def _register_word(first: int) -> InputEffect:
    name, family = f"input_bit_registers{first}_to_{first + 31}", "input_bool_register"

    def requests(arrival: Arrival) -> Requests:
        word = arrival.integer(name)
        news = word ^ packed_bits(arrival.snapshot.signals[family][first : first + 32])
        before = arrival.previous.get(name)
        news |= word ^ before if isinstance(before, int) else _ALL_BITS
        while news:
            bit = (news & -news).bit_length() - 1
            news &= news - 1
            yield WriteSignal(family, first + bit, bool(word >> bit & 1))

    return InputEffect((name,), requests)


def _register(name: str, family: str, index: int) -> InputEffect:
    def requests(arrival: Arrival) -> Requests:
        value = arrival.values[name]
        assert not isinstance(value, tuple)
        if isinstance(value, float) and not isfinite(value):
            arrival.problems[name] = f"{name} must be a finite number, got {value}; it was not written"
        elif arrival.previous.get(name) != value or arrival.snapshot.signals[family][index] != value:
            yield WriteSignal(family, index, value)

    return InputEffect((name,), requests)


def _force_torque(arrival: Arrival) -> Requests:
    wrench, before = arrival.values[_WRENCH], arrival.previous.get(_WRENCH)
    assert isinstance(wrench, tuple)
    if not all(map(isfinite, wrench)):
        arrival.problems[_WRENCH] = f"{_WRENCH} must be six finite numbers, got {wrench}; it was not written"
    elif wrench != before or arrival.snapshot.signals[_WRENCH] != wrench:
        for index, value in enumerate(wrench):
            yield WriteSignal(_WRENCH, index, value)


EFFECTS: Final[tuple[InputEffect, ...]] = (
    InputEffect(("speed_slider_mask", "speed_slider_fraction"), _speed_slider),
    *(_digital_outputs(place) for place in ("standard", "configurable", "tool")),
    *(_analog_output(index) for index in range(SIGNALS[_ANALOG_OUT].size)),
    InputEffect((_WRENCH,), _force_torque),
    *(_register_word(first) for first in WORDS),
    *(_register(f"input_bit_register{index}", "input_bool_register", index) for index in BIT_REGISTERS),
    *(
        _register(f"input_{kind}_register{index}", family, index)
        for kind, family in (("int", "input_int_register"), ("double", "input_float_register"))
        for index in range(SIGNALS[family].size)
    ),
)


def effects_of(names: tuple[str, ...]) -> tuple[InputEffect, ...]:
    """Return the effects of a package with these variables."""
    held = frozenset(names)
    return tuple(effect for effect in EFFECTS if not held.isdisjoint(effect.variables))


def requests_of(effects: tuple[InputEffect, ...], arrival: Arrival) -> Iterator[MachineRequest]:
    """Yield the requests of a package: of every effect whose variables are all known."""
    for effect in effects:
        if all(name in arrival.values for name in effect.variables):
            yield from effect.requests(arrival)
