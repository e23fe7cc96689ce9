"""A robot, its limits and start points for tests of motion."""

from __future__ import annotations

from dataclasses import replace
from math import asin, cos, pi, sin
from typing import Any

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, solve_branch
from elitescript.kinematics.transforms import Transform, compose, inverse, pose_from_transform, transform_from_pose
from elitescript.messages.motion import MoveL, Six
from elitescript.models.model import load_model
from elitescript.motion.limits import MotionLimits

FULL_TURN = 2.0 * pi

Q_WORK: Six = (0.3, -1.5, -1.6, -1.5, 1.5, 0.2)
"""Tool down in front of the arm, far from every singularity."""

Q_NEAR_WRIST: Six = (0.3, -1.5, -1.6, -1.5, 0.12, 0.2)
"""The same with joint 5 near zero."""

T_FLANGE_TCP: Transform = transform_from_pose((0.02, -0.01, 0.15, 0.1, -0.2, 0.3))


def six(values: Any) -> Six:
    """Six numbers as the tuple that requests hold."""
    a, b, c, d, e, f = values
    return a, b, c, d, e, f


def limits_of(name: str, **changes: Any) -> MotionLimits:
    """The limits of a robot model, some of them changed."""
    model = load_model(name)
    joints = model.joints
    limits = MotionLimits(
        q_min=six(joint.q_min for joint in joints),
        q_max=six(joint.q_max for joint in joints),
        qd_max=six(joint.qd_max for joint in joints),
        qdd_max=six(joint.qdd_max for joint in joints),
        tool_speed_max=model.max_tool_speed,
        tool_acceleration_max=model.max_tool_acceleration,
        equivalent_radius_m=model.equivalent_radius_m,
    )
    return replace(limits, **changes)


ARM: Arm = load_model("CS66").arm
LIMITS = limits_of("CS66")
UNBOUND = limits_of("CS66", qd_max=(1e3,) * 6, qdd_max=(1e5,) * 6)
"""Joint limits that never bind."""


def tcp_pose(q: Six) -> Six:
    """The pose of the TCP at joint angles."""
    return pose_from_transform(ARM.forward_tcp(q, T_FLANGE_TCP))


def line_by(q: Six, *offset: float, a: float = 1.2, v: float = 0.25, t_s: float = 0.0) -> MoveL:
    """A line that shifts the TCP by up to three lengths (m) and three angles (rad) of its pose."""
    offsets = (*offset, *(0.0,) * (6 - len(offset)))
    return MoveL(six(x + dx for x, dx in zip(tcp_pose(q), offsets, strict=True)), a, v, t_s)


def shifted(q: Six, *offset: float) -> Six:
    """The TCP pose at q, shifted as by `line_by`."""
    return line_by(q, *offset).p_target


def wrist_passage(nearest_sine: float) -> tuple[Six, MoveL]:
    """Start and request of a line of 0.2 m that passes the wrist singularity at a distance in the middle.

    Half way |sin q5| has its smallest value; joints 4 and 6 swing by nearly half a turn there.
    """
    q_middle = six((*Q_WORK[:3], -0.5 * pi - Q_WORK[1] - Q_WORK[2] - pi, asin(nearest_sine), Q_WORK[5]))
    along = 0.1 * sin(q_middle[0]), -0.1 * cos(q_middle[0])
    T_start = compose(transform_from_pose(shifted(q_middle, -along[0], -along[1])), inverse(T_FLANGE_TCP))
    q_start = solve_branch(ARM, T_start, branch_of(ARM, q_middle))
    assert q_start is not None
    # A full turn back, so that the swing of joint 4 stays in its range.
    q_start = six((*q_start[:3], q_start[3] - FULL_TURN if q_start[3] > 0.0 else q_start[3], *q_start[4:]))
    return q_start, line_by(q_middle, *along)


def turned(q: Six, joint: int, angle: float) -> Six:
    """The TCP pose after one joint has turned."""
    return tcp_pose(six(x + angle * (index == joint) for index, x in enumerate(q)))


def largest_difference(a: Any, b: Any) -> float:
    """The largest absolute difference of two rows of numbers."""
    return max(abs(x - y) for x, y in zip(a, b, strict=True))
