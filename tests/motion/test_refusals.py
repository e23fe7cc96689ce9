"""What refusals say: place, number, limit and unit."""

from __future__ import annotations

from math import pi

import pytest

from elitescript.kinematics.inverse import branch_of
from elitescript.kinematics.jacobian import Singularity
from elitescript.kinematics.transforms import compose, transform_from_pose
from elitescript.motion.paths.cartesian import LinePath, line
from elitescript.motion.refusals import jump, leaves_reach, out_of_range, out_of_reach, singular
from tests.motion.moves import ARM, LIMITS, Q_WORK, T_FLANGE_TCP, shifted, six

T_BASE_FLANGE = ARM.forward(Q_WORK)


def line_by(*offset: float) -> LinePath:
    T_end = transform_from_pose(shifted(Q_WORK, *offset))
    return line(T_BASE_FLANGE, compose(T_BASE_FLANGE, T_FLANGE_TCP), T_end, 0.25)


@pytest.mark.parametrize(
    ("distance", "name", "value", "unit"),
    [
        (Singularity(0.0004, 1.0, 1.0), "wrist singularity", 0.0004, None),
        (Singularity(1.0, 0.0005, 1.0), "elbow singularity", 0.0005, None),
        (Singularity(1.0, 1.0, 0.0006), "shoulder singularity", 0.0006, "m"),
    ],
)
def test_singularity_is_named_with_its_distance(
    distance: Singularity, name: str, value: float, unit: str | None
) -> None:
    error = singular(line_by(0.0, 0.2), 0.05, distance)
    assert error.code == "R112"
    assert (error.value, error.limit, error.unit) == (value, ">= 0.001", unit)
    assert f"meets the {name} 0.0500 m from the start of the line of 0.2000 m" in str(error)
    assert f"{value:.6f}" in str(error)


def test_singularity_of_a_calibrated_arm_needs_no_nominal_distance() -> None:
    error = singular(line_by(0.0, 0.2), 0.05, Singularity(0.5, 0.5, 0.5))
    assert error.code == "R112"
    assert "meets a singularity 0.0500 m from the start" in str(error)


def test_jump_names_the_joint_that_turns_most() -> None:
    error = jump(line_by(0.0, 0.2), 0.05, Q_WORK, six((*Q_WORK[:3], Q_WORK[3] - pi, Q_WORK[4], Q_WORK[5] + 1.0)))
    assert error.code == "R112"
    assert error.value == pytest.approx(-pi)
    assert "joint wrist1 would jump by -3.1416 rad (-180.0 deg)" in str(error)


def test_joint_out_of_range_is_located_between_the_points() -> None:
    path = line_by(0.0, 0.2)
    q_a, q_b = six((6.2, *Q_WORK[1:])), six((6.4, *Q_WORK[1:]))
    error = out_of_range(ARM, LIMITS, path, branch_of(ARM, Q_WORK), 0, 0.05, q_a, 0.1, q_b)
    assert error.code == "R110"
    assert error.value == 6.4
    assert str(error).startswith("0.1000 m from the start of the line of 0.2000 m, joint base would be at 6.4000 rad")
    assert "which it would leave 0.0" in str(error)


def test_border_of_the_reach_is_found_between_the_points() -> None:
    path = line_by(0.0, 1.0)
    error = leaves_reach(ARM, path, branch_of(ARM, Q_WORK), 0.0, 1.0)
    assert error.code == "R111"
    assert error.unit == "m"
    T = path.flange(error.value)
    assert ARM.forward(Q_WORK)[10] < T[10] < ARM.forward(Q_WORK)[10] + 1.0
    assert str(error).startswith(
        f"out of reach {error.value:.4f} m from the start of the line of 1.0000 m: at 1.0000 m"
    )


def test_unreachable_point_carries_its_place_and_reason() -> None:
    error = out_of_reach(line_by(0.0, 0.2), 0.1, "because")
    assert (error.code, error.value, error.unit) == ("R111", 0.1, "m")
    assert str(error) == "out of reach 0.1000 m from the start of the line of 0.2000 m: because"
    assert error.hint
