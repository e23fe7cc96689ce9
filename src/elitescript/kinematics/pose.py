"""The pose algebra of the script language.

A pose is a sequence [x, y, z, rx, ry, rz]: position in metres, orientation as roll-pitch-yaw
angles in radians (see `rotations`). Results are tuples with canonical angles, so a pose given
with a pitch beyond +-pi/2 comes back as the same orientation in other numbers. The functions
expect six finite numbers; the command checks its arguments.

Source: script manual 2.14, chapter on mathematical commands; the printed examples of 2.10 and
2.14 decide where the text is unclear.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import TypeAlias

from elitescript.errors import InvalidValueError
from elitescript.kinematics.rotations import (
    RPY,
    Vector3,
    multiply,
    rotation_from_rotvec,
    rotation_from_rpy,
    rotvec_from_rotation,
    rpy_from_rotation,
    transpose,
)
from elitescript.kinematics.transforms import (
    compose,
    interpolate,
    inverse,
    pose_from_transform,
    transform_from_pose,
)
from elitescript.said import said

Pose: TypeAlias = tuple[float, float, float, float, float, float]
"""(x, y, z, rx, ry, rz) in m and rad, roll-pitch-yaw."""

FRAME_POINT_DISTANCE_M = 1e-6
"""Points of a frame that are closer together, or closer to one line, than the last printed digit
of a pose do not define a direction."""


def pose_add(p_1: Sequence[float], p_2: Sequence[float]) -> Pose:
    """Return the sum of the positions with the product R_1 R_2 of the orientations."""
    R_1, R_2 = rotation_from_rpy(p_1[3], p_1[4], p_1[5]), rotation_from_rpy(p_2[3], p_2[4], p_2[5])
    rx, ry, rz = rpy_from_rotation(multiply(R_1, R_2))
    return p_1[0] + p_2[0], p_1[1] + p_2[1], p_1[2] + p_2[2], rx, ry, rz


def pose_sub(p_to: Sequence[float], p_from: Sequence[float]) -> Pose:
    """Return the difference of the positions, in the axes they are given in, with R_from^-1 R_to."""
    R_from = rotation_from_rpy(p_from[3], p_from[4], p_from[5])
    R_to = rotation_from_rpy(p_to[3], p_to[4], p_to[5])
    rx, ry, rz = rpy_from_rotation(multiply(transpose(R_from), R_to))
    return p_to[0] - p_from[0], p_to[1] - p_from[1], p_to[2] - p_from[2], rx, ry, rz


def pose_inv(p_from: Sequence[float]) -> Pose:
    """Return the pose of the reference frame as seen from the posed frame."""
    return pose_from_transform(inverse(transform_from_pose(p_from)))


def pose_trans(p_from: Sequence[float], p_from_to: Sequence[float]) -> Pose:
    """Return in the base the pose that is `p_from_to` as seen from the frame `p_from`."""
    return pose_from_transform(compose(transform_from_pose(p_from), transform_from_pose(p_from_to)))


def pose_dist(p_from: Sequence[float], p_to: Sequence[float]) -> float:
    """Return the root of the sum of all six squared differences, m and rad mixed.

    There is no rotation algebra in it and angles are not wrapped: only this reproduces the
    example of manual 2.10.
    """
    x_0, y_0, z_0, rx_0, ry_0, rz_0 = p_from
    x_1, y_1, z_1, rx_1, ry_1, rz_1 = p_to
    position = (x_1 - x_0) ** 2 + (y_1 - y_0) ** 2 + (z_1 - z_0) ** 2
    return sqrt(position + (rx_1 - rx_0) ** 2 + (ry_1 - ry_0) ** 2 + (rz_1 - rz_0) ** 2)


def point_dist(p_from: Sequence[float], p_to: Sequence[float]) -> float:
    """Return the distance of the positions, m; orientations do not count."""
    return sqrt((p_to[0] - p_from[0]) ** 2 + (p_to[1] - p_from[1]) ** 2 + (p_to[2] - p_from[2]) ** 2)


def interpolate_pose(p_from: Sequence[float], p_to: Sequence[float], alpha: float) -> Pose:
    """Return the pose a fraction alpha of the way along the straight line; alpha may leave [0, 1].

    The orientation turns about a fixed axis (`transforms.interpolate`). With alpha 0 the result
    is `p_from` in canonical angles, as the example of manual 2.14 shows.
    """
    return pose_from_transform(interpolate(transform_from_pose(p_from), transform_from_pose(p_to), alpha))


def rotvec2rpy(rotation_vector: Sequence[float]) -> RPY:
    """Return the roll-pitch-yaw angles, rad, of a rotation vector (unit axis times angle in rad)."""
    return rpy_from_rotation(rotation_from_rotvec(rotation_vector))


def rpy2rotvec(rpy_vector: Sequence[float]) -> Vector3:
    """Return the rotation vector (unit axis times angle in rad) of roll-pitch-yaw angles in rad."""
    rx, ry, rz = rpy_vector
    return rotvec_from_rotation(rotation_from_rpy(rx, ry, rz))


def frame_from_points(origin: Sequence[float], x_point: Sequence[float], xy_point: Sequence[float]) -> Pose:
    """Return the pose of the frame that three points define.

    The frame stands at `origin`, its x axis goes through `x_point`, and `xy_point` lies in its
    xy plane on the side of positive y. Only the first three elements (m) of each are read, so
    poses may be passed. Assumed: the command that generated programs call `cal_rpy_frame` is
    not in the manuals; this is the usual three-point method.

    Raises:
        InvalidValueError: points that coincide, or lie on one line, within `FRAME_POINT_DISTANCE_M`.
    """
    ox, oy, oz = origin[0], origin[1], origin[2]
    xx, xy, xz = x_point[0] - ox, x_point[1] - oy, x_point[2] - oz
    length = sqrt(xx * xx + xy * xy + xz * xz)
    if not length > FRAME_POINT_DISTANCE_M:
        raise InvalidValueError(
            said(
                "the point on the x axis is {length:.3g} m from the origin; they have to be two different points",
                length=length,
            ),
            argument="x_point",
            value=length,
            limit=f"> {FRAME_POINT_DISTANCE_M:g}",
            unit="m",
        )
    xx /= length
    xy /= length
    xz /= length
    vx, vy, vz = xy_point[0] - ox, xy_point[1] - oy, xy_point[2] - oz
    zx = xy * vz - xz * vy
    zy = xz * vx - xx * vz
    zz = xx * vy - xy * vx
    distance = sqrt(zx * zx + zy * zy + zz * zz)
    if not distance > FRAME_POINT_DISTANCE_M:
        raise InvalidValueError(
            said(
                "the point in the xy plane is {distance:.3g} m from the x axis; the three points lie on one line",
                distance=distance,
            ),
            argument="xy_point",
            value=distance,
            limit=f"> {FRAME_POINT_DISTANCE_M:g}",
            unit="m",
        )
    zx /= distance
    zy /= distance
    zz /= distance
    yx = zy * xz - zz * xy
    yy = zz * xx - zx * xz
    yz = zx * xy - zy * xx
    rx, ry, rz = rpy_from_rotation((xx, yx, zx, xy, yy, zy, xz, yz, zz))
    return ox, oy, oz, rx, ry, rz
