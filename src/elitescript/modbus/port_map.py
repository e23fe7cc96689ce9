"""The table of the registers and coils of the controller's own Modbus server.

`REGISTERS` and `COILS` are the only place with the meaning, scale and access of each address. Clients
(`protocol.modbus_port`), programs (`read_port_...`, `write_port_...`) and the reference page use them through
`modbus.port_image`.

Evidence: addresses and meanings marked *documented* are those of the vendor's public sheet of the server. It is cut off
in places, where it shows only that a block exists: meaning and unit of those are *assumed* from their sizes and their
order. Also *assumed*: an address below 512 without a row reads as 0, a value beyond 16 bits shows as the nearest that
fits, functions 1 and 2, and 3 and 4, read the same table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import reduce
from operator import or_
from typing import Final, Protocol

from elitescript.errors import ArgumentRangeError, InvalidValueError
from elitescript.messages.enums import POWERED, AnalogDomain, SafetyMode
from elitescript.messages.machine import MachineRequest, SetAnalogDomain, WriteSignal
from elitescript.messages.motion import Six
from elitescript.messages.signals import SIGNALS, WORD_MAX, Value
from elitescript.messages.snapshot_parts import JOINTS, LOADS, POSES, TCP_SPEEDS, TEMPERATURES
from elitescript.messages.state import RobotState
from elitescript.records import NamedTuple
from elitescript.said import said

COIL_COUNT: Final = 128
REGISTER_COUNT: Final = 512
GENERAL_COIL: Final = 60
"""Address of the first coil without a meaning of its own, for clients and programs."""
GENERAL_REGISTER: Final = 256

DOCUMENTED: Final = "documented"
ASSUMED: Final = "*assumed*"
_MEANING_ASSUMED: Final = f"block documented, meaning and unit {ASSUMED}"

_SHORT_MAX: Final = 2**15 - 1
_STOPPED_BY_BUTTON: Final = frozenset({SafetyMode.ROBOT_EMERGENCY_STOP, SafetyMode.SYSTEM_EMERGENCY_STOP})
_VOLTAGES: Final = (0, 12, 24)
_MILLI: Final = 1e3
_TENTH_MM: Final = 1e4


class PortSource(Protocol):
    """Part of a machine's state that the table reads; a `Snapshot` is one."""

    @property
    def robot(self) -> RobotState: ...

    @property
    def joint_currents(self) -> Six:
        """A."""

    @property
    def joint_temperatures(self) -> Six:
        """degC."""

    @property
    def signals(self) -> Mapping[str, tuple[Value, ...]]: ...

    @property
    def domains(self) -> Mapping[str, tuple[AnalogDomain, ...]]: ...


class View(NamedTuple):
    """A machine at one tick."""

    snapshot: PortSource
    version: tuple[int, ...]
    """Of the controller: major, minor, bug fix."""


Words = Sequence[int]
Write = Callable[[int, int], Iterator[MachineRequest]]
"""Takes the index in the block and the value; yields the requests to the machine.

Raises:
    ScriptError: an invalid value.
"""


class RegisterRow(NamedTuple):
    """A register, or a block of them."""

    first: int
    size: int
    content: str
    unit: str
    evidence: str
    read: Callable[[View], Words]
    """All registers of the block, 0 to 65535 each."""
    write: Write | None = None
    """None for read-only registers."""
    parts: int = 0
    """Of the snapshot that it reads, as bits; 0 for the discrete state."""


class CoilRow(NamedTuple):
    """A block of coils, each of which is a point of a family of signals."""

    first: int
    size: int
    content: str
    evidence: str
    family: str
    point: int
    """Index of the point that is the first coil."""
    is_writable: bool


# ---------------------------------------------------------------------------------------------------- reads and writes


def _short(value: float) -> int:
    """Return the nearest signed 16-bit number, as a register holds it."""
    return max(-_SHORT_MAX - 1, min(_SHORT_MAX, round(value))) & WORD_MAX


class _Part(NamedTuple):
    """A family of signals in a register, one bit each."""

    family: str
    shift: int


def _bits(*parts: _Part) -> Callable[[View], Words]:
    def read(view: View) -> Words:
        word = 0
        for family, shift in parts:
            for bit, level in enumerate(view.snapshot.signals[family], shift):
                word |= bool(level) << bit
        return (word,)

    return read


