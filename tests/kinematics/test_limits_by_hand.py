"""Tolerances of the kinematics against numbers written by hand; all are assumed, from the digits that poses have."""

from __future__ import annotations

from math import pi

from elitescript.kinematics import jacobian, limits
from elitescript.kinematics.arm import MAX_CALIBRATION_OFFSET
from elitescript.kinematics.inverse import BRANCHES
from elitescript.motion import limits as motion_limits


def test_tolerances() -> None:
    assert 2 * pi == limits.TURN
    assert limits.REACH_TOLERANCE_M == 1e-6
    assert limits.WRIST_SINGULAR_SINE == 1e-6
    assert limits.RANGE_TOLERANCE_RAD == motion_limits.RANGE_TOLERANCE_RAD == 1e-9
    assert jacobian.EXACT_SINGULAR == 1e-9
    assert MAX_CALIBRATION_OFFSET == 0.02
    assert BRANCHES == 8


def test_a_move_ends_a_thousandth_from_a_singularity() -> None:
    assert (jacobian.WRIST_GIVE_UP_SINE, jacobian.ELBOW_GIVE_UP_SINE, jacobian.SHOULDER_GIVE_UP_M) == (0.001,) * 3


def test_names_of_joints() -> None:
    assert motion_limits.JOINT_NAMES == ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")
