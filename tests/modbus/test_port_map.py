"""The registers and coils of the controller's own Modbus server, row by row."""

from __future__ import annotations

from typing import Any

import pytest

from elitescript.errors import ArgumentRangeError, InvalidValueError
from elitescript.messages.enums import AnalogDomain, RobotMode, SafetyMode
from elitescript.messages.machine import SetAnalogDomain, WriteSignal
from elitescript.modbus.port_image import PortImage, coil_writes, register_writes
from elitescript.modbus.port_map import COIL_COUNT, COILS, REGISTER_COUNT, REGISTERS, View
from tests.protocol.snapshots import snapshot


def image(**changes: Any) -> PortImage:
    return PortImage(View(snapshot(**changes), (2, 14, 5)))


def registers(first: int, count: int = 1, **changes: Any) -> list[int]:
    return image(**changes).registers(first, count)


def signed(values: list[int]) -> list[int]:
    return [value - 65536 if value > 32767 else value for value in values]


@pytest.mark.parametrize(
    ("address", "signals", "value"),
    [
        (0, {"standard_digital_in": {0: True, 15: True}}, 0x8001),
        (1, {"configurable_digital_in": {0: True, 7: True}, "tool_digital_in": {0: True, 3: True}}, 0x0981),
        (2, {"standard_digital_out": {1: True, 14: True}}, 0x4002),
        (3, {"configurable_digital_out": {2: True}, "tool_digital_out": {1: True}}, 0x0204),
        (4, {"standard_analog_in": {0: 9.9996}}, 10000),
        (6, {"standard_analog_in": {1: 0.0124}}, 12),
        (8, {"tool_analog_in": {0: 3.3}}, 3300),
        (10, {"standard_analog_out": {0: 0.02}}, 20),
        (12, {"standard_analog_out": {1: 5.0}}, 5000),
        (14, {"tool_analog_out": {0: 0.004}}, 4),
        (16, {"tool_voltage": {0: 24}}, 24),
        (256, {"general_register": {0: 65535}}, 65535),
        (383, {"general_register": {127: 1}}, 1),
    ],
)
def test_a_register_shows_its_signals(address: int, signals: Any, value: int) -> None:
    assert registers(address) == [0]
    assert registers(address, signals=signals) == [value]
    around = image(signals=signals).registers(0, REGISTER_COUNT)
    before = image().registers(0, REGISTER_COUNT)
    assert [at for at in range(REGISTER_COUNT) if around[at] != before[at]] == [address]


def test_domains_are_behind_their_levels() -> None:
    # Inputs 0 and 1, the tool's; outputs 0 and 1, the tool's; as the snapshot of the tests has them.
    assert [registers(address)[0] for address in (5, 7, 9, 11, 13, 15)] == [1, 0, 1, 0, 1, 0]


def test_state_is_in_registers() -> None:
    assert registers(63, 3) == [2, 14, 5]
    for mode in RobotMode:
        assert signed(registers(66, robot_mode=mode)) == [int(mode)]
    assert [mode.name for mode in RobotMode if registers(67, robot_mode=mode) == [1]] == [
        "BOOTING",
        "POWER_ON",
        "IDLE",
        "BACK_DRIVE",
        "RUNNING",
    ]


@pytest.mark.parametrize(
    ("address", "modes"),
    [
        (68, ["PROTECTIVE_STOP"]),
        (69, ["SYSTEM_EMERGENCY_STOP", "ROBOT_EMERGENCY_STOP"]),
        (70, ["REDUCED"]),
    ],
)
def test_safety_is_in_registers(address: int, modes: list[str]) -> None:
    assert [mode.name for mode in SafetyMode if registers(address, safety_mode=mode) == [1]] == modes
    assert {tuple(registers(address, safety_mode=mode)) for mode in SafetyMode} == {(0,), (1,)}


SIX = (0.5, -1.25, 2.0004, -3.0006, 0.0, 6.283)


@pytest.mark.parametrize(
    ("address", "field", "values"),
    [
        (73, "q_actual", [500, -1250, 2000, -3001, 0, 6283]),
        (84, "qd_actual", [500, -1250, 2000, -3001, 0, 6283]),
        (95, "joint_currents", [500, -1250, 2000, -3001, 0, 6283]),
        (105, "joint_temperatures", [0, -1, 2, -3, 0, 6]),
        (384, "tcp_pose_actual", [5000, -12500, 20004, -3001, 0, 6283]),
        (400, "tcp_speed_actual", [500, -1250, 2000, -3001, 0, 6283]),
        (410, "tcp_offset", [5000, -12500, 20004, -3001, 0, 6283]),
    ],
)
def test_six_values_are_signed_and_scaled(address: int, field: str, values: list[int]) -> None:
    assert signed(registers(address, 6, **{field: SIX})) == values
    assert all(0 <= value <= 65535 for value in registers(address, 6, **{field: SIX}))


def test_what_does_not_fit_shows_as_the_nearest() -> None:
    assert signed(registers(384, 6, tcp_pose_actual=(4.0, -4.0, 3.2767, -32.768, 40.0, -40.0))) == [
        32767,
        -32768,
        32767,
        -32768,
        32767,
        -32768,
    ]


def test_reserved_registers_read_as_0() -> None:
    for first, last in ((17, 62), (71, 72), (79, 83), (90, 94), (101, 104), (111, 255), (390, 399), (449, 511)):
        assert registers(first, last - first + 1) == [0] * (last - first + 1)