def _set_bits(*parts: _Part) -> Write:
    known = sum(((1 << SIGNALS[family].size) - 1) << shift for family, shift in parts)

    def write(_index: int, word: int) -> Iterator[MachineRequest]:
        if word & ~known:
            raise InvalidValueError(
                said("{word:#06x} sets bits that no output has; the bits are {known:#06x}", word=word, known=known),
                value=word,
                limit=f"bits of {known:#06x}",
            )
        for family, shift in parts:
            for index in range(SIGNALS[family].size):
                yield WriteSignal(family, index, bool(word >> shift + index & 1))

    return write


def _level(family: str, index: int) -> Callable[[View], Words]:
    return lambda view: (_short(float(view.snapshot.signals[family][index]) * _MILLI),)


def _set_level(family: str, channel: int) -> Write:
    def write(_index: int, value: int) -> Iterator[MachineRequest]:
        yield WriteSignal(family, channel, value / _MILLI)

    return write


def _domain(family: str, index: int) -> Callable[[View], Words]:
    return lambda view: (int(view.snapshot.domains[family][index]),)


def _set_domain(family: str, channel: int) -> Write:
    def write(_index: int, value: int) -> Iterator[MachineRequest]:
        if value not in (0, 1):
            raise ArgumentRangeError(
                said("a domain is 0 (current) or 1 (voltage), got {value}", value=value), value=value, limit="0 or 1"
            )
        yield SetAnalogDomain(family, channel, AnalogDomain(value))

    return write


def _set_voltage(_index: int, value: int) -> Iterator[MachineRequest]:
    if value not in _VOLTAGES:
        raise ArgumentRangeError(
            said("the tool voltage is 0, 12 or 24 V, got {value}", value=value),
            value=value,
            limit="0, 12 or 24",
            unit="V",
        )
    yield WriteSignal("tool_voltage", 0, value)


def _general(view: View) -> Words:
    values: Sequence[Value] = view.snapshot.signals["general_register"]
    return [int(value) for value in values]


def _set_general(index: int, value: int) -> Iterator[MachineRequest]:
    yield WriteSignal("general_register", index, value)


def _number(value: Callable[[PortSource], int]) -> Callable[[View], Words]:
    return lambda view: (value(view.snapshot) & WORD_MAX,)


def _zeros(size: int) -> Callable[[View], Words]:
    return lambda _view: (0,) * size


# ---------------------------------------------------------------------------------------------------- the tables

_CONFIGURABLE_AND_TOOL: Final = {
    side: (_Part(f"configurable_digital_{side}", 0), _Part(f"tool_digital_{side}", 8)) for side in ("in", "out")
}
_STANDARD: Final = {side: _Part(f"standard_digital_{side}", 0) for side in ("in", "out")}


def _row(first: int, content: str, unit: str, read: Callable[[View], Words], write: Write | None = None) -> RegisterRow:
    return RegisterRow(first, 1, content, unit, DOCUMENTED, read, write)


def _channel(first: int, content: str, family: str, index: int = 0) -> tuple[RegisterRow, RegisterRow]:
    set_level = None if SIGNALS[family].is_input else _set_level(family, index)
    return (
        _row(first, content, "mA or mV", _level(family, index), set_level),
        _row(
            first + 1,
            f"domain of {content}",
            "0 current, 1 voltage",
            _domain(family, index),
            _set_domain(family, index),
        ),
    )


def _six_row(
    first: int,
    content: str,
    unit: str,
    values: Callable[[PortSource], Six],
    parts: int,
    *scales: float,
    evidence: str = _MEANING_ASSUMED,
) -> RegisterRow:
    """Return a block of six signed values; the scales are those of the first and the last three, or one for all."""
    factors = (scales[0],) * 3 + (scales[-1],) * 3

    def read(view: View) -> Words:
        return [_short(value * factor) for value, factor in zip(values(view.snapshot), factors, strict=True)]

    return RegisterRow(first, 6, content, unit, evidence, read, parts=parts)


def _reserved(first: int, last: int) -> RegisterRow:
    size = last - first + 1
    return RegisterRow(first, size, "reserved", "", f"{DOCUMENTED}; reads as 0 {ASSUMED}", _zeros(size))


