"""The channels of a recording: which variables are on which, and what other viewers show of them.

Names of channels begin with `/`, as viewers expect. Those of `foxglove.…` schemas are for viewers alone; the reader of
recordings leaves them out.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from math import cos, sin
from typing import Any, Final

from elitescript.protocol.binary import WireType
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.protobuf import BOOL, DOUBLE, FIXED32, FIXED64, FLOAT, SFIXED32, SFIXED64, RowField, Scalar
from elitescript.records import NamedTuple
from elitescript.shown import encodable_json

ROWS: Final = "/rows"
CHANGES: Final = "/changes"
SLOW: Final = "/slow"
PRIMARY: Final = "/primary"
DASHBOARD: Final = "/dashboard"
EVENTS: Final = "/events"
TALKING: Final = {PRIMARY: "primary", DASHBOARD: "dashboard", EVENTS: "events"}
"""Channels of messages with the names that `Message.channel` has."""

SLOW_HZ: Final = 10.0
VIEW_HZ: Final = 25.0
"""How often the channels for viewers have a message."""

PACKAGE: Final = "elitescript"
ROW: Final = "Row"
"""Name of the message of `ROWS`, in `PACKAGE`."""


class Group(NamedTuple):
    """Variables that one recipe of RTSI asks for."""

    channel: str
    variables: tuple[str, ...]
    hz: float | None = None
    """None: the rate of the rows."""
    only_changes: bool = False
    """Whether a package is written down only where a value differs from the one before."""
    is_needed: bool = False
    """Whether there is nothing to record without it."""


TIME: Final = "timestamp"

_ROW_VARIABLES: Final = (
    TIME,
    "script_control_line",
    "runtime_state",
    "robot_mode",
    "safety_status",
    "target_joint_positions",
    "target_joint_speeds",
    "actual_joint_positions",
    "actual_joint_speeds",
    "actual_joint_current",
    "actual_joint_torques",
    "target_TCP_pose",
    "target_TCP_speed",
    "actual_TCP_pose",
    "actual_TCP_speed",
    "actual_TCP_force",
    "ft_raw_wrench",
    "actual_digital_input_bits",
    "actual_digital_output_bits",
    "standard_analog_input0",
    "standard_analog_input1",
    "tool_analog_input",
    "speed_scaling",
    "target_speed_fraction",
)
_SLOW_VARIABLES: Final = (
    "joint_temperatures",
    "actual_joint_voltage",
    "actual_current",
    "actual_robot_voltage",
    "actual_robot_current",
    "io_current",
    "tool_output_current",
    "tool_temperature",
    "elbow_position",
    "elbow_velocity",
)

GROUPS: Final = (
    Group(
        CHANGES,
        (TIME, *(name for name in OUTPUTS if name not in {*_ROW_VARIABLES, *_SLOW_VARIABLES})),
        only_changes=True,
    ),
    Group(SLOW, (TIME, *_SLOW_VARIABLES), hz=SLOW_HZ),
    Group(ROWS, _ROW_VARIABLES, is_needed=True),
)
"""Every variable of the table of RTSI once, and the time in each: registers and settings are written down where they
change, what only drifts ten times a second. The rows are last, so that those of a tick come behind what has changed."""

_SCALARS: Final = {
    "d": DOUBLE,
    "f": FLOAT,
    "?": BOOL,
    "b": SFIXED32,
    "h": SFIXED32,
    "i": SFIXED32,
    "B": FIXED32,
    "H": FIXED32,
    "I": FIXED32,
    "q": SFIXED64,
    "Q": FIXED64,
}


def scalar_of(wire: WireType) -> Scalar:
    """Return the type of Protocol Buffers that holds the values of a type of RTSI."""
    return _SCALARS[wire.code]


def row_fields(names: Sequence[str], types: Sequence[WireType]) -> tuple[RowField, ...]:
    """Return the fields of rows with these variables."""
    return tuple(RowField(name, scalar_of(wire), wire.length) for name, wire in zip(names, types, strict=True))


def columns_of(name: str, wire: WireType) -> tuple[str, ...]:
    """Return the names of the columns of a variable."""
    return RowField(name, scalar_of(wire), wire.length).columns


LISTS: Final = "lists"
"""Key in the metadata of the channel `ROWS`: JSON of the lengths of its lists, by field."""


def columns_by_variable(columns: Iterable[str]) -> dict[str, list[str]]:
    """Return the columns of each variable, in their order."""
    found: dict[str, list[str]] = {}
    for column in columns:
        found.setdefault(column.partition(".")[0], []).append(column)
    return found


def encoded(data: Mapping[str, Any]) -> bytes:
    """Return a record as JSON; what JSON cannot hold (infinity, NaN) as null."""
    try:
        text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    except ValueError:
        text = json.dumps(_finite(data), separators=(",", ":"), allow_nan=False)
    return encodable_json(text).encode()


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, Mapping):
        return {name: _finite(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(part) for part in value]
    return value


# ---------------------------------------------------------------- for viewers

JOINT_STATES: Final = "/joint_states"
TCP: Final = "/tcp"
FRAMES: Final = "/tf"
LOG: Final = "/log"

JOINT_NAMES: Final = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
"""As in URDF files of these arms (*assumed*: those of the driver for ROS 2)."""
BASE: Final = "base"
TOOL: Final = "tcp"

_TIME_SCHEMA: Final = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
_NUMBER: Final = {"type": "number"}
_TEXT: Final = {"type": "string"}


def _object(**properties: Any) -> dict[str, Any]:
    return {"type": "object", "properties": properties}


def _list(items: Any) -> dict[str, Any]:
    return {"type": "array", "items": items}


_VECTOR: Final = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION: Final = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)

SCHEMAS: Final[dict[str, tuple[str, dict[str, Any]]]] = {
    CHANGES: ("elitescript.Changes", _object(timestamp=_NUMBER)),
    SLOW: ("elitescript.Slow", _object(timestamp=_NUMBER)),
    PRIMARY: ("elitescript.Primary", _object(type=_TEXT)),
    DASHBOARD: ("elitescript.Dashboard", _object(type=_TEXT)),
    EVENTS: ("elitescript.Event", _object(type=_TEXT)),
    JOINT_STATES: (
        "foxglove.JointStates",
        _object(
            timestamp=_TIME_SCHEMA,
            joints=_list(_object(name=_TEXT, position=_NUMBER, velocity=_NUMBER, effort=_NUMBER)),
        ),
    ),
    TCP: (
        "foxglove.PoseInFrame",
        _object(timestamp=_TIME_SCHEMA, frame_id=_TEXT, pose=_object(position=_VECTOR, orientation=_QUATERNION)),
    ),
    FRAMES: (
        "foxglove.FrameTransforms",
        _object(
            transforms=_list(
                _object(
                    timestamp=_TIME_SCHEMA,
                    parent_frame_id=_TEXT,
                    child_frame_id=_TEXT,
                    translation=_VECTOR,
                    rotation=_QUATERNION,
                )
            )
        ),
    ),
    LOG: (
        "foxglove.Log",
        _object(
            timestamp=_TIME_SCHEMA,
            level={"type": "integer"},
            message=_TEXT,
            name=_TEXT,
            file=_TEXT,
            line={"type": "integer"},
        ),
    ),
}
"""Name and JSON schema of every channel but `ROWS`. Source of those of `foxglove.…`: docs.foxglove.dev, *Schemas*."""

LEVELS: Final = {"debug": 1, "info": 2, "warning": 3, "error": 4, "fatal": 5}
"""Of `foxglove.Log`."""


def stamp(time_ns: int) -> dict[str, int]:
    """Return a time as the schemas have it."""
    return {"sec": time_ns // 1_000_000_000, "nsec": time_ns % 1_000_000_000}


def joint_states(time_ns: int, q: Sequence[float], qd: Sequence[float], effort: Sequence[float]) -> dict[str, Any]:
    """Return a `foxglove.JointStates`; rad, rad/s, N m."""
    return {
        "timestamp": stamp(time_ns),
        "joints": [
            {"name": name, "position": position, "velocity": velocity, "effort": torque}
            for name, position, velocity, torque in zip(JOINT_NAMES, q, qd, effort, strict=True)
        ],
    }


def pose_in_frame(time_ns: int, pose: Sequence[float]) -> dict[str, Any]:
    """Return a `foxglove.PoseInFrame` of a pose in the base frame: m, and roll, pitch, yaw."""
    position, orientation = _place(pose)
    return {
        "timestamp": stamp(time_ns),
        "frame_id": BASE,
        "pose": {"position": position, "orientation": orientation},
    }


def frame_transforms(time_ns: int, pose: Sequence[float]) -> dict[str, Any]:
    """Return a `foxglove.FrameTransforms` of the TCP in the base frame."""
    position, orientation = _place(pose)
    return {
        "transforms": [
            {
                "timestamp": stamp(time_ns),
                "parent_frame_id": BASE,
                "child_frame_id": TOOL,
                "translation": position,
                "rotation": orientation,
            }
        ]
    }


def log_line(time_ns: int, level: str, text: str, name: str, line: int = 0) -> dict[str, Any]:
    """Return a `foxglove.Log`; the level is a key of `LEVELS`."""
    return {
        "timestamp": stamp(time_ns),
        "level": LEVELS[level],
        "message": text,
        "name": name,
        "file": "",
        "line": max(line, 0),
    }


def _place(pose: Sequence[float]) -> tuple[dict[str, float], dict[str, float]]:
    x, y, z, *rpy = pose
    qx, qy, qz, qw = quaternion(*rpy)
    return {"x": x, "y": y, "z": z}, {"x": qx, "y": qy, "z": qz, "w": qw}


def quaternion(rx: float, ry: float, rz: float) -> tuple[float, float, float, float]:
    """Return the unit quaternion x, y, z, w of roll, pitch, yaw (rad): turns about the fixed axes x, y, z."""
    (sx, cx), (sy, cy), (sz, cz) = ((sin(0.5 * angle), cos(0.5 * angle)) for angle in (rx, ry, rz))
    return (
        sx * cy * cz - cx * sy * sz,
        cx * sy * cz + sx * cy * sz,
        cx * cy * sz - sx * sy * cz,
        cx * cy * cz + sx * sy * sz,
    )