@pytest.mark.parametrize(
    ("address", "family", "index"),
    [
        (0, "standard_digital_in", 0),
        (15, "standard_digital_in", 15),
        (16, "configurable_digital_in", 0),
        (23, "configurable_digital_in", 7),
        (24, "tool_digital_in", 0),
        (27, "tool_digital_in", 3),
        (32, "standard_digital_out", 0),
        (47, "standard_digital_out", 15),
        (48, "configurable_digital_out", 0),
        (55, "configurable_digital_out", 7),
        (56, "tool_digital_out", 0),
        (59, "tool_digital_out", 3),
        (60, "general_coil", 0),
        (127, "general_coil", 67),
    ],
)
def test_a_coil_is_a_point(address: int, family: str, index: int) -> None:
    levels = image(signals={family: {index: True}}).coils(0, COIL_COUNT)
    assert [at for at, level in enumerate(levels) if level] == [address]
    if address < 32:
        with pytest.raises(InvalidValueError, match=f"coil {address} .*digital inputs.* cannot be written"):
            coil_writes(address, [True])
    else:
        assert coil_writes(address, [True]) == [WriteSignal(family, index, True)]


def test_coils_that_are_not_there_read_as_low_and_are_not_written() -> None:
    assert image().coils(28, 4) == [False] * 4
    with pytest.raises(InvalidValueError, match=r"coil 28 \(reserved\) cannot be written"):
        coil_writes(28, [True])


def test_ranges_are_put_together() -> None:
    whole = image(signals={"general_register": {index: index + 1 for index in range(128)}})
    everything = whole.registers(0, REGISTER_COUNT)
    for first in (0, 3, 60, 70, 250, 300, 380, 500):
        for count in (1, 2, 12):
            assert whole.registers(first, count) == everything[first : first + count]
    levels = image(signals={"standard_digital_out": {15: True}, "general_coil": {0: True}}).coils(40, 30)
    assert [40 + at for at, level in enumerate(levels) if level] == [47, 60]


@pytest.mark.parametrize(
    ("first", "values", "requests"),
    [
        (11, [0], [SetAnalogDomain("standard_analog_out", 0, AnalogDomain.CURRENT)]),
        (5, [1], [SetAnalogDomain("standard_analog_in", 0, AnalogDomain.VOLTAGE)]),
        (9, [0], [SetAnalogDomain("tool_analog_in", 0, AnalogDomain.CURRENT)]),
        (12, [2500], [WriteSignal("standard_analog_out", 1, 2.5)]),
        (14, [7], [WriteSignal("tool_analog_out", 0, 0.007)]),
        (16, [12], [WriteSignal("tool_voltage", 0, 12)]),
        (256, [9, 65535], [WriteSignal("general_register", 0, 9), WriteSignal("general_register", 1, 65535)]),
        (2, [0x8001], [WriteSignal("standard_digital_out", index, index in (0, 15)) for index in range(16)]),
        (
            3,
            [0x0180],
            [
                *(WriteSignal("configurable_digital_out", index, index == 7) for index in range(8)),
                *(WriteSignal("tool_digital_out", index, index == 0) for index in range(4)),
            ],
        ),
    ],
)
def test_writing_a_register_asks_for_its_points(first: int, values: list[int], requests: list[Any]) -> None:
    assert register_writes(first, values) == requests


@pytest.mark.parametrize(
    ("first", "values", "message"),
    [
        (0, [1], r"register 0 \(standard digital inputs\) cannot be written"),
        (4, [1], r"register 4 \(analog input 0\) cannot be written"),
        (17, [1], r"register 17 \(reserved\) cannot be written"),
        (71, [1], r"register 71 \(reserved\) cannot be written"),
        (16, [12, 1], r"register 17 \(reserved\) cannot be written"),
        (383, [1, 1], r"register 384 \(TCP: .*\) cannot be written"),
        (3, [0x1000], "register 3: 0x1000 sets bits that no output has; the bits are 0x0fff"),
    ],
)
def test_what_cannot_be_written_is_refused(first: int, values: list[int], message: str) -> None:
    with pytest.raises(InvalidValueError, match=message):
        register_writes(first, values)


@pytest.mark.parametrize(
    ("first", "values", "message"),
    [
        (11, [2], r"register 11: a domain is 0 \(current\) or 1 \(voltage\), got 2"),
        (16, [13], "register 16: the tool voltage is 0, 12 or 24 V, got 13"),
        (256, [65536], r"register 256 must be in \[0, 65535\], got 65536"),
        (512, [0], "there is no register 512; the addresses are 0 to 511"),
        (511, [0, 0], "there is no register 511 to 512"),
    ],
)
def test_values_and_addresses_out_of_range_are_refused(first: int, values: list[int], message: str) -> None:
    with pytest.raises(ArgumentRangeError, match=message):
        register_writes(first, values)


def test_rows_do_not_overlap_and_stay_within_the_table() -> None:
    for rows, count in ((REGISTERS, REGISTER_COUNT), (COILS, COIL_COUNT)):
        taken = [address for row in rows for address in range(row.first, row.first + row.size)]
        assert len(taken) == len(set(taken))
        assert taken == sorted(taken)
        assert taken[-1] == count - 1
    view = View(snapshot(), (2, 14, 5))
    assert all(len(row.read(view)) == row.size for row in REGISTERS)


def test_reading_beyond_the_table_is_refused() -> None:
    for first, count in ((0, 513), (512, 1), (-1, 2)):
        with pytest.raises(ArgumentRangeError):
            registers(first, count)
    with pytest.raises(ArgumentRangeError, match="there is no coil 128"):
        image().coils(128, 1)
