"""Rigid transforms between frames.

`T_a_b` is the pose of frame b in frame a: a flat tuple of twelve floats, the row-major
rotation first, then the position in metres. Neighbouring frame names cancel:
`T_base_tcp = compose(T_base_flange, T_flange_tcp)`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeAlias

from elitescript.kinematics.rotations import (
    Rotation,
    Vector3,
    multiply,
    rotation_from_rotvec,
    rotation_from_rpy,
    rotvec_from_rotation,
    rpy_from_rotation,
    transpose,
)

Transform: TypeAlias = tuple[
    float, float, float, float, float, float, float, float, float, float, float, float
]  # fmt: skip
"""Rotation, row-major (9 floats), then position x, y, z in metres."""

IDENTITY: Final[Transform] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


def compose(T_a_b: Transform, T_b_c: Transform) -> Transform:
    """Return `T_a_c`."""
    a1, a2, a3, a4, a5, a6, a7, a8, a9, ax, ay, az = T_a_b
    b1, b2, b3, b4, b5, b6, b7, b8, b9, bx, by, bz = T_b_c
    return (
        a1 * b1 + a2 * b4 + a3 * b7,
        a1 * b2 + a2 * b5 + a3 * b8,
        a1 * b3 + a2 * b6 + a3 * b9,
        a4 * b1 + a5 * b4 + a6 * b7,
        a4 * b2 + a5 * b5 + a6 * b8,
        a4 * b3 + a5 * b6 + a6 * b9,
        a7 * b1 + a8 * b4 + a9 * b7,
        a7 * b2 + a8 * b5 + a9 * b8,
        a7 * b3 + a8 * b6 + a9 * b9,
        a1 * bx + a2 * by + a3 * bz + ax,
        a4 * bx + a5 * by + a6 * bz + ay,
        a7 * bx + a8 * by + a9 * bz + az,
    )


def inverse(T_a_b: Transform) -> Transform:
    """Return `T_b_a`."""
    r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = T_a_b
    return (
        r11,
        r21,
        r31,
        r12,
        r22,
        r32,
        r13,
        r23,
        r33,
        -(r11 * x + r21 * y + r31 * z),
        -(r12 * x + r22 * y + r32 * z),
        -(r13 * x + r23 * y + r33 * z),
    )


def transform_from_pose(p: Sequence[float]) -> Transform:
    """Return the transform of a script pose [x, y, z, rx, ry, rz] (m, rad, roll-pitch-yaw)."""
    x, y, z, rx, ry, rz = p
    return (*rotation_from_rpy(rx, ry, rz), x, y, z)


def pose_from_transform(T: Transform) -> tuple[float, float, float, float, float, float]:
    """Return the script pose (x, y, z, rx, ry, rz) with canonical angles (m, rad)."""
    r11, r12, r13, r21, r22, r23, r31, r32, r33, x, y, z = T
    rx, ry, rz = rpy_from_rotation((r11, r12, r13, r21, r22, r23, r31, r32, r33))
    return x, y, z, rx, ry, rz


def rotation_of(T: Transform) -> Rotation:
    """Return the rotation `R_a_b` of `T_a_b`."""
    r11, r12, r13, r21, r22, r23, r31, r32, r33, _, _, _ = T
    return r11, r12, r13, r21, r22, r23, r31, r32, r33


def position_of(T: Transform) -> Vector3:
    """Return the origin of frame b in frame a, m."""
    return T[9], T[10], T[11]


def apply(T: Transform, v: Sequence[float]) -> Vector3:
    """Return in frame a the point that has the coordinates v (m) in frame b, for `T_a_b`."""
    x, y, z = v
    return (
        T[0] * x + T[1] * y + T[2] * z + T[9],
        T[3] * x + T[4] * y + T[5] * z + T[10],
        T[6] * x + T[7] * y + T[8] * z + T[11],
    )


def interpolate(T_0: Transform, T_1: Transform, s: float) -> Transform:
    """Return the transform a fraction s of the way from T_0 to T_1.

    The position runs along the straight line, the orientation turns about one fixed axis
    through the smaller angle, both in proportion to s. Outside [0, 1] the same line and
    rotation go on. For orientations half a turn apart see `rotvec_from_rotation`.
    """
    R_0 = rotation_of(T_0)
    vx, vy, vz = rotvec_from_rotation(multiply(transpose(R_0), rotation_of(T_1)))
    R = multiply(R_0, rotation_from_rotvec((s * vx, s * vy, s * vz)))
    x, y, z = T_0[9], T_0[10], T_0[11]
    return (*R, x + s * (T_1[9] - x), y + s * (T_1[10] - y), z + s * (T_1[11] - z))
