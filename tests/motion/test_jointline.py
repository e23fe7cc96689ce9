"""The straight line in joint space."""

from __future__ import annotations

import pytest

from elitescript.kinematics.jacobian import tcp_twist
from elitescript.motion.paths.joint_line import JointLine
from tests.motion.moves import ARM, Q_WORK, T_FLANGE_TCP, six

Q_END = (0.8, -1.0, -1.6, -2.9, 1.4, 0.3)


def joint_line() -> JointLine:
    return JointLine(ARM, T_FLANGE_TCP, Q_WORK, Q_END)


def test_leading_joint_is_the_one_with_the_largest_displacement() -> None:
    path = joint_line()
    assert path.length == pytest.approx(1.4)
    assert path.slope == pytest.approx((0.5 / 1.4, 0.5 / 1.4, 0.0, -1.0, -0.1 / 1.4, 0.1 / 1.4))


def test_joints_stay_in_proportion_and_hit_both_ends_bit_for_bit() -> None:
    path = joint_line()
    assert path.q(0.0) == Q_WORK
    assert path.q(path.length) == Q_END
    half = six(0.5 * (a + b) for a, b in zip(Q_WORK, Q_END, strict=True))
    assert path.q(0.5 * path.length) == pytest.approx(half, abs=1e-15)
    assert path.q_and_slope(0.3) == (path.q(0.3), path.slope)


def test_line_without_length_stays_where_it_is() -> None:
    path = JointLine(ARM, T_FLANGE_TCP, Q_WORK, Q_WORK)
    assert path.length == 0.0
    assert path.q(0.0) == path.q(1.0) == Q_WORK


def test_tool_rates_are_those_of_the_tcp() -> None:
    path = joint_line()
    vx, vy, vz, wx, wy, wz = tcp_twist(ARM, path.q(0.4), path.slope, T_FLANGE_TCP)
    way, turn = path.tool_rates(0.4)
    assert way**2 == pytest.approx(vx * vx + vy * vy + vz * vz)
    assert turn**2 == pytest.approx(wx * wx + wy * wy + wz * wz)


def test_end_pose_is_that_of_the_tcp() -> None:
    assert joint_line().T_base_tcp_end == ARM.forward_tcp(Q_END, T_FLANGE_TCP)
