"""The table of output variables: each name reads what it says."""

from __future__ import annotations

import random
import struct
from typing import Any

import pytest

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.protocol.rtsi.variables import OUTPUT_ROWS, OUTPUTS
from tests.protocol.rtsi_client import SIZES, STANDARD_OUTPUTS
from tests.protocol.snapshots import six, snapshot

EXPECTED: dict[str, Any] = {
    "timestamp": 4.0,
    "payload_mass": 1.25,
    "payload_cog": (0.01, 0.02, 0.03),
    "script_control_line": 17,
    "target_joint_positions": six(0.0),
    "target_joint_speeds": six(1.0),
    "actual_joint_torques": six(10.0),
    "actual_joint_positions": six(2.0),
    "actual_joint_speeds": six(3.0),
    "actual_joint_current": six(11.0),
    "actual_TCP_pose": six(6.0),
    "actual_TCP_speed": six(8.0),
    "actual_TCP_force": six(14.0),
    "target_TCP_pose": six(5.0),
    "target_TCP_speed": six(7.0),
    "actual_digital_input_bits": 0,
    "actual_digital_output_bits": 0,
    "joint_temperatures": six(12.0),
    "robot_mode": 7,
    "joint_mode": (253,) * 6,
    "safety_status": 1,
    "safety_mode": 1,
    "speed_scaling": 0.625,
    "target_speed_fraction": 0.75,
    "actual_robot_voltage": 48.5,
    "actual_robot_current": 1.5,
    "runtime_state": 3,
    "elbow_position": (16.0, 16.1, 16.2),
    "elbow_velocity": (17.0, 17.1, 17.2),
    "robot_status_bits": 0b001,
    "safety_status_bits": 0b1,
    "analog_io_types": 0b1001,
    "io_current": 0.125,
    "tool_mode": 253,
    "tool_analog_input_types": 1,
    "tool_analog_output_types": 0,
    "tool_output_current": 0.0625,
    "tool_temperature": 29.5,
    "tool_digital_mode": 0,
    "tool_digital0_mode": 0,
    "tool_digital1_mode": 1,
    "tool_digital2_mode": 2,
    "tool_digital3_mode": 1,
    "ft_raw_wrench": six(15.0),
    "actual_current": six(11.0),
    "actual_joint_voltage": six(13.0),
}
POINTS: dict[str, tuple[str, int, Any]] = {
    "standard_analog_input0": ("standard_analog_in", 0, 1.5),
    "standard_analog_input1": ("standard_analog_in", 1, 0.008),
    "standard_analog_output0": ("standard_analog_out", 0, 0.012),
    "standard_analog_output1": ("standard_analog_out", 1, 9.5),
    "tool_analog_input": ("tool_analog_in", 0, 2.5),
    "tool_analog_output": ("tool_analog_out", 0, 0.005),
    "tool_output_voltage": ("tool_voltage", 0, 24),
}
for _n in range(48):
    POINTS[f"output_int_register{_n}"] = ("output_int_register", _n, -(10**6) - _n)
    POINTS[f"input_int_register{_n}"] = ("input_int_register", _n, 10**6 + _n)
    POINTS[f"output_double_register{_n}"] = ("output_float_register", _n, -0.5 - _n)
    POINTS[f"input_double_register{_n}"] = ("input_float_register", _n, 0.5 + _n)
for _n in range(64, 128):
    POINTS[f"output_bit_register{_n}"] = ("output_bool_register", _n, True)
    POINTS[f"input_bit_register{_n}"] = ("input_bool_register", _n, True)
WORDS = {
    "output_bit_registers0_to_31": ("output_bool_register", 0),
    "output_bit_registers32_to_63": ("output_bool_register", 32),
    "input_bit_registers0_to_31": ("input_bool_register", 0),
    "input_bit_registers32_to_63": ("input_bool_register", 32),
}


def test_every_name_of_the_table_is_expected_here() -> None:
    assert OUTPUTS.keys() == EXPECTED.keys() | POINTS.keys() | WORDS.keys()
    assert OUTPUTS.keys() >= set(STANDARD_OUTPUTS)


@pytest.mark.parametrize("name", EXPECTED)
def test_a_variable_reads_its_field(name: str) -> None:
    assert OUTPUTS[name].read(snapshot()) == EXPECTED[name]


