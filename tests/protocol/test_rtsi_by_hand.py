"""RTSI variables against tables written by hand: name, type, unit and how well each is known.

C: the vendor's client parses or sends exactly this. 3: another public client depends on it. A part that is assumed
follows a plus. The types are what matters most: clients return a default in silence when the announced one differs.
"""

from __future__ import annotations

import pytest

from elitescript.messages.enums import RobotMode, SafetyMode, TaskState
from elitescript.protocol.rtsi.inputs import EFFECTS, INPUT_ROWS, INPUTS
from elitescript.protocol.rtsi.variables import OUTPUT_ROWS, OUTPUTS
from tests.protocol.snapshots import snapshot
from tests.tables import rows

TYPES = {
    "BOOL": 1,
    "UINT8": 1,
    "UINT16": 2,
    "UINT32": 4,
    "INT32": 4,
    "DOUBLE": 8,
    "VECTOR3D": 24,
    "VECTOR6D": 48,
    "VECTOR6INT32": 24,
}
"""Bytes of each type."""

RECIPE_SIZE = 849
"""Bytes of a data package with the 52 outputs of the common recipe, marked R, with its head of 3 and its recipe id."""
INPUT_RECIPE_SIZE = 98
"""The same for the 15 inputs."""

# `#` stands for each index of the range behind it.
OUTPUT_TABLE = """
timestamp                      DOUBLE         s             C                                   R
payload_mass                   DOUBLE         kg            C                                   R
payload_cog                    VECTOR3D       m             C                                   R
script_control_line            UINT32         .             C                                   R
target_joint_positions         VECTOR6D       rad           C                                   R
target_joint_speeds            VECTOR6D       rad/s         C                                   R
actual_joint_torques           VECTOR6D       N m           C                                   R
actual_joint_positions         VECTOR6D       rad           C                                   R
actual_joint_speeds            VECTOR6D       rad/s         C                                   R
actual_joint_current           VECTOR6D       A             C                                   R
actual_TCP_pose                VECTOR6D       m, rad        C + orientation assumed             R
actual_TCP_speed               VECTOR6D       m/s, rad/s    C                                   R
actual_TCP_force               VECTOR6D       N, N m        C                                   R
target_TCP_pose                VECTOR6D       m, rad        C + orientation assumed             R
target_TCP_speed               VECTOR6D       m/s, rad/s    C                                   R
actual_digital_input_bits      UINT32         .             C                                   R
actual_digital_output_bits     UINT32         .             C                                   R
joint_temperatures             VECTOR6D       degC          C                                   R
robot_mode                     INT32          .             C                                   R
joint_mode                     VECTOR6INT32   .             C + relation to the robot mode assumed   R
safety_status                  INT32          .             C                                   R
safety_mode                    INT32          .             3                                   .
speed_scaling                  DOUBLE         .             C                                   R
target_speed_fraction          DOUBLE         .             C                                   R
actual_robot_voltage           DOUBLE         V             C                                   R
actual_robot_current           DOUBLE         A             C                                   R
runtime_state                  UINT32         .             C                                   R
elbow_position                 VECTOR3D       m             C                                   R
elbow_velocity                 VECTOR3D       m/s           C                                   .
robot_status_bits              UINT32         .             C + bits 3                          R
safety_status_bits             UINT32         .             C + bits 3                          R
analog_io_types                UINT32         .             C                                   R
standard_analog_input# 0-1     DOUBLE         A or V        C                                   R
standard_analog_output# 0-1    DOUBLE         A or V        C                                   R
io_current                     DOUBLE         A             C                                   R
tool_mode                      UINT32         .             C + relation to the robot mode assumed   R
tool_analog_input_types        UINT32         .             C                                   R
tool_analog_output_types       UINT32         .             C                                   R
tool_analog_input              DOUBLE         A or V        C                                   R
tool_analog_output             DOUBLE         A or V        C                                   R
tool_output_voltage            DOUBLE         V             C                                   R
tool_output_current            DOUBLE         A             C                                   R
tool_temperature               DOUBLE         degC          C                                   R
tool_digital_mode              UINT8          .             C + value assumed                   R
tool_digital#_mode 0-3         UINT8          .             C                                   R
output_bit_registers0_to_31    UINT32         .             C                                   R
output_bit_registers32_to_63   UINT32         .             C                                   R
output_bit_register# 64-127    BOOL           .             C                                   .
output_int_register# 0-47      INT32          .             C + range assumed                   .
output_double_register# 0-47   DOUBLE         .             C + range assumed                   .
input_bit_registers0_to_31     UINT32         .             C                                   R
input_bit_registers32_to_63    UINT32         .             C                                   R
input_bit_register# 64-127     BOOL           .             C                                   .
input_int_register# 0-47       INT32          .             C + range assumed                   .
input_double_register# 0-47    DOUBLE         .             C + range assumed                   .
ft_raw_wrench                  VECTOR6D       N, N m        3                                   .
actual_current                 VECTOR6D       A             3                                   .
actual_joint_voltage           VECTOR6D       V             3                                   .
"""

