"""Rotations: matrix, roll-pitch-yaw and rotation vector.

A rotation is a flat, row-major tuple of nine floats. The columns of `R_a_b` are the axes of
frame b written in frame a. Orientations of poses are roll-pitch-yaw angles throughout the
script language; rotation vectors occur in interpolation, in angular errors, and in the two
script commands that convert to and from them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, pi, sin, sqrt
from typing import Final, TypeAlias

Rotation: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
"""Row-major 3x3 rotation matrix."""

Vector3: TypeAlias = tuple[float, float, float]
"""Three components along x, y, z."""

RPY: TypeAlias = tuple[float, float, float]
"""Angles (rx, ry, rz), rad, with R = Rz(rz) Ry(ry) Rx(rx): turns about the fixed axes x, y, z."""

IDENTITY_ROTATION: Final[Rotation] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)

GIMBAL_MARGIN_RAD: Final = 1e-12
"""So near to pitch +-pi/2 roll and yaw turn about the same axis and only their sum or
difference is left in the matrix; roll is then set to zero. The vendor's library draws the
line at the same place."""


def rotation_from_rpy(rx: float, ry: float, rz: float) -> Rotation:
    """Return the matrix of roll-pitch-yaw angles in rad; any real angles are accepted.

    Source: script manual 2.14, `rotvec2rpy`, and every printed pose example of 2.10 and 2.14.
    """
    cx = cos(rx)
    sx = sin(rx)
    cy = cos(ry)
    sy = sin(ry)
    cz = cos(rz)
    sz = sin(rz)
    cz_sy = cz * sy
    sz_sy = sz * sy
    return (
        cz * cy,
        cz_sy * sx - sz * cx,
        cz_sy * cx + sz * sx,
        sz * cy,
        sz_sy * sx + cz * cx,
        sz_sy * cx - cz * sx,
        -sy,
        cy * sx,
        cy * cx,
    )


def rpy_from_rotation(R: Rotation) -> RPY:
    """Return the canonical angles (rx, ry, rz), rad: ry in [-pi/2, pi/2], rx and rz in [-pi, pi].

    At pitch +-pi/2 (within `GIMBAL_MARGIN_RAD`) rx is zero and rz carries the whole turn.
    """
    ry = atan2(-R[6], sqrt(R[0] * R[0] + R[3] * R[3]))
    if -PITCH_LIMIT <= ry <= PITCH_LIMIT:
        return atan2(R[7], R[8]), ry, atan2(R[3], R[0])
    return 0.0, ry, atan2(-R[1], R[4])


def rotation_from_rotvec(v: Sequence[float]) -> Rotation:
    """Return the matrix of a rotation vector: unit axis times angle in rad (Rodrigues' formula)."""
    x, y, z = v
    angle = sqrt(x * x + y * y + z * z)
    if angle < _SMALL_ANGLE:
        sine_ratio = 1.0
        half_square_ratio = 0.5
    else:
        sine_ratio = sin(angle) / angle
        # (1 - cos t) / t^2 in a form that does not cancel for small t.
        half_sine_ratio = sin(0.5 * angle) / angle
        half_square_ratio = 2.0 * half_sine_ratio * half_sine_ratio
    kx = half_square_ratio * x
    ky = half_square_ratio * y
    kz = half_square_ratio * z
    c = 1.0 - (kx * x + ky * y + kz * z)
    sx = sine_ratio * x
    sy = sine_ratio * y
    sz = sine_ratio * z
    xy = kx * y
    xz = kx * z
    yz = ky * z
    return (c + kx * x, xy - sz, xz + sy, xy + sz, c + ky * y, yz - sx, xz - sy, yz + sx, c + kz * z)


def rotvec_from_rotation(R: Rotation) -> Vector3:
    """Return the rotation vector, rad, with its length in [0, pi].

    Keeps full precision near no rotation and near a half turn. At exactly half a turn both
    axis directions are right; the one whose largest component is positive is returned.
    """
    r11, r12, r13, r21, r22, r23, r31, r32, r33 = R
    vx = 0.5 * (r32 - r23)
    vy = 0.5 * (r13 - r31)
    vz = 0.5 * (r21 - r12)
    sine = sqrt(vx * vx + vy * vy + vz * vz)
    cosine = 0.5 * (r11 + r22 + r33 - 1.0)
    if cosine > _HALF_TURN_COSINE:
        if sine < _SMALL_ANGLE:
            return vx, vy, vz
        ratio = atan2(sine, cosine) / sine
        return ratio * vx, ratio * vy, ratio * vz
    # Near a half turn the antisymmetric part vanishes. The symmetric part is
    # cos t E + (1 - cos t) u u^T; its largest diagonal element gives the best column of u u^T.
    if r11 >= r22 and r11 >= r33:
        ux, uy, uz = r11 - cosine, 0.5 * (r12 + r21), 0.5 * (r13 + r31)
    elif r22 >= r33:
        ux, uy, uz = 0.5 * (r12 + r21), r22 - cosine, 0.5 * (r23 + r32)
    else:
        ux, uy, uz = 0.5 * (r13 + r31), 0.5 * (r23 + r32), r33 - cosine
    ratio = atan2(sine, cosine) / sqrt(ux * ux + uy * uy + uz * uz)
    if ux * vx + uy * vy + uz * vz < 0.0:
        ratio = -ratio
    return ratio * ux, ratio * uy, ratio * uz


def multiply(A: Rotation, B: Rotation) -> Rotation:
    """Return the product A B: `R_a_c = multiply(R_a_b, R_b_c)`."""
    a1, a2, a3, a4, a5, a6, a7, a8, a9 = A
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = B
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
    )


def transpose(R: Rotation) -> Rotation:
    """Return the inverse rotation: `R_b_a = transpose(R_a_b)`."""
    r11, r12, r13, r21, r22, r23, r31, r32, r33 = R
    return r11, r21, r31, r12, r22, r32, r13, r23, r33


def rotate(R: Rotation, v: Sequence[float]) -> Vector3:
    """Return R v: the components in frame a of a vector given in frame b, for `R_a_b`."""
    x, y, z = v
    return (
        R[0] * x + R[1] * y + R[2] * z,
        R[3] * x + R[4] * y + R[5] * z,
        R[6] * x + R[7] * y + R[8] * z,
    )


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Return the vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def from_columns(x: Vector3, y: Vector3, z: Vector3) -> Rotation:
    """Return the rotation whose columns are three axes."""
    return x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]


PITCH_LIMIT: Final = 0.5 * pi - GIMBAL_MARGIN_RAD

_SMALL_ANGLE: Final = 1e-9
"""Below it sin t = t to the last bit, and dividing by t would only add noise (rad)."""

_HALF_TURN_COSINE: Final = -0.5
"""Beyond 120 deg the symmetric part of the matrix gives the better axis."""