@pytest.mark.parametrize("name", POINTS)
def test_a_variable_reads_its_signal(name: str) -> None:
    family, index, value = POINTS[name]
    read = OUTPUTS[name].read
    assert read(snapshot(signals={family: {index: value}})) == value
    assert not read(snapshot())


@pytest.mark.parametrize("name", WORDS)
def test_a_word_packs_its_registers(name: str) -> None:
    family, first = WORDS[name]
    for bit in range(32):
        assert OUTPUTS[name].read(snapshot(signals={family: {first + bit: True}})) == 1 << bit
    outside = {index: True for index in range(128) if not first <= index < first + 32}
    assert OUTPUTS[name].read(snapshot(signals={family: outside})) == 0


@pytest.mark.parametrize("direction", ["in", "out"])
def test_digital_words_hold_standard_configurable_and_tool(direction: str) -> None:
    read = OUTPUTS[f"actual_digital_{direction}put_bits"].read
    places = [("standard", 16), ("configurable", 8), ("tool", 4)]
    points = [(f"{place}_digital_{direction}", index) for place, size in places for index in range(size)]
    for bit, (family, index) in enumerate(points):
        assert read(snapshot(signals={family: {index: True}})) == 1 << bit


@pytest.mark.parametrize("name", OUTPUTS)
def test_every_value_fits_its_type(name: str) -> None:
    code, count = SIZES[OUTPUTS[name].type.name]
    value = OUTPUTS[name].read(snapshot())
    struct.pack(f">{count}{code}", *(value if isinstance(value, tuple) else (value,)))


def test_robot_status_bits() -> None:
    read = OUTPUTS["robot_status_bits"].read
    assert read(snapshot(robot_mode=RobotMode.POWER_OFF)) == 0
    assert read(snapshot(task_state=TaskState.PLAYING)) == 0b011
    assert read(snapshot(task_state=TaskState.PAUSED)) == 0b001
    assert read(snapshot(is_freedrive=True)) == 0b101


@pytest.mark.parametrize(
    ("mode", "bits"),
    [
        (SafetyMode.NORMAL, {0}),
        (SafetyMode.REDUCED, {1}),
        (SafetyMode.PROTECTIVE_STOP, {2, 10}),
        (SafetyMode.RECOVERY, {3}),
        (SafetyMode.SAFEGUARD_STOP, {4, 10}),
        (SafetyMode.SYSTEM_EMERGENCY_STOP, {5, 7, 10}),
        (SafetyMode.ROBOT_EMERGENCY_STOP, {6, 7, 10}),
        (SafetyMode.VIOLATION, {8, 10}),
        (SafetyMode.FAULT, {9, 10}),
        (SafetyMode.VALIDATE_JOINT_ID, {10}),
        (SafetyMode.UNDEFINED, set()),
        (SafetyMode.AUTOMATIC_MODE_SAFEGUARD_STOP, {4, 10}),
        (SafetyMode.SYSTEM_THREE_POSITION_ENABLING_STOP, {10}),
        (SafetyMode.TP_THREE_POSITION_ENABLING_STOP, {10}),
    ],
)
def test_safety_status_bits(mode: SafetyMode, bits: set[int]) -> None:
    word = OUTPUTS["safety_status_bits"].read(snapshot(safety_mode=mode))
    assert word == sum(1 << bit for bit in bits)
    assert OUTPUTS["safety_status"].read(snapshot(safety_mode=mode)) == mode


@pytest.mark.parametrize("mode", RobotMode)
def test_negative_modes_are_signed(mode: RobotMode) -> None:
    assert OUTPUTS["robot_mode"].read(snapshot(robot_mode=mode)) == mode
    assert OUTPUTS["robot_mode"].type.name == "INT32"


def test_rows_are_complete() -> None:
    assert all(row.summary and row.evidence for row in OUTPUT_ROWS)
    assert len({row.name for row in OUTPUT_ROWS}) == len(OUTPUT_ROWS)


def test_random_bits_of_all_words_come_through() -> None:
    dice = random.Random(7)
    for _ in range(50):
        levels = {index: dice.random() < 0.5 for index in range(128)}
        picture = snapshot(signals={"input_bool_register": levels})
        low = OUTPUTS["input_bit_registers0_to_31"].read(picture)
        high = OUTPUTS["input_bit_registers32_to_63"].read(picture)
        assert isinstance(low, int)
        assert isinstance(high, int)
        word = low | high << 32
        assert all(bool(word >> index & 1) == levels[index] for index in range(64))
