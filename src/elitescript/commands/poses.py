"""Arithmetic with poses (manual 2.10 sections 2.2.24 to 2.2.32).

A pose is [x, y, z, Rx, Ry, Rz] in m and rad, R = Rz(Rz) Ry(Ry) Rx(Rx) about fixed axes. Results have their pitch in
[-pi/2, pi/2].
"""

from __future__ import annotations

from typing import Annotated

from elitescript.commands.definition.quantities import Frame, Number, Pose, Real, Vector
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import Result
from elitescript.kinematics import pose as algebra

_Angles = Annotated[tuple[float, float, float], Vector(Number(), 3, "rad")]
_RollPitchYaw = Annotated[tuple[float, float, float], Vector(Number(), 3, "rad", meaning="roll, pitch, yaw")]


@command(family="math", manual="2.2.24")
def point_dist(p_from: Frame, p_to: Frame) -> Annotated[float, Number("m", 0.0)]:
    """Return the distance of the positions of two poses; orientations do not count.

    Args:
        p_from: first pose.
        p_to: second pose.

    Returns:
        The distance.
    """
    return algebra.point_dist(p_from, p_to)


@command(family="math", manual="2.2.25")
def pose_add(p_1: Frame, p_2: Frame) -> Frame:
    """Return the sum of the positions and the product of the orientations: p_1.P + p_2.P and R(p_1) R(p_2).

    Args:
        p_1: first pose.
        p_2: second pose.

    Returns:
        The sum.
    """
    return algebra.pose_add(p_1, p_2)


@command(family="math", manual="2.2.26")
def pose_dist(p_from: Frame, p_to: Frame) -> Annotated[float, Number("", 0.0)]:
    """Return the root of the sum of the six squared differences of two poses, m and rad mixed.

    Angles are subtracted as they stand; only this gives the result that the manual prints.

    Args:
        p_from: first pose.
        p_to: second pose.

    Returns:
        The root.
    """
    return algebra.pose_dist(p_from, p_to)


@command(family="math", manual="2.2.27")
def pose_inv(p_from: Frame) -> Frame:
    """Return the inverse of a pose: where the reference frame is, seen from the frame `p_from`.

    Args:
        p_from: the pose.

    Returns:
        The inverse.
    """
    return algebra.pose_inv(p_from)


@command(family="math", manual="2.2.28")
def pose_sub(p_to: Frame, p_from: Frame) -> Frame:
    """Return the difference of the positions with the rotation between the orientations: R(p_from)^-1 R(p_to).

    The difference of the positions stays in the axes in which they are given.

    Args:
        p_to: pose to subtract from.
        p_from: pose to subtract.

    Returns:
        The difference.
    """
    return algebra.pose_sub(p_to, p_from)


@command(family="math", manual="2.2.29")
def pose_trans(p_from: Frame, p_from_to: Frame) -> Annotated[Pose, Result("computed", frame="p_from")]:
    """Chain two poses: T(p_from) T(p_from_to).

    Args:
        p_from: pose of a frame.
        p_from_to: pose in that frame.

    Returns:
        The second pose, in the frame in which the first is given.
    """
    return algebra.pose_trans(p_from, p_from_to)


@command(family="math", manual="2.2.30")
def rotvec2rpy(rotation_vector: _Angles) -> _Angles:
    """Return the roll-pitch-yaw angles of a rotation vector.

    Args:
        rotation_vector: unit axis times angle.

    Returns:
        [roll, pitch, yaw].
    """
    return algebra.rotvec2rpy(rotation_vector)


@command(family="math", manual="2.2.31")
def rpy2rotvec(rpy_vector: _RollPitchYaw) -> _Angles:
    """Return the rotation vector of roll-pitch-yaw angles.

    Args:
        rpy_vector: [roll, pitch, yaw].

    Returns:
        Unit axis times angle.
    """
    return algebra.rpy2rotvec(rpy_vector)


@command(family="math", manual="2.2.32")
def interpolate_pose(p_from: Frame, p_to: Frame, alpha: Real) -> Frame:
    """Return the pose on the straight line from one pose to another, turning about one fixed axis.

    Args:
        p_from: pose at 0.
        p_to: pose at 1.
        alpha: where on the line; below 0 and above 1 the line goes on.

    Returns:
        The pose; at 0 it is `p_from` with its pitch in [-pi/2, pi/2].
    """
    return algebra.interpolate_pose(p_from, p_to, alpha)
