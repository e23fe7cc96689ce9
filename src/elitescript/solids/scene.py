"""Describes what a page draws: the arm as solids, its frames and limits, tool, payload and things, as JSON has it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import acos, hypot, pi
from typing import Any, Final

from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import transform_from_pose
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.models.model import RobotModel
from elitescript.solids.arm import arm_parts
from elitescript.solids.shapes import Part, pose_of

DIGITS: Final = 6
"""Decimals of lengths and poses: a micrometre."""


def scene(
    model: RobotModel,
    *,
    tcp: Six = ZERO_SIX,
    payload_kg: float = 0.0,
    center_of_gravity: Vector3 = (0.0, 0.0, 0.0),
    gravity: Sequence[float] | None = None,
    parts: Iterable[Part] = (),
    urdf: str = "",
) -> dict[str, Any]:
    """Return the message `scene`: the robot and what is around it as the run begins.

    Args:
        model: of the arm.
        tcp: in the flange frame, as scripts have it: m, roll, pitch and yaw in rad.
        payload_kg: payload that is set.
        center_of_gravity: of it, flange frame, m.
        gravity: vector that points away from the earth, base frame, m/s^2; that of the model if None.
        parts: solids of tool, payload and things; see `cell.Cell.parts`.
        urdf: name of the user's URDF, if there is one.

    Raises:
        UsageError: a row of the outline in the model's file is wrong.
    """
    a, d, alpha = model.arm.modified_dh
    joints = model.joints
    message: dict[str, Any] = {
        "type": "scene",
        "robot": model.name,
        "dh": [{"a": a[i], "d": d[i], "alpha": alpha[i]} for i in range(6)],
        "parts": [_part(part) for part in (*arm_parts(model), *parts)],
        "limits": {
            "position_min": [joint.q_min for joint in joints],
            "position_max": [joint.q_max for joint in joints],
            "speed": [joint.qd_max for joint in joints],
            "acceleration": [joint.qdd_max for joint in joints],
            "tcp_speed": model.max_tool_speed,
            "reach": model.reach_m,
        },
        "tcp": list(pose_of(transform_from_pose(tcp))),
        "payload_kg": payload_kg,
        "center_of_gravity": list(center_of_gravity),
        "mounting": list(mounting_of(model.gravity if gravity is None else gravity)),
    }
    if urdf:
        message["urdf"] = urdf
    return message


def mounting_of(gravity: Sequence[float]) -> Six:
    """Return the pose of the base in the world, by the shortest turn: m, rotation vector in rad.

    Args:
        gravity: vector that points away from the earth, base frame.
    """
    x, y, z = gravity
    length = hypot(x, y, z)
    if length == 0.0:
        return ZERO_SIX
    # The turn takes this vector to the z axis of the world: its axis is the product of both.
    sine = hypot(x, y)
    if sine <= _UPRIGHT * length:
        return ZERO_SIX if z > 0.0 else (0.0, 0.0, 0.0, pi, 0.0, 0.0)
    angle = acos(max(-1.0, min(1.0, z / length)))
    return 0.0, 0.0, 0.0, angle * y / sine, -angle * x / sine, 0.0


_UPRIGHT: Final = 1e-9
"""Sine of an angle that is nothing but rounding."""


def _part(part: Part) -> dict[str, Any]:
    fields: dict[str, Any] = {
        "link": part.link,
        "kind": part.kind,
        "size": [round(number, DIGITS) for number in part.size],
        "pose": [round(number, DIGITS) for number in part.pose],
        "role": part.role,
    }
    if part.name:
        fields["name"] = part.name
    if part.color:
        fields["color"] = part.color
    return fields
