"""The fields of a snapshot and of its robot, by the part that they are in, written by hand."""

from __future__ import annotations

from dataclasses import fields, replace

from elitescript.messages.snapshot import Snapshot
from elitescript.messages.snapshot_parts import (
    ELBOW,
    JOINTS,
    LOADS,
    POSES,
    TCP_SPEEDS,
    TEMPERATURES,
    TIME,
    WRENCHES,
)

FIELDS: dict[int, frozenset[str]] = {
    TIME: frozenset({"tick", "time_s", "is_moving", "line", "node", "speed_scaling"}),
    JOINTS: frozenset({"q_target", "qd_target", "q_actual", "qd_actual"}),
    POSES: frozenset({"tcp_pose_target", "tcp_pose_actual", "flange_pose_actual"}),
    TCP_SPEEDS: frozenset({"tcp_speed_target", "tcp_speed_actual"}),
    LOADS: frozenset({"joint_torques", "joint_currents", "robot_current"}),
    WRENCHES: frozenset({"tcp_force", "raw_wrench"}),
    ELBOW: frozenset({"elbow_position", "elbow_velocity"}),
    TEMPERATURES: frozenset({"joint_temperatures", "controller_temperature", "tool_temperature"}),
}

DISCRETE = frozenset(
    {
        "robot_mode",
        "safety_mode",
        "task_state",
        "tcp_offset",
        "payload",
        "gravity",
        "speed_scale",
        "joint_voltages",
        "robot_voltage",
        "io_current",
        "tool_current",
        "signals",
        "domains",
        "tool_analog_mode",
        "tool_pin_modes",
        "is_remote",
        "is_freedrive",
        "popup",
        "task",
        "overruns",
        "is_guided_by_input",
    }
)


def values_of(snapshot: Snapshot) -> dict[str, object]:
    """All fields by name."""
    found = {field.name: getattr(snapshot, field.name) for field in fields(snapshot)}
    robot = found.pop("robot")
    return found | {field.name: getattr(robot, field.name) for field in fields(robot)}


def with_parts_of(snapshot: Snapshot, other: Snapshot, parts: int) -> Snapshot:
    """Return a snapshot with these parts of another one."""
    names = {name for part, in_part in FIELDS.items() if parts & part for name in in_part}
    of_robot = {name: getattr(other.robot, name) for name in names if hasattr(other.robot, name)}
    rest = {name: getattr(other, name) for name in names - of_robot.keys()}
    return replace(snapshot, robot=replace(snapshot.robot, **of_robot), **rest)
