"""Rigid transforms and the straight interpolation between them."""

from __future__ import annotations

import random
from math import hypot, pi

import pytest

from elitescript.kinematics.rotations import multiply, rotation_from_rpy, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import (
    IDENTITY,
    Transform,
    apply,
    compose,
    interpolate,
    inverse,
    pose_from_transform,
    position_of,
    rotation_of,
    transform_from_pose,
)

T_BASE_TABLE = transform_from_pose((0.4, -0.2, 0.1, 0.3, -0.2, 1.7))
T_TABLE_PART = transform_from_pose((0.05, 0.02, -0.01, -1.1, 0.8, 0.2))


def difference(A: Transform, B: Transform) -> float:
    return max(abs(a - b) for a, b in zip(A, B, strict=True))


def turned_angle(A: Transform, B: Transform) -> float:
    return hypot(*rotvec_from_rotation(multiply(transpose(rotation_of(A)), rotation_of(B))))


def test_compose_carries_points_through_both_frames() -> None:
    point = (0.3, -0.4, 0.5)
    assert apply(compose(T_BASE_TABLE, T_TABLE_PART), point) == pytest.approx(
        apply(T_BASE_TABLE, apply(T_TABLE_PART, point)), abs=1e-15
    )


def test_inverse_undoes_the_transform_from_both_sides() -> None:
    assert difference(compose(T_BASE_TABLE, inverse(T_BASE_TABLE)), IDENTITY) < 1e-15
    assert difference(compose(inverse(T_BASE_TABLE), T_BASE_TABLE), IDENTITY) < 1e-15


def test_pose_and_transform_are_the_same_thing() -> None:
    pose = (0.1, -0.2, 0.3, 0.4, -0.5, 0.6)
    T = transform_from_pose(pose)
    assert rotation_of(T) == rotation_from_rpy(0.4, -0.5, 0.6)
    assert position_of(T) == (0.1, -0.2, 0.3)
    assert pose_from_transform(T) == pytest.approx(pose, abs=1e-15)


@pytest.mark.parametrize("pose", [[0.0] * 5, [0.0] * 7])
def test_a_pose_of_the_wrong_length_is_refused(pose: list[float]) -> None:
    with pytest.raises(ValueError, match="values to unpack"):
        transform_from_pose(pose)


def test_interpolation_meets_both_ends() -> None:
    assert difference(interpolate(T_BASE_TABLE, T_TABLE_PART, 0.0), T_BASE_TABLE) < 1e-15
    assert difference(interpolate(T_BASE_TABLE, T_TABLE_PART, 1.0), T_TABLE_PART) < 1e-15


@pytest.mark.parametrize("s", [-0.4, 0.25, 0.5, 0.9, 1.3])
def test_interpolation_goes_straight_and_turns_in_proportion(s: float) -> None:
    T = interpolate(T_BASE_TABLE, T_TABLE_PART, s)
    start, end = position_of(T_BASE_TABLE), position_of(T_TABLE_PART)
    assert position_of(T) == pytest.approx([a + s * (b - a) for a, b in zip(start, end, strict=True)], abs=1e-15)
    assert turned_angle(T_BASE_TABLE, T) == pytest.approx(abs(s) * turned_angle(T_BASE_TABLE, T_TABLE_PART), abs=1e-14)


def test_interpolation_takes_the_smaller_angle() -> None:
    T_0 = transform_from_pose((0, 0, 0, 0, 0, 3.0))
    T_1 = transform_from_pose((0, 0, 0, 0, 0, -3.0))
    assert abs(pose_from_transform(interpolate(T_0, T_1, 0.5))[5]) == pytest.approx(pi, abs=1e-14)


def test_interpolation_in_two_steps_equals_one() -> None:
    rng = random.Random(5)
    for _ in range(100):
        T_0, T_1 = (transform_from_pose([rng.uniform(-1.5, 1.5) for _ in range(6)]) for _ in range(2))
        half = interpolate(T_0, T_1, 0.5)
        assert difference(interpolate(T_0, half, 0.6), interpolate(T_0, T_1, 0.3)) < 1e-13