REGISTERS: Final[tuple[RegisterRow, ...]] = (
    _row(0, "standard digital inputs", "bit i: input i", _bits(_STANDARD["in"])),
    _row(
        1,
        "configurable digital inputs, tool digital inputs",
        "bits 0 to 7, bits 8 to 11",
        _bits(*_CONFIGURABLE_AND_TOOL["in"]),
    ),
    _row(2, "standard digital outputs", "bit i: output i", _bits(_STANDARD["out"]), _set_bits(_STANDARD["out"])),
    _row(
        3,
        "configurable digital outputs, tool digital outputs",
        "bits 0 to 7, bits 8 to 11",
        _bits(*_CONFIGURABLE_AND_TOOL["out"]),
        _set_bits(*_CONFIGURABLE_AND_TOOL["out"]),
    ),
    *_channel(4, "analog input 0", "standard_analog_in", 0),
    *_channel(6, "analog input 1", "standard_analog_in", 1),
    *_channel(8, "tool analog input", "tool_analog_in"),
    *_channel(10, "analog output 0", "standard_analog_out", 0),
    *_channel(12, "analog output 1", "standard_analog_out", 1),
    *_channel(14, "tool analog output", "tool_analog_out"),
    _row(16, "tool voltage: 0, 12 or 24", "V", _number(lambda p: int(p.signals["tool_voltage"][0])), _set_voltage),
    _reserved(17, 62),
    RegisterRow(63, 3, "controller version: major, minor, bug fix", "", DOCUMENTED, lambda view: view.version[:3]),
    _row(66, "robot mode, as RTSI numbers it", "", _number(lambda p: int(p.robot.robot_mode))),
    _row(67, "power is on", "0 or 1", _number(lambda p: p.robot.robot_mode in POWERED)),
    _row(68, "protective stop", "0 or 1", _number(lambda p: p.robot.safety_mode is SafetyMode.PROTECTIVE_STOP)),
    _row(69, "emergency stop", "0 or 1", _number(lambda p: p.robot.safety_mode in _STOPPED_BY_BUTTON)),
    _row(70, "reduced mode", "0 or 1", _number(lambda p: p.robot.safety_mode is SafetyMode.REDUCED)),
    _six_row(73, "joint positions", "mrad, signed", lambda p: p.robot.q_actual, JOINTS, _MILLI, evidence=DOCUMENTED),
    _six_row(84, "joint velocities", "mrad/s, signed", lambda p: p.robot.qd_actual, JOINTS, _MILLI),
    _six_row(95, "joint currents", "mA, signed", lambda p: p.joint_currents, LOADS, _MILLI),
    _six_row(105, "joint temperatures", "degC", lambda p: p.joint_temperatures, TEMPERATURES, 1.0),
    RegisterRow(
        GENERAL_REGISTER,
        SIGNALS["general_register"].size,
        "general purpose: kept; only clients and programs use them",
        "",
        DOCUMENTED,
        _general,
        _set_general,
    ),
    _six_row(
        384,
        "TCP: x, y, z, rx, ry, rz (roll-pitch-yaw), base frame",
        "0.1 mm, mrad, signed",
        lambda p: p.robot.tcp_pose_actual,
        POSES,
        _TENTH_MM,
        _MILLI,
    ),
    _six_row(
        400,
        "velocity of the TCP, base frame",
        "mm/s, mrad/s, signed",
        lambda p: p.robot.tcp_speed_actual,
        TCP_SPEEDS,
        _MILLI,
    ),
    _six_row(
        410, "TCP offset from the flange", "0.1 mm, mrad, signed", lambda p: p.robot.tcp_offset, 0, _TENTH_MM, _MILLI
    ),
    _reserved(449, 511),
)

REGISTER_PARTS: Final = reduce(or_, (row.parts for row in REGISTERS))
"""Parts of the snapshot that registers read, as bits; coils read levels alone."""

COILS: Final[tuple[CoilRow, ...]] = (
    CoilRow(0, 16, "standard digital inputs", DOCUMENTED, "standard_digital_in", 0, False),
    CoilRow(16, 8, "configurable digital inputs", DOCUMENTED, "configurable_digital_in", 0, False),
    CoilRow(24, 4, "tool digital inputs", ASSUMED, "tool_digital_in", 0, False),
    CoilRow(32, 16, "standard digital outputs", DOCUMENTED, "standard_digital_out", 0, True),
    CoilRow(48, 8, "configurable digital outputs", DOCUMENTED, "configurable_digital_out", 0, True),
    CoilRow(56, 4, "tool digital outputs", DOCUMENTED, "tool_digital_out", 0, True),
    CoilRow(
        GENERAL_COIL,
        SIGNALS["general_coil"].size,
        "general purpose: kept; only clients and programs use them",
        DOCUMENTED,
        "general_coil",
        0,
        True,
    ),
)
