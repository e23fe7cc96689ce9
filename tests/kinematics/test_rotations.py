"""Rotation matrices, roll-pitch-yaw and rotation vectors."""

from __future__ import annotations

import random
from math import cos, hypot, nextafter, pi, sin, sqrt

import pytest

from elitescript.kinematics.rotations import (
    IDENTITY_ROTATION,
    Rotation,
    multiply,
    rotate,
    rotation_from_rotvec,
    rotation_from_rpy,
    rotvec_from_rotation,
    rpy_from_rotation,
    transpose,
)


def difference(A: Rotation, B: Rotation) -> float:
    return max(abs(a - b) for a, b in zip(A, B, strict=True))


def random_axis(rng: random.Random) -> tuple[float, float, float]:
    x, y, z = rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)
    length = hypot(x, y, z)
    return x / length, y / length, z / length


def test_rpy_turns_about_the_fixed_axes_x_then_y_then_z() -> None:
    rx, ry, rz = 0.3, -0.7, 1.9
    about_x = (1.0, 0.0, 0.0, 0.0, cos(rx), -sin(rx), 0.0, sin(rx), cos(rx))
    about_y = (cos(ry), 0.0, sin(ry), 0.0, 1.0, 0.0, -sin(ry), 0.0, cos(ry))
    about_z = (cos(rz), -sin(rz), 0.0, sin(rz), cos(rz), 0.0, 0.0, 0.0, 1.0)
    assert difference(rotation_from_rpy(rx, ry, rz), multiply(about_z, multiply(about_y, about_x))) < 1e-15


def test_rpy_comes_back_from_the_matrix() -> None:
    rng = random.Random(1)
    for _ in range(500):
        rpy = rng.uniform(-pi, pi), rng.uniform(-pi / 2, pi / 2), rng.uniform(-pi, pi)
        assert rpy_from_rotation(rotation_from_rpy(*rpy)) == pytest.approx(rpy, abs=1e-9)


def test_angles_beyond_their_canonical_range_come_back_as_the_same_orientation() -> None:
    rng = random.Random(2)
    for _ in range(500):
        R = rotation_from_rpy(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9))
        rx, ry, rz = rpy_from_rotation(R)
        assert -pi <= rx <= pi
        assert -pi / 2 <= ry <= pi / 2
        assert -pi <= rz <= pi
        assert difference(rotation_from_rpy(rx, ry, rz), R) < 2e-15


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2])
def test_at_gimbal_lock_roll_is_zero_and_yaw_carries_the_turn(pitch: float) -> None:
    R = rotation_from_rpy(0.4, pitch, 1.1)
    rx, ry, rz = rpy_from_rotation(R)
    assert rx == 0.0
    assert ry == pytest.approx(pitch, abs=1e-15)
    assert rz == pytest.approx(1.1 - 0.4 if pitch > 0 else 1.1 + 0.4, abs=1e-12)
    assert difference(rotation_from_rpy(rx, ry, rz), R) < 1e-12


@pytest.mark.parametrize(
    "angle", [1e-300, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 2.0, 2.2, 3.0, pi - 1e-3, pi - 1e-6, pi - 1e-9]
)
def test_rotation_vector_keeps_its_digits_from_no_turn_to_half_a_turn(angle: float) -> None:
    rng = random.Random(3)
    for _ in range(50):
        axis = random_axis(rng)
        v = (angle * axis[0], angle * axis[1], angle * axis[2])
        back = rotvec_from_rotation(rotation_from_rotvec(v))
        # A matrix of doubles resolves absolute angles to some 1e-16.
        assert max(abs(a - b) for a, b in zip(v, back, strict=True)) < 2e-15


@pytest.mark.parametrize(
    "axis", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (-0.48, 0.64, 0.6)]
)
def test_exact_half_turn_has_length_pi_and_a_positive_largest_component(axis: tuple[float, float, float]) -> None:
    ux, uy, uz = axis
    R = (
        2 * ux * ux - 1, 2 * ux * uy, 2 * ux * uz,
        2 * ux * uy, 2 * uy * uy - 1, 2 * uy * uz,
        2 * ux * uz, 2 * uy * uz, 2 * uz * uz - 1,
    )  # fmt: skip
    v = rotvec_from_rotation(R)
    assert hypot(*v) == pytest.approx(pi, abs=1e-15)
    assert max(v, key=abs) > 0
    assert difference(rotation_from_rotvec(v), R) < 1e-15


def test_rotation_vector_beyond_half_a_turn_comes_back_the_short_way() -> None:
    v = rotvec_from_rotation(rotation_from_rotvec((0.0, 0.0, pi + 0.5)))
    assert v == pytest.approx((0.0, 0.0, 0.5 - pi), abs=1e-15)


def test_length_of_a_rotation_vector_never_exceeds_half_a_turn() -> None:
    rng = random.Random(4)
    for _ in range(300):
        v = rotvec_from_rotation(rotation_from_rpy(rng.uniform(-pi, pi), rng.uniform(-2, 2), rng.uniform(-pi, pi)))
        assert hypot(*v) <= nextafter(pi, 4.0)


def test_no_rotation_has_the_zero_vector() -> None:
    assert rotvec_from_rotation(IDENTITY_ROTATION) == (0.0, 0.0, 0.0)
    assert rotation_from_rotvec((0.0, 0.0, 0.0)) == IDENTITY_ROTATION


def test_quarter_turn_about_z_takes_x_to_y() -> None:
    R = rotation_from_rotvec((0.0, 0.0, pi / 2))
    assert rotate(R, (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0), abs=1e-15)


def test_transpose_is_the_inverse() -> None:
    R = rotation_from_rpy(0.1, 0.2, 0.3)
    assert difference(multiply(R, transpose(R)), IDENTITY_ROTATION) < 1e-15


def test_product_acts_as_one_rotation_after_the_other() -> None:
    A, B, v = rotation_from_rpy(1.0, 0.2, -2.0), rotation_from_rpy(-0.4, 1.1, 0.7), (0.3, -1.0, sqrt(2.0))
    assert rotate(multiply(A, B), v) == pytest.approx(rotate(A, rotate(B, v)), abs=1e-15)