# Analog outputs are written with an underscore before the digit as inputs, and without one as outputs.
INPUT_TABLE = """
speed_slider_mask                  UINT32     .        C                           R
speed_slider_fraction              DOUBLE     .        C                           R
standard_digital_output_mask       UINT16     .        C                           R
standard_digital_output            UINT16     .        C                           R
configurable_digital_output_mask   UINT8      .        C                           R
configurable_digital_output        UINT8      .        C                           R
tool_digital_output_mask           UINT8      .        C                           R
tool_digital_output                UINT8      .        C                           R
standard_analog_output_mask        UINT8      .        C                           R
standard_analog_output_type        UINT8      .        C + use of the mask assumed   R
standard_analog_output_# 0-1       DOUBLE     .        C                           R
external_force_torque              VECTOR6D   N, N m   C, documented               R
input_bit_registers0_to_31         UINT32     .        C                           R
input_bit_registers32_to_63        UINT32     .        C                           R
input_bit_register# 64-127         BOOL       .        3                           .
input_int_register# 0-47           INT32      .        3 + range assumed           .
input_double_register# 0-47        DOUBLE     .        3 + range assumed           .
"""

# What works together: a package acts on all of a group once the client has sent each of them.
INPUT_GROUPS = """
speed_slider_mask                  speed_slider_fraction
standard_digital_output_mask       standard_digital_output
configurable_digital_output_mask   configurable_digital_output
tool_digital_output_mask           tool_digital_output
standard_analog_output_mask        standard_analog_output_type   standard_analog_output_0
standard_analog_output_mask        standard_analog_output_type   standard_analog_output_1
"""

SAFETY_BITS = """
NORMAL                                 0
REDUCED                                1
PROTECTIVE_STOP                        2 10
RECOVERY                               3
SAFEGUARD_STOP                         4 10
SYSTEM_EMERGENCY_STOP                  5 7 10
ROBOT_EMERGENCY_STOP                   6 7 10
VIOLATION                              8 10
FAULT                                  9 10
VALIDATE_JOINT_ID                      10
UNDEFINED                              .
AUTOMATIC_MODE_SAFEGUARD_STOP          4 10
SYSTEM_THREE_POSITION_ENABLING_STOP    10
TP_THREE_POSITION_ENABLING_STOP        10
"""


def evidence(mark: str) -> str:
    """The mark of a row in words."""
    known, _, rest = mark.replace("C", "vendor's client").partition(" + ")
    known = known.replace("3", "third-party client")
    return f"{known}; {rest.replace('3', 'third-party client')}" if rest else known


def names(cell: str) -> list[str]:
    """Every name that the first cell of a row stands for."""
    name, _, span = cell.partition(" ")
    first, _, last = span.partition("-")
    return [name.replace("#", str(index)) for index in range(int(first), int(last) + 1)] if span else [name]


def types(table: str) -> dict[str, str]:
    return {name: wire for cell, wire, *_ in rows(table) for name in names(cell)}


@pytest.mark.parametrize(("table", "shown"), [(OUTPUT_TABLE, OUTPUT_ROWS), (INPUT_TABLE, INPUT_ROWS)])
def test_rows(table: str, shown: tuple) -> None:
    pages = [(row.name, row.type.name, row.unit, row.evidence) for row in shown]
    assert pages == [(cell.split(" ")[0], wire, unit, evidence(mark)) for cell, wire, unit, mark, _ in rows(table)]


def test_names_and_types() -> None:
    assert {name: variable.type.name for name, variable in OUTPUTS.items()} == types(OUTPUT_TABLE)
    assert {name: wire.name for name, wire in INPUTS.items()} == types(INPUT_TABLE)


@pytest.mark.parametrize(
    ("table", "count", "size"), [(OUTPUT_TABLE, 52, RECIPE_SIZE), (INPUT_TABLE, 15, INPUT_RECIPE_SIZE)]
)
def test_the_common_recipes_have_their_known_sizes(table: str, count: int, size: int) -> None:
    wires = [wire for cell, wire, _, _, mark in rows(table) for _ in names(cell) if mark == "R"]
    assert len(wires) == count
    assert 3 + 1 + sum(TYPES[wire] for wire in wires) == size


def test_types_have_their_sizes() -> None:
    used = {wire.name: wire.size for wire in (*INPUTS.values(), *(row.type for row in OUTPUTS.values()))}
    assert used == TYPES


def test_inputs_that_work_together() -> None:
    grouped = [group for group in (effect.variables for effect in EFFECTS) if len(group) > 1]
    assert grouped == rows(INPUT_GROUPS)
    alone = [group[0] for group in (effect.variables for effect in EFFECTS) if len(group) == 1]
    assert sorted(alone) == sorted(set(INPUTS) - {name for group in grouped for name in group})


@pytest.mark.parametrize(("mode", "bits"), rows(SAFETY_BITS))
def test_safety_bits(mode: str, bits: str) -> None:
    word = OUTPUTS["safety_status_bits"].read(snapshot(safety_mode=SafetyMode[mode]))
    assert word == sum(1 << int(bit) for bit in bits.split())


def test_safety_bits_of_every_mode_are_in_the_table() -> None:
    assert [mode for mode, _ in rows(SAFETY_BITS)] == list(SafetyMode.__members__)


@pytest.mark.parametrize(
    ("name", "field", "members", "first"),
    [
        ("robot_mode", "robot_mode", RobotMode, -1),
        ("safety_status", "safety_mode", SafetyMode, 1),
        ("safety_mode", "safety_mode", SafetyMode, 1),
        ("runtime_state", "task_state", TaskState, 0),
    ],
)
def test_modes_are_sent_as_their_numbers(name: str, field: str, members: type, first: int) -> None:
    shown = [OUTPUTS[name].read(snapshot(**{field: member})) for member in members]
    assert shown == list(range(first, first + len(shown)))
