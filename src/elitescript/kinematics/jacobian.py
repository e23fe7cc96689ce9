"""Velocities: Jacobian, TCP twist, joint speeds, and the distance from singularities.

A twist is (vx, vy, vz, wx, wy, wz): velocity of the TCP in m/s and angular velocity in rad/s,
both in the base frame. Symbols are those of `arm`.

Joints 5 and 6 pass through the wrist centre, so its velocity depends on joints 1 to 4 alone
and the inverse is explicit. With the flange as TCP, det J = a2 a3 s3 s5 X, where
X = a2 c2 + a3 c23 + d5 s234 is the radial coordinate of the wrist centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin
from typing import Final, TypeAlias

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.limits import SixFloats
from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import IDENTITY, Transform, apply
from elitescript.records import NamedTuple

Matrix6: TypeAlias = tuple[SixFloats, SixFloats, SixFloats, SixFloats, SixFloats, SixFloats]
"""Six rows: three of linear velocity (m), three of angular velocity, per rad/s of each joint."""

WRIST_GIVE_UP_SINE: Final = 0.001
"""A Cartesian move that meets |sin q5| below this ends with a singularity error. Joints 4 and 6
would turn a thousand times as fast as the tool."""

ELBOW_GIVE_UP_SINE: Final = 0.001
"""The same for |sin q3|: arm stretched, or folded onto itself."""

SHOULDER_GIVE_UP_M: Final = 0.001
"""The same for |X|: the wrist centre is at its smallest distance from the base axis, and joint 1
would turn with the tool speed divided by X."""

EXACT_SINGULAR: Final = 1e-9
"""Below it (m, or sine) `joint_speeds` has no result: what is left of the digits is noise."""


class Singularity(NamedTuple):
    """Distance from the three singularities; zero is exactly singular."""

    wrist: float
    """|sin q5|."""
    elbow: float
    """|sin q3|."""
    shoulder: float
    """|X|, m."""

    @property
    def blocked(self) -> str | None:
        """Name of the singularity that is too near for a Cartesian move, or None."""
        if self.wrist < WRIST_GIVE_UP_SINE:
            return "wrist"
        if self.elbow < ELBOW_GIVE_UP_SINE:
            return "elbow"
        if self.shoulder < SHOULDER_GIVE_UP_M:
            return "shoulder"
        return None


def singularity(arm: Arm, q: Sequence[float]) -> Singularity:
    """Return how far joint angles (rad) are from the singularities, by the nominal lengths."""
    _, q2, q3, q4, q5, _ = q
    q23 = q2 + q3
    X = arm.a2 * cos(q2) + arm.a3 * cos(q23) + arm.d5 * sin(q23 + q4)
    return Singularity(abs(sin(q5)), abs(sin(q3)), abs(X))


def is_blocked(arm: Arm, q: Sequence[float]) -> bool:
    """Return whether joint angles (rad) are too near to a singularity for a Cartesian move; see `Singularity`."""
    _, q2, q3, q4, q5, _ = q
    q23 = q2 + q3
    return (
        -WRIST_GIVE_UP_SINE < sin(q5) < WRIST_GIVE_UP_SINE
        or -ELBOW_GIVE_UP_SINE < sin(q3) < ELBOW_GIVE_UP_SINE
        or -SHOULDER_GIVE_UP_M < arm.a2 * cos(q2) + arm.a3 * cos(q23) + arm.d5 * sin(q23 + q4) < SHOULDER_GIVE_UP_M
    )


def jacobian(arm: Arm, q: Sequence[float], T_flange_tcp: Transform = IDENTITY) -> Matrix6:
    """Return the geometric Jacobian of the TCP in the base frame; twist = J qd."""
    if arm.calibration is not None:
        from elitescript.kinematics.chain import jacobian_columns

        axes, T_base_flange = arm.calibration.axes(q)
        columns = jacobian_columns(axes, apply(T_base_flange, T_flange_tcp[9:]))
        vx, vy, vz, wx, wy, wz = zip(*columns, strict=True)
        return vx, vy, vz, wx, wy, wz
    q1, q2, q3, q4, q5, q6 = q
    q23 = q2 + q3
    q234 = q23 + q4
    c1 = cos(q1)
    s1 = sin(q1)
    c234 = cos(q234)
    s234 = sin(q234)
    c5 = cos(q5)
    s5 = sin(q5)
    # From the wrist centre to the TCP, in (r, z, n) components.
    er, ez, en = _wrist_to_tcp(arm.d6, c234, s234, c5, s5, q6, T_flange_tcp)
    # From joints 4, 3 and 2 to the TCP.
    r4 = arm.d5 * s234 + er
    z4 = ez - arm.d5 * c234
    r3 = r4 + arm.a3 * cos(q23)
    z3 = z4 + arm.a3 * sin(q23)
    r2 = r3 + arm.a2 * cos(q2)
    z2 = z3 + arm.a2 * sin(q2)
    n1 = arm.d4 + en
    # Joint 5 is (s234, -c234, 0), joint 6 is (-c234 s5, -s234 s5, c5); linear part z x e.
    j5r = -c234 * en
    j5z = -s234 * en
    j5n = s234 * ez + c234 * er
    z6r = -c234 * s5
    z6z = -s234 * s5
    j6r = z6z * en - c5 * ez
    j6z = c5 * er - z6r * en
    j6n = z6r * ez - z6z * er
    return (
        (c1 * n1 - s1 * r2, -c1 * z2, -c1 * z3, -c1 * z4, c1 * j5r + s1 * j5n, c1 * j6r + s1 * j6n),
        (c1 * r2 + s1 * n1, -s1 * z2, -s1 * z3, -s1 * z4, s1 * j5r - c1 * j5n, s1 * j6r - c1 * j6n),
        (0.0, r2, r3, r4, j5z, j6z),
        (0.0, s1, s1, s1, c1 * s234, c1 * z6r + s1 * c5),
        (0.0, -c1, -c1, -c1, s1 * s234, s1 * z6r - c1 * c5),
        (1.0, 0.0, 0.0, 0.0, -c234, z6z),
    )


def tcp_twist(arm: Arm, q: Sequence[float], qd: Sequence[float], T_flange_tcp: Transform = IDENTITY) -> SixFloats:
    """Return the twist of the TCP in the base frame for joint speeds in rad/s."""
    if arm.calibration is not None:
        rows = jacobian(arm, q, T_flange_tcp)
        vx, vy, vz, wx, wy, wz = (sum(j * speed for j, speed in zip(row, qd, strict=True)) for row in rows)
        return vx, vy, vz, wx, wy, wz
    q1, q2, q3, q4, q5, q6 = q
    qd1, qd2, qd3, qd4, qd5, qd6 = qd
    q23 = q2 + q3
    q234 = q23 + q4
    qd23 = qd2 + qd3
    qd234 = qd23 + qd4
    c1 = cos(q1)
    s1 = sin(q1)
    c234 = cos(q234)
    s234 = sin(q234)
    c5 = cos(q5)
    s5 = sin(q5)
    er, ez, en = _wrist_to_tcp(arm.d6, c234, s234, c5, s5, q6, T_flange_tcp)
    # Angular velocity and velocity of the wrist centre, in (r, z, n) components.
    wr = s234 * qd5 - c234 * s5 * qd6
    wz = qd1 - c234 * qd5 - s234 * s5 * qd6
    wn = qd234 + c5 * qd6
    a2_qd2 = arm.a2 * qd2
    a3_qd23 = arm.a3 * qd23
    d5_qd234 = arm.d5 * qd234
    c2 = cos(q2)
    c23 = cos(q23)
    X = arm.a2 * c2 + arm.a3 * c23 + arm.d5 * s234
    vr = arm.d4 * qd1 - a2_qd2 * sin(q2) - a3_qd23 * sin(q23) + d5_qd234 * c234 + wz * en - wn * ez
    vz = a2_qd2 * c2 + a3_qd23 * c23 + d5_qd234 * s234 + wn * er - wr * en
    vn = wr * ez - wz * er - X * qd1
    return c1 * vr + s1 * vn, s1 * vr - c1 * vn, vz, c1 * wr + s1 * wn, s1 * wr - c1 * wn, wz


def joint_speeds(
    arm: Arm,
    q: Sequence[float],
    twist: Sequence[float],
    T_flange_tcp: Transform = IDENTITY,
    *,
    keeps_clear: bool = False,
) -> SixFloats | None:
    """Return the joint speeds, rad/s, that give the TCP the twist; None when the arm is singular.

    Args:
        arm: the arm.
        q: its joint angles, rad.
        twist: of the TCP, base frame, m/s and rad/s.
        T_flange_tcp: TCP offset.
        keeps_clear: None also where a Cartesian move ends, see `Singularity.blocked`; cheaper than asking both.
    """
    if arm.calibration is not None:
        from elitescript.kinematics.chain import solve_linear

        if keeps_clear and is_blocked(arm, q):
            return None
        solved = solve_linear(jacobian(arm, q, T_flange_tcp), twist)
        if solved is None:
            return None
        qd1, qd2, qd3, qd4, qd5, qd6 = solved
        return qd1, qd2, qd3, qd4, qd5, qd6
    q1, q2, q3, q4, q5, q6 = q
    vx, vy, vz, wx, wy, wz = twist
    q23 = q2 + q3
    q234 = q23 + q4
    c1 = cos(q1)
    s1 = sin(q1)
    c2 = cos(q2)
    s2 = sin(q2)
    c23 = cos(q23)
    s23 = sin(q23)
    s3 = sin(q3)
    c234 = cos(q234)
    s234 = sin(q234)
    c5 = cos(q5)
    s5 = sin(q5)
    a2 = arm.a2
    a3 = arm.a3
    d5 = arm.d5
    X = a2 * c2 + a3 * c23 + d5 * s234
    if (
        -EXACT_SINGULAR < s5 < EXACT_SINGULAR
        or -EXACT_SINGULAR < s3 < EXACT_SINGULAR
        or -EXACT_SINGULAR < X < EXACT_SINGULAR
    ):
        return None
    if keeps_clear and (
        -WRIST_GIVE_UP_SINE < s5 < WRIST_GIVE_UP_SINE
        or -ELBOW_GIVE_UP_SINE < s3 < ELBOW_GIVE_UP_SINE
        or -SHOULDER_GIVE_UP_M < X < SHOULDER_GIVE_UP_M
    ):
        return None
    er, ez, en = _wrist_to_tcp(arm.d6, c234, s234, c5, s5, q6, T_flange_tcp)
    # The twist of the wrist centre, in (r, z, n) components.
    wr = c1 * wx + s1 * wy
    wn = s1 * wx - c1 * wy
    vr = c1 * vx + s1 * vy - wz * en + wn * ez
    vn = s1 * vx - c1 * vy - wr * ez + wz * er
    vz = vz - wn * er + wr * en
    qd1 = -vn / X
    wz -= qd1
    qd5 = s234 * wr - c234 * wz
    qd6 = -(c234 * wr + s234 * wz) / s5
    qd234 = wn - c5 * qd6
    # What is left is the speed of joint 4, produced by upper arm and forearm.
    br = arm.d4 * qd1 - vr + d5 * c234 * qd234
    bz = vz - d5 * s234 * qd234
    qd2 = (bz * s23 - br * c23) / (a2 * s3)
    qd23 = (br * c2 - bz * s2) / (a3 * s3)
    return qd1, qd2, qd23 - qd2, qd234 - qd23, qd5, qd6


def _wrist_to_tcp(
    d6: float, c234: float, s234: float, c5: float, s5: float, q6: float, T_flange_tcp: Transform
) -> Vector3:
    """Return the vector from the wrist centre to the TCP in (r, z, n) components, m."""
    tx, ty, tz = T_flange_tcp[9:]
    tz += d6
    if tx == 0.0 and ty == 0.0:
        return -tz * c234 * s5, -tz * s234 * s5, tz * c5
    c6 = cos(q6)
    s6 = sin(q6)
    # Along the direction of x6 with joint 6 at zero, and across it.
    u = tx * c6 - ty * s6
    w = tx * s6 + ty * c6
    along = u * c5 - tz * s5
    return c234 * along - s234 * w, s234 * along + c234 * w, u * s5 + tz * c5
