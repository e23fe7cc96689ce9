"""The table of RTSI output variables: names, types, and how they are read from a snapshot.

Names, types and units are facts of the interface; `evidence` of each row is their source. The vendor's complete list is
not public: a name that is missing here is answered with `NOT_FOUND`. The inputs are in `rtsi.inputs`.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import Final, TypeAlias

from elitescript.messages.enums import POWERED, RobotMode, SafetyMode, TaskState
from elitescript.messages.signals import SIGNALS
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import ELBOW, JOINTS, LOADS, POSES, TCP_SPEEDS, TEMPERATURES, TIME, WRENCHES
from elitescript.protocol.binary import (
    BOOL,
    DOUBLE,
    INT32,
    UINT8,
    UINT32,
    VECTOR3D,
    VECTOR6D,
    VECTOR6INT32,
    WireType,
    WireValue,
    packed_bits,
)
from elitescript.protocol.device_modes import DeviceMode, joint_mode, tool_mode
from elitescript.records import NamedTuple

Reader: TypeAlias = Callable[[Snapshot], WireValue]

CLIENT: Final = "vendor's client"
THIRD: Final = "third-party client"
ASSUMED: Final = "assumed"

BIT_REGISTERS: Final = range(64, 128)
"""Boolean registers with a variable each; those below are packed in words of 32."""
WORDS: Final = (0, 32)
"""First registers of the packed words."""


class OutputVariable(NamedTuple):
    """One row: a variable, or a family of numbered ones."""

    name: str
    """`#` stands for the index of a family."""
    type: WireType
    unit: str
    summary: str
    reader: Callable[[int], Reader]
    """Makes the reader of one index; of a single variable, of 0."""
    indices: range = range(1)
    evidence: str = CLIENT
    parts: int = 0
    """Of the snapshot that it reads, as bits; 0 for the discrete state."""


def _one(
    name: str, wire: WireType, unit: str, summary: str, read: Reader, parts: int = 0, *, evidence: str = CLIENT
) -> OutputVariable:
    return OutputVariable(name, wire, unit, summary, lambda _: read, evidence=evidence, parts=parts)


def _numbers(modes: type[IntEnum]) -> str:
    """Return each number of an enumeration with its name."""
    return ", ".join(f"{mode.value} {mode.name.lower().replace('_', ' ')}" for mode in modes)


def _point(family: str) -> Callable[[int], Reader]:
    return lambda index: lambda snapshot: snapshot.signals[family][index]


def _word(family: str, first: int) -> Reader:
    return lambda snapshot: packed_bits(snapshot.signals[family][first : first + 32])


def _digital_word(direction: str) -> Reader:
    standard, configurable, tool = (f"{place}_digital_{direction}" for place in ("standard", "configurable", "tool"))

    def read(snapshot: Snapshot) -> int:
        signals = snapshot.signals
        return packed_bits(signals[standard] + signals[configurable] + signals[tool])

    return read


def _domain(family: str) -> Reader:
    return lambda snapshot: int(snapshot.domains[family][0])


def _analog_domains(snapshot: Snapshot) -> int:
    return packed_bits(snapshot.domains["standard_analog_in"] + snapshot.domains["standard_analog_out"])


def _robot_bits(snapshot: Snapshot) -> int:
    robot = snapshot.robot
    return (robot.robot_mode in POWERED) | (robot.task_state is TaskState.PLAYING) << 1 | snapshot.is_freedrive << 2


SAFETY_BITS: Final = (
    ("normal", {SafetyMode.NORMAL}),
    ("reduced", {SafetyMode.REDUCED}),
    ("protective stop", {SafetyMode.PROTECTIVE_STOP}),
    ("recovery", {SafetyMode.RECOVERY}),
    ("safeguard stop", {SafetyMode.SAFEGUARD_STOP, SafetyMode.AUTOMATIC_MODE_SAFEGUARD_STOP}),
    ("system emergency stop", {SafetyMode.SYSTEM_EMERGENCY_STOP}),
    ("robot emergency stop", {SafetyMode.ROBOT_EMERGENCY_STOP}),
    ("emergency stop", {SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP}),
    ("violation", {SafetyMode.VIOLATION}),
    ("fault", {SafetyMode.FAULT}),
    (
        "stopped due to safety",
        set(SafetyMode) - {SafetyMode.NORMAL, SafetyMode.REDUCED, SafetyMode.RECOVERY, SafetyMode.UNDEFINED},
    ),
)
"""Each bit of `safety_status_bits`, the lowest first, and the modes in which it is set (*assumed*)."""

_SAFETY_WORDS: Final = {mode: packed_bits([mode in modes for _, modes in SAFETY_BITS]) for mode in SafetyMode}


def _registers(side: str) -> tuple[OutputVariable, ...]:
    bits, whole, real = (f"{side}_{kind}_register" for kind in ("bool", "int", "float"))
    what = "of programs" if side == "output" else "of clients, read back"
    words = (
        _one(
            f"{side}_bit_registers{first}_to_{first + 31}",
            UINT32,
            "",
            f"boolean registers {first} to {first + 31} {what}; the lowest bit is register {first}",
            _word(bits, first),
        )
        for first in WORDS
    )
    return (
        *words,
        OutputVariable(f"{side}_bit_register#", BOOL, "", f"boolean register {what}", _point(bits), BIT_REGISTERS),
        OutputVariable(
            f"{side}_int_register#",
            INT32,
            "",
            f"integer register {what}",
            _point(whole),
            range(SIGNALS[whole].size),
            f"{CLIENT}; range {ASSUMED}",
        ),
        OutputVariable(
            f"{side}_double_register#",
            DOUBLE,
            "",
            f"float register {what}",
            _point(real),
            range(SIGNALS[real].size),
            f"{CLIENT}; range {ASSUMED}",
        ),
    )


OUTPUT_ROWS: Final[tuple[OutputVariable, ...]] = (
    _one(
        "timestamp",
        DOUBLE,
        "s",
        "robot time since the controller started: 4 ms a tick; behind the wall clock by the ticks that were left out",
        lambda s: s.robot.time_s,
        TIME,
    ),
    _one("payload_mass", DOUBLE, "kg", "payload", lambda s: s.robot.payload.mass_kg),
    _one("payload_cog", VECTOR3D, "m", "centre of gravity of the payload", lambda s: s.robot.payload.cog),
    _one(
        "script_control_line", UINT32, "", "line that the program executes; 0: none runs", lambda s: s.robot.line, TIME
    ),
    _one("target_joint_positions", VECTOR6D, "rad", "joints as commanded", lambda s: s.robot.q_target, JOINTS),
    _one("target_joint_speeds", VECTOR6D, "rad/s", "joint speeds as commanded", lambda s: s.robot.qd_target, JOINTS),
    _one("actual_joint_torques", VECTOR6D, "N m", "joint torques", lambda s: s.joint_torques, LOADS),
    _one("actual_joint_positions", VECTOR6D, "rad", "joints as measured", lambda s: s.robot.q_actual, JOINTS),
    _one("actual_joint_speeds", VECTOR6D, "rad/s", "joint speeds as measured", lambda s: s.robot.qd_actual, JOINTS),
    _one("actual_joint_current", VECTOR6D, "A", "joint currents", lambda s: s.joint_currents, LOADS),
    _one(
        "actual_TCP_pose",
        VECTOR6D,
        "m, rad",
        "TCP as measured, base frame, roll-pitch-yaw",
        lambda s: s.robot.tcp_pose_actual,
        POSES,
        evidence=f"{CLIENT}; orientation {ASSUMED}",
    ),
    _one(
        "actual_TCP_speed",
        VECTOR6D,
        "m/s, rad/s",
        "velocity of the TCP",
        lambda s: s.robot.tcp_speed_actual,
        TCP_SPEEDS,
    ),
    _one(
        "actual_TCP_force", VECTOR6D, "N, N m", "wrench at the TCP without the payload", lambda s: s.tcp_force, WRENCHES
    ),
    _one(
        "target_TCP_pose",
        VECTOR6D,
        "m, rad",
        "TCP as commanded, base frame, roll-pitch-yaw",
        lambda s: s.robot.tcp_pose_target,
        POSES,
        evidence=f"{CLIENT}; orientation {ASSUMED}",
    ),
    _one(
        "target_TCP_speed",
        VECTOR6D,
        "m/s, rad/s",
        "commanded velocity of the TCP",
        lambda s: s.robot.tcp_speed_target,
        TCP_SPEEDS,
    ),
    _one(
        "actual_digital_input_bits",
        UINT32,
        "",
        "digital inputs: bits 0 to 15 standard, 16 to 23 configurable, 24 to 27 tool",
        _digital_word("in"),
    ),
    _one("actual_digital_output_bits", UINT32, "", "digital outputs: bits as of the inputs", _digital_word("out")),
    _one("joint_temperatures", VECTOR6D, "degC", "joint temperatures", lambda s: s.joint_temperatures, TEMPERATURES),
    _one("robot_mode", INT32, "", f"robot mode: {_numbers(RobotMode)}", lambda s: int(s.robot.robot_mode)),
    _one(
        "joint_mode",
        VECTOR6INT32,
        "",
        f"mode of each joint: {_numbers(DeviceMode)}",
        lambda s: (int(joint_mode(s.robot)),) * 6,
        evidence=f"{CLIENT}; relation to the robot mode {ASSUMED}",
    ),
    _one("safety_status", INT32, "", f"safety mode: {_numbers(SafetyMode)}", lambda s: int(s.robot.safety_mode)),
    _one("safety_mode", INT32, "", "the same", lambda s: int(s.robot.safety_mode), evidence=THIRD),
    _one("speed_scaling", DOUBLE, "", "how fast planned time passes, 0 to 1", lambda s: s.speed_scaling, TIME),
    _one("target_speed_fraction", DOUBLE, "", "speed slider, 0 to 1", lambda s: s.robot.speed_scale),
    _one("actual_robot_voltage", DOUBLE, "V", "supply of the arm", lambda s: s.robot_voltage),
    _one("actual_robot_current", DOUBLE, "A", "current of the arm", lambda s: s.robot_current, LOADS),
    _one("runtime_state", UINT32, "", f"task: {_numbers(TaskState)}", lambda s: int(s.robot.task_state)),
    _one("elbow_position", VECTOR3D, "m", "elbow, base frame", lambda s: s.elbow_position, ELBOW),
    _one("elbow_velocity", VECTOR3D, "m/s", "velocity of the elbow, base frame", lambda s: s.elbow_velocity, ELBOW),
    _one(
        "robot_status_bits",
        UINT32,
        "",
        "bit 0 power is on, 1 a program runs and is not paused, 2 the arm is guided by hand",
        _robot_bits,
        evidence=f"{CLIENT}; bits {THIRD}",
    ),
    _one(
        "safety_status_bits",
        UINT32,
        "",
        ", ".join(f"{'bit ' if bit == 0 else ''}{bit} {name}" for bit, (name, _) in enumerate(SAFETY_BITS)),
        lambda s: _SAFETY_WORDS[s.robot.safety_mode],
        evidence=f"{CLIENT}; bits {THIRD}",
    ),
    _one(
        "analog_io_types",
        UINT32,
        "",
        "domains, 0 current, 1 voltage: bits 0 and 1 inputs 0 and 1, bits 2 and 3 outputs 0 and 1",
        _analog_domains,
    ),
    OutputVariable("standard_analog_input#", DOUBLE, "A or V", "analog input", _point("standard_analog_in"), range(2)),
    OutputVariable(
        "standard_analog_output#", DOUBLE, "A or V", "analog output", _point("standard_analog_out"), range(2)
    ),
    _one("io_current", DOUBLE, "A", "current of the I/O", lambda s: s.io_current),
    _one(
        "tool_mode",
        UINT32,
        "",
        "mode of the tool, numbered like those of joints",
        lambda s: int(tool_mode(s.robot)),
        evidence=f"{CLIENT}; relation to the robot mode {ASSUMED}",
    ),
    _one("tool_analog_input_types", UINT32, "", "domain: 0 current, 1 voltage", _domain("tool_analog_in")),
    _one("tool_analog_output_types", UINT32, "", "domain: 0 current, 1 voltage", _domain("tool_analog_out")),
    _one("tool_analog_input", DOUBLE, "A or V", "analog input of the tool", _point("tool_analog_in")(0)),
    _one("tool_analog_output", DOUBLE, "A or V", "analog output of the tool", _point("tool_analog_out")(0)),
    _one("tool_output_voltage", DOUBLE, "V", "supply of the tool connector", _point("tool_voltage")(0)),
    _one("tool_output_current", DOUBLE, "A", "current of the tool", lambda s: s.tool_current),
    _one("tool_temperature", DOUBLE, "degC", "temperature of the tool", lambda s: s.tool_temperature, TEMPERATURES),
    _one(
        "tool_digital_mode",
        UINT8,
        "",
        "how pins work together: 0 each for itself, 1 and 2 as pairs, 3 as three; always 0",
        lambda _: 0,
        evidence=f"{CLIENT}; value {ASSUMED}",
    ),
    OutputVariable(
        "tool_digital#_mode",
        UINT8,
        "",
        "driver of a pin: 0 push-pull, 1 PNP, 2 NPN",
        lambda index: lambda s: s.tool_pin_modes[index],
        range(4),
    ),
    *_registers("output"),
    *_registers("input"),
    _one(
        "ft_raw_wrench",
        VECTOR6D,
        "N, N m",
        "wrench as the sensor measures it",
        lambda s: s.raw_wrench,
        WRENCHES,
        evidence=THIRD,
    ),
    _one("actual_current", VECTOR6D, "A", "joint currents", lambda s: s.joint_currents, LOADS, evidence=THIRD),
    _one("actual_joint_voltage", VECTOR6D, "V", "joint voltages", lambda s: s.joint_voltages, evidence=THIRD),
)


class OutputVariableRow(NamedTuple):
    """One output variable under its full name."""

    type: WireType
    read: Reader
    parts: int
    """Of the snapshot that it reads, as bits; 0 for the discrete state."""


OUTPUTS: Final[dict[str, OutputVariableRow]] = {
    row.name.replace("#", str(index)): OutputVariableRow(row.type, row.reader(index), row.parts)
    for row in OUTPUT_ROWS
    for index in row.indices
}
"""Every name that an output recipe may hold."""
