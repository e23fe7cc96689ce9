"""The robot state of the primary port as a table: sub-messages, their fields, and the source of each value.

A robot-state message is a head and nine sub-messages, each with its own head: length and type number. Clients find them
by number or by position, so order and total length are part of the contract.

Evidence of a row is about its place and type. Most are *documented* (the vendor's client code and pages), positions of
joint fields are also *observed* in public clients, the type numbers of the last four are *assumed*. A value that is not
simulated is a constant, and the row names it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from math import copysign, inf, isnan
from operator import or_
from typing import Final

from elitescript.messages.enums import POWERED, SafetyMode, TaskState
from elitescript.messages.snapshot import RobotDescription, Snapshot
from elitescript.messages.snapshot_parts import ELBOW, LOADS, POSES, TEMPERATURES, TIME
from elitescript.messages.snapshot_parts import JOINTS as JOINT_STATE
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.binary import (
    BOOL,
    DOUBLE,
    FLOAT,
    INT8,
    INT32,
    UINT8,
    UINT32,
    UINT64,
    VECTOR3D,
    VECTOR6D,
    Field,
    FieldList,
    Number,
    WireType,
    WireValue,
    packed_bits,
)
from elitescript.protocol.device_modes import joint_mode, tool_mode

Reading = Callable[[Snapshot, RobotDescription], Number | Sequence[Number]]
"""Source of a value; in a sub-message that repeats its fields, of one value for each repetition."""

DOCUMENTED: Final = "documented"
OBSERVED: Final = "observed"
ASSUMED: Final = "assumed"

ROBOT_STATE: Final = 16
"""Type of the message that contains all sub-messages."""
STATE_SIZE: Final = 1157
"""Bytes of a robot-state message; *observed*: a public client takes no other length."""

FLOAT_MAX: Final = (2 - 2**-23) * 2.0**127
"""Largest finite FLOAT."""

PAIRS: Final = WireType("6 x (DOUBLE, DOUBLE)", "d", 12)
MICROSECONDS_PER_TICK: Final = 1_000_000 // TICKS_PER_S
EMERGENCY_STOPS: Final = frozenset({SafetyMode.SYSTEM_EMERGENCY_STOP, SafetyMode.ROBOT_EMERGENCY_STOP})

_HEAD: Final = (Field("length", UINT32, "byte", DOCUMENTED), Field("type", UINT8, "", DOCUMENTED))


class PacketField:
    """One field of a sub-message."""

    __slots__ = ("field", "parts", "read")

    def __init__(
        self,
        name: str,
        wire: WireType,
        unit: str,
        evidence: str,
        read: Reading | Number,
        summary: str = "",
        *,
        parts: int = 0,
    ) -> None:
        self.field = Field(name, wire, unit, evidence, summary)
        self.parts = parts
        """Of the snapshot that it reads, as bits; 0 for the discrete state."""
        self.read: Reading
        if isinstance(read, int | float):
            constant = read
            self.read = lambda _snapshot, _description: constant
        else:
            self.read = read


class SubMessage:
    """One part of the robot state.

    Args:
        name: of the part.
        number: its type on the wire.
        size: bytes, with its head.
        evidence: for the type number.
        rows: its fields in order.
        repeats: how many times the fields follow each other, once for each joint.
    """

    __slots__ = ("_fields", "evidence", "name", "number", "repeats", "rows", "size")

    def __init__(self, name: str, number: int, size: int, evidence: str, *rows: PacketField, repeats: int = 1) -> None:
        self.name = name
        self.number = number
        self.size = size
        self.evidence = evidence
        self.rows = rows
        self.repeats = repeats
        self._fields = FieldList(*_HEAD, *(row.field for _ in range(repeats) for row in rows))
        assert self._fields.size == size, f"{name}: {self._fields.size} bytes in the table, not {size}"

    def offsets(self) -> tuple[int, ...]:
        """Return the offset of each row (its first repetition), in bytes from the begin of the head."""
        return self._fields.offsets()[len(_HEAD) : len(_HEAD) + len(self.rows)]

    def pack(self, snapshot: Snapshot, description: RobotDescription) -> bytes:
        """Return the bytes.

        Raises:
            ValueError: a value does not fit its type; names the field.
        """
        columns = [row.read(snapshot, description) for row in self.rows]
        if self.repeats > 1:
            columns = [
                column if isinstance(column, (int, float)) else column[index]
                for index in range(self.repeats)
                for column in columns
            ]
        try:
            return self._fields.pack((self.size, self.number, *columns))
        except ValueError:
            # Torques of a program may exceed a FLOAT; clients still get the state.
            return self._fields.pack((self.size, self.number, *self._in_range(columns)))

    def unpack(self, data: bytes) -> dict[str, WireValue]:
        """Return the values by name of the field; of a part that repeats its fields, tuples of one for each repetition.

        Args:
            data: the bytes with their head; further ones, of a newer firmware, are left out.

        Raises:
            ValueError: fewer bytes than the fields need.
        """
        values = self._fields.unpack(data)[len(_HEAD) :]
        if self.repeats == 1:
            return {row.field.name: value for row, value in zip(self.rows, values, strict=True)}
        count = len(self.rows)
        return {row.field.name: values[place::count] for place, row in enumerate(self.rows)}  # type: ignore[misc]

    def _in_range(self, columns: Sequence[Number | Sequence[Number]]) -> list[Number | Sequence[Number]]:
        """Return the values with infinity in place of those that are too large for a FLOAT, as rounding does."""
        kinds = [field.type for field in self._fields.fields[len(_HEAD) :]]
        return [
            copysign(inf, value)
            if kind is FLOAT and isinstance(value, float) and not isnan(value) and abs(value) > FLOAT_MAX
            else value
            for kind, value in zip(kinds, columns, strict=True)
        ]


def pack_state(parts: Sequence[SubMessage], snapshot: Snapshot, description: RobotDescription) -> bytes:
    """Return a whole robot-state message of these sub-messages."""
    body = b"".join([part.pack(snapshot, description) for part in parts])
    return (len(body) + 5).to_bytes(4, "big") + bytes((ROBOT_STATE,)) + body


def timestamp(tick: int) -> int:
    """Return the time of a tick in microseconds since the start. Unit *documented*, origin *assumed*."""
    return tick * MICROSECONDS_PER_TICK


def _domain(family: str, index: int) -> Reading:
    return lambda snapshot, _description: snapshot.domains[family][index]


def _signal(family: str, index: int = 0) -> Reading:
    return lambda snapshot, _description: snapshot.signals[family][index]


def _bits(direction: str) -> Reading:
    families = [f"{place}_digital_{direction}" for place in ("standard", "configurable", "tool")]

    def read(snapshot: Snapshot, _description: RobotDescription) -> int:
        return packed_bits([level for family in families for level in snapshot.signals[family]])

    return read


def _in_pairs(first: Sequence[float], second: Sequence[float]) -> tuple[float, ...]:
    return tuple(value for pair in zip(first, second, strict=True) for value in pair)


ROBOT_MODE: Final = SubMessage(
    "robot mode",
    0,
    53,
    DOCUMENTED,
    PacketField(
        "timestamp", UINT64, "us", DOCUMENTED, lambda s, _: timestamp(s.robot.tick), "time since the start", parts=TIME
    ),
    PacketField("reserved 1", BOOL, "", DOCUMENTED, 0),
    PacketField("reserved 2", BOOL, "", DOCUMENTED, 0),
    PacketField("robot power on", BOOL, "", DOCUMENTED, lambda s, _: s.robot.robot_mode in POWERED),
    PacketField("emergency stopped", BOOL, "", DOCUMENTED, lambda s, _: s.robot.safety_mode in EMERGENCY_STOPS),
    PacketField(
        "protective stopped", BOOL, "", DOCUMENTED, lambda s, _: s.robot.safety_mode is SafetyMode.PROTECTIVE_STOP
    ),
    PacketField(
        "task running", BOOL, "", DOCUMENTED, lambda s, _: s.robot.task_state is TaskState.PLAYING, "false while paused"
    ),
    PacketField("task paused", BOOL, "", DOCUMENTED, lambda s, _: s.robot.task_state is TaskState.PAUSED),
    PacketField("robot mode", UINT8, "", DOCUMENTED, lambda s, _: s.robot.robot_mode & 0xFF, "`RobotMode`; -1 is 255"),
    PacketField("control mode", UINT8, "", ASSUMED, lambda s, _: s.is_freedrive, "0 position, 1 guided by hand"),
    PacketField(
        "target speed fraction", DOUBLE, "1", DOCUMENTED, lambda s, _: s.robot.speed_scale, "speed slider, 0 to 1"
    ),
    PacketField(
        "speed scaling",
        DOUBLE,
        "1",
        DOCUMENTED,
        lambda s, _: s.speed_scaling,
        "how fast planned time passes",
        parts=TIME,
    ),
    PacketField("target speed fraction limit", DOUBLE, "1", DOCUMENTED, 1.0, "always 1: not simulated"),
    PacketField("robot speed mode", UINT8, "", DOCUMENTED, 0, "always 0: not simulated"),
    PacketField("reserved 3", UINT8, "", DOCUMENTED, 0, "in older firmware: system in alarm"),
    PacketField("in package mode", BOOL, "", DOCUMENTED, 0, "transport position; not simulated"),
    PacketField("reserved 4", UINT32, "", DOCUMENTED, 0),
)

JOINTS: Final = SubMessage(
    "joints",
    1,
    347,
    OBSERVED,
    PacketField("actual position", DOUBLE, "rad", DOCUMENTED, lambda s, _: s.robot.q_actual, parts=JOINT_STATE),
    PacketField("target position", DOUBLE, "rad", DOCUMENTED, lambda s, _: s.robot.q_target, parts=JOINT_STATE),
    PacketField("actual velocity", DOUBLE, "rad/s", DOCUMENTED, lambda s, _: s.robot.qd_actual, parts=JOINT_STATE),
    PacketField("target encoder pulses", INT32, "", DOCUMENTED, 0, "always 0: not simulated"),
    PacketField("actual encoder pulses", INT32, "", DOCUMENTED, 0, "always 0: not simulated"),
    PacketField("zero position pulses", INT32, "", DOCUMENTED, 0, "always 0; reserved in newer firmware"),
    PacketField("current", FLOAT, "A", DOCUMENTED, lambda s, _: s.joint_currents, parts=LOADS),
    PacketField("voltage", FLOAT, "V", DOCUMENTED, lambda s, _: s.joint_voltages),
    PacketField("temperature", FLOAT, "degC", DOCUMENTED, lambda s, _: s.joint_temperatures, parts=TEMPERATURES),
    PacketField("torque", FLOAT, "N m", DOCUMENTED, lambda s, _: s.joint_torques, parts=LOADS),
    PacketField(
        "joint mode", UINT8, "", DOCUMENTED, lambda s, _: joint_mode(s.robot), "253 running, 255 idle, 239 power off"
    ),
    PacketField("reserved", UINT32, "", DOCUMENTED, 0),
    repeats=6,
)

CARTESIAN: Final = SubMessage(
    "cartesian",
    4,
    101,
    DOCUMENTED,
    PacketField(
        "TCP pose",
        VECTOR6D,
        "m, rad",
        DOCUMENTED,
        lambda s, _: s.robot.tcp_pose_actual,
        "base frame; RPY *assumed*",
        parts=POSES,
    ),
    PacketField("TCP offset", VECTOR6D, "m, rad", DOCUMENTED, lambda s, _: s.robot.tcp_offset, "from the flange"),
)

CONFIGURATION: Final = SubMessage(
    "configuration",
    6,
    445,
    DOCUMENTED,
    PacketField("joint limits", PAIRS, "rad", DOCUMENTED, lambda _, d: _in_pairs(d.q_min, d.q_max), "lower, upper"),
    PacketField(
        "joint maxima",
        PAIRS,
        "rad/s, rad/s^2",
        DOCUMENTED,
        lambda _, d: _in_pairs(d.qd_max, d.qdd_max),
        "velocity, acceleration",
    ),
    PacketField("default joint velocity", DOUBLE, "rad/s", DOCUMENTED, lambda _, d: d.default_joint_speed),
    PacketField("default joint acceleration", DOUBLE, "rad/s^2", DOCUMENTED, lambda _, d: d.default_joint_acceleration),
    PacketField("default tool velocity", DOUBLE, "m/s", DOCUMENTED, lambda _, d: d.default_tool_speed),
    PacketField("default tool acceleration", DOUBLE, "m/s^2", DOCUMENTED, lambda _, d: d.default_tool_acceleration),
    PacketField("equivalent radius", DOUBLE, "m", DOCUMENTED, lambda _, d: d.equivalent_radius_m),
    PacketField("DH a", VECTOR6D, "m", DOCUMENTED, lambda _, d: d.dh_a, "modified (Craig): row i holds a(i-1)"),
    PacketField("DH d", VECTOR6D, "m", DOCUMENTED, lambda _, d: d.dh_d),
    PacketField("DH alpha", VECTOR6D, "rad", DOCUMENTED, lambda _, d: d.dh_alpha, "row i holds alpha(i-1)"),
    PacketField("reserved", VECTOR6D, "", DOCUMENTED, lambda _s, _d: (0.0,) * 6),
    PacketField("master board version", UINT32, "", DOCUMENTED, 0, "always 0: its numbers are not known"),
    PacketField("control box type", UINT32, "", DOCUMENTED, 0, "always 0: its numbers are not known"),
    PacketField(
        "robot type", UINT32, "", DOCUMENTED, lambda _, d: d.type_id, "6206 is a CS66; that these stand here *assumed*"
    ),
    PacketField(
        "robot structure", UINT32, "", DOCUMENTED, 0, "newer firmware: structure, tool I/O type, two reserved bytes"
    ),
)

MASTER_BOARD: Final = SubMessage(
    "master board",
    3,
    88,
    DOCUMENTED,
    PacketField(
        "digital inputs", UINT32, "bit", DOCUMENTED, _bits("in"), "0-15 standard, 16-23 configurable, 24-27 tool"
    ),
    PacketField(
        "digital outputs", UINT32, "bit", DOCUMENTED, _bits("out"), "numbered alike; the numbering is *assumed*"
    ),
    PacketField(
        "analog input 0 domain", UINT8, "", DOCUMENTED, _domain("standard_analog_in", 0), "0 current, 1 voltage"
    ),
    PacketField("analog input 1 domain", UINT8, "", DOCUMENTED, _domain("standard_analog_in", 1)),
    PacketField("tool analog input domain", UINT8, "", DOCUMENTED, _domain("tool_analog_in", 0)),
    PacketField("analog input 0", DOUBLE, "A or V", DOCUMENTED, _signal("standard_analog_in", 0)),
    PacketField("analog input 1", DOUBLE, "A or V", DOCUMENTED, _signal("standard_analog_in", 1)),
    PacketField("tool analog input", DOUBLE, "A or V", DOCUMENTED, _signal("tool_analog_in")),
    PacketField("analog output 0 domain", UINT8, "", DOCUMENTED, _domain("standard_analog_out", 0)),
    PacketField("analog output 1 domain", UINT8, "", DOCUMENTED, _domain("standard_analog_out", 1)),
    PacketField("tool analog output domain", UINT8, "", DOCUMENTED, _domain("tool_analog_out", 0)),
    PacketField("analog output 0", DOUBLE, "A or V", DOCUMENTED, _signal("standard_analog_out", 0)),
    PacketField("analog output 1", DOUBLE, "A or V", DOCUMENTED, _signal("standard_analog_out", 1)),
    PacketField("tool analog output", DOUBLE, "A or V", DOCUMENTED, _signal("tool_analog_out")),
    PacketField(
        "board temperature", FLOAT, "degC", DOCUMENTED, lambda s, _: s.controller_temperature, parts=TEMPERATURES
    ),
    PacketField("robot voltage", FLOAT, "V", DOCUMENTED, lambda s, _: s.robot_voltage),
    PacketField("robot current", FLOAT, "A", DOCUMENTED, lambda s, _: s.robot_current, parts=LOADS),
    PacketField("I/O current", FLOAT, "A", DOCUMENTED, lambda s, _: s.io_current),
    PacketField("safety mode", UINT8, "", DOCUMENTED, lambda s, _: s.robot.safety_mode, "`SafetyMode`"),
    PacketField("in reduced mode", UINT8, "", DOCUMENTED, lambda s, _: s.robot.safety_mode is SafetyMode.REDUCED),
    PacketField("operational mode selector", UINT8, "", DOCUMENTED, 0, "always 0: not simulated"),
    PacketField("three-position enabling device", UINT8, "", DOCUMENTED, 0, "always 0: not simulated"),
    PacketField("internal", UINT8, "", DOCUMENTED, 0),
)

ADDITIONAL: Final = SubMessage(
    "additional info",
    8,
    10,
    ASSUMED,
    PacketField("freedrive button pressed", BOOL, "", DOCUMENTED, lambda s, _: s.is_freedrive),
    PacketField("reserved 1", BOOL, "", DOCUMENTED, 0),
    PacketField(
        "freedrive by I/O enabled",
        BOOL,
        "",
        DOCUMENTED,
        lambda s, _: s.is_guided_by_input,
        "guided by hand because an input asks for it (*assumed*)",
    ),
    PacketField("dynamic collision detection enabled", BOOL, "", DOCUMENTED, 0, "always false: not simulated"),
    PacketField("reserved 2", UINT8, "", DOCUMENTED, 0),
)

TOOL: Final = SubMessage(
    "tool",
    2,
    37,
    ASSUMED,
    PacketField("analog output domain", UINT8, "", DOCUMENTED, _domain("tool_analog_out", 0), "0 current, 1 voltage"),
    PacketField("analog input domain", UINT8, "", DOCUMENTED, _domain("tool_analog_in", 0)),
    PacketField("analog output", DOUBLE, "A or V", DOCUMENTED, _signal("tool_analog_out")),
    PacketField("analog input", DOUBLE, "A or V", DOCUMENTED, _signal("tool_analog_in")),
    PacketField("tool voltage", FLOAT, "V", DOCUMENTED, _signal("tool_voltage"), "measured; here what is set"),
    PacketField("output voltage", UINT8, "V", DOCUMENTED, _signal("tool_voltage"), "set: 0, 12 or 24"),
    PacketField("tool current", FLOAT, "A", DOCUMENTED, lambda s, _: s.tool_current),
    PacketField("tool temperature", FLOAT, "degC", DOCUMENTED, lambda s, _: s.tool_temperature, parts=TEMPERATURES),
    PacketField(
        "tool mode", UINT8, "", DOCUMENTED, lambda s, _: tool_mode(s.robot), "253 running, 255 idle, 239 power off"
    ),
)

SAFETY: Final = SubMessage(
    "safety",
    10,
    43,
    ASSUMED,
    PacketField("configuration checksum", UINT32, "", DOCUMENTED, lambda _, d: d.safety_checksum),
    PacketField(
        "operational mode",
        INT8,
        "",
        DOCUMENTED,
        lambda _, d: d.operational_mode,
        "-1 not reported; `[safety] operational_mode`: 0 manual, 1 automatic; numbers *assumed*",
    ),
    PacketField("reserved", UINT8, "", DOCUMENTED, 0),
    PacketField("elbow position", VECTOR3D, "m", DOCUMENTED, lambda s, _: s.elbow_position, "base frame", parts=ELBOW),
    PacketField("elbow radius", DOUBLE, "m", DOCUMENTED, 0.0, "always 0: not simulated"),
)

TOOL_COMMUNICATION: Final = SubMessage(
    "tool communication",
    11,
    28,
    ASSUMED,
    PacketField("enabled", BOOL, "", DOCUMENTED, 0, "always false: not simulated"),
    PacketField("baud rate", UINT32, "1/s", DOCUMENTED, 115200, "a default, *assumed*"),
    PacketField("parity", UINT32, "", DOCUMENTED, 0, "none"),
    PacketField("stop bits", UINT32, "", DOCUMENTED, 1),
    PacketField("Modbus status", BOOL, "", DOCUMENTED, 0, "always false: not simulated"),
    PacketField("usage", UINT8, "", DOCUMENTED, 0),
    PacketField("reserved 1", FLOAT, "", DOCUMENTED, 0.0),
    PacketField("reserved 2", FLOAT, "", DOCUMENTED, 0.0),
)

SUB_MESSAGES: Final[tuple[SubMessage, ...]] = (
    ROBOT_MODE,
    JOINTS,
    CARTESIAN,
    CONFIGURATION,
    MASTER_BOARD,
    ADDITIONAL,
    TOOL,
    SAFETY,
    TOOL_COMMUNICATION,
)
"""In the order of the wire; *observed*: public clients go by position."""

STATE_PARTS: Final = reduce(or_, (row.parts for part in SUB_MESSAGES for row in part.rows))
"""Parts of the snapshot that the message reads, as bits."""
