"""The table of I/O points, registers and flags.

One row per family. Its name is what `--set`, `robot.signals` and the end record use; protocols,
commands and the pendant derive theirs from here.

Evidence: counts and ranges are *documented* (manual 2.10, I/O and register chapters; the vendor's sheet of the Modbus
server); that a tool pin has separate in and out images is *assumed*. That flags and registers outlast a restart of the
controller is *assumed* from the manual: flags keep their value between programs, registers are in system memory. The
last rows are set by tests and devices; no program reads them as signals.
"""

from __future__ import annotations

from functools import cache, partial
from typing import Final

from elitescript.errors import UsageError, did_you_mean
from elitescript.records import NamedTuple

Value = bool | int | float


class Signal(NamedTuple):
    """One family of signals."""

    name: str
    kind: str
    """`bool`, `int` or `float`."""
    size: int
    """Number of points; the point of a family of one is written without an index."""
    is_input: bool
    """Set from outside (a sensor, a client), read by programs."""
    low: float | None = None
    high: float | None = None
    unit: str = ""
    summary: str = ""
    is_kept: bool = False
    """Whether a state file holds it: the controller keeps it when it is switched off."""

    @property
    def has_domain(self) -> bool:
        """Whether each point is a voltage or a current by choice."""
        return self.unit == "V or A"

    @property
    def default(self) -> Value:
        """Value at power-on."""
        return {"bool": False, "int": 0, "float": 0.0}[self.kind]


INT32_LOW: Final = -(2**31)
INT32_HIGH: Final = 2**31 - 1
WORD_MAX: Final = 2**16 - 1
ANALOG_CURRENT_A: Final = (0.004, 0.020)
ANALOG_VOLTAGE_V: Final = (0.0, 10.0)

_kept = partial(Signal, is_kept=True)

_ROWS: Final = (
    Signal("standard_digital_in", "bool", 16, True, summary="digital inputs of the control box"),
    Signal("standard_digital_out", "bool", 16, False, summary="digital outputs of the control box"),
    Signal("configurable_digital_in", "bool", 8, True, summary="configurable inputs of the control box"),
    Signal("configurable_digital_out", "bool", 8, False, summary="configurable outputs of the control box"),
    Signal("tool_digital_in", "bool", 4, True, summary="level applied from outside to a tool pin"),
    Signal("tool_digital_out", "bool", 4, False, summary="level that the controller drives on a tool pin"),
    Signal("standard_analog_in", "float", 2, True, 0.0, 10.0, "V or A", "analog inputs of the control box"),
    Signal("standard_analog_out", "float", 2, False, 0.0, 10.0, "V or A", "analog outputs of the control box"),
    Signal("tool_analog_in", "float", 1, True, 0.0, 10.0, "V or A", "analog input of the tool"),
    Signal("tool_analog_out", "float", 1, False, 0.0, 10.0, "V or A", "analog output of the tool"),
    Signal("tool_voltage", "int", 1, False, 0, 24, "V", "supply of the tool connector: 0, 12 or 24"),
    _kept("input_bool_register", "bool", 128, True, summary="boolean registers that clients write"),
    _kept("input_int_register", "int", 48, True, INT32_LOW, INT32_HIGH, summary="integer registers of clients"),
    _kept("input_float_register", "float", 48, True, summary="float registers that clients write"),
    _kept("output_bool_register", "bool", 128, False, summary="boolean registers that programs write"),
    _kept("output_int_register", "int", 48, False, INT32_LOW, INT32_HIGH, summary="integer registers of programs"),
    _kept("output_float_register", "float", 48, False, summary="float registers that programs write"),
    _kept("flag", "bool", 32, False, summary="internal flags, kept from one program to the next"),
    _kept("general_register", "int", 128, False, 0, WORD_MAX, summary="Modbus registers 256 to 383"),
    _kept("general_coil", "bool", 68, False, summary="Modbus coils 60 to 127"),
    Signal("emergency_stop", "bool", 1, True, summary="an emergency stop button is pressed"),
    Signal("system_emergency_stop", "bool", 1, True, summary="an emergency stop button of the cell is pressed"),
    Signal("safeguard_stop", "bool", 1, True, summary="a safeguard, such as a door, is open"),
    Signal("reduced_mode", "bool", 1, True, summary="the reduced safety limits are asked for"),
    Signal("external_wrench", "float", 6, True, None, None, "N, N m", "what pushes the TCP, in the base frame"),
    Signal("external_force_torque", "float", 6, True, None, None, "N, N m", "readings of a client's own force sensor"),
    Signal("encoder_speed", "float", 2, True, None, None, "1/s", "simulated conveyor encoders, in quadrature counts"),
)

SIGNALS: Final[dict[str, Signal]] = {row.name: row for row in _ROWS}
KEPT: Final = tuple(row.name for row in _ROWS if row.is_kept)
"""Families that the controller keeps when it is switched off."""


def parse_signal_name(text: str) -> tuple[Signal, int]:
    """Split `standard_digital_in[3]` into its row and its index; `tool_analog_in` has index 0.

    Raises:
        UsageError: unknown family, missing or wrong index.
    """
    name, bracket, rest = text.strip().partition("[")
    signal = SIGNALS.get(name.strip())
    if signal is None:
        near = did_you_mean(name.strip(), SIGNALS)
        raise UsageError(f"no signal is called {name.strip()!r}{near or '; there are ' + ', '.join(SIGNALS)}")
    if not bracket:
        if signal.size > 1:
            raise UsageError(f"{name} needs an index: {name}[0] to {name}[{signal.size - 1}]")
        return signal, 0
    if not rest.endswith("]") or not rest[:-1].strip().isdecimal():
        raise UsageError(f"{text!r}: write the index as a number in brackets, such as {name}[0]")
    digits = rest[:-1].strip()
    index = int(digits) if len(digits) < 10 else signal.size
    if index >= signal.size:
        raise UsageError(f"{name} has indices 0 to {signal.size - 1}, not {digits[:40]}")
    return signal, index


def signal_name(signal: Signal, index: int) -> str:
    """Return the name under which one point of a family is addressed."""
    return signal.name if signal.size == 1 else f"{signal.name}[{index}]"


@cache
def point_names(family: str) -> tuple[str, ...]:
    """Return the names under which the points of a family are addressed."""
    signal = SIGNALS[family]
    return tuple(signal_name(signal, index) for index in range(signal.size))
