"""Wrapping of angles and full turns inside joint ranges."""

from __future__ import annotations

import random
from math import cos, inf, pi, sin

import pytest

from elitescript.kinematics.limits import (
    RANGE_TOLERANCE_RAD,
    TURN,
    nearest_turn,
    wrap_to_pi,
)


def test_wrapping_keeps_the_direction_and_lands_in_the_half_open_range() -> None:
    rng = random.Random(8)
    for _ in range(500):
        angle = rng.uniform(-30, 30)
        wrapped = wrap_to_pi(angle)
        assert -pi < wrapped <= pi
        assert (sin(wrapped), cos(wrapped)) == pytest.approx((sin(angle), cos(angle)), abs=1e-13)


@pytest.mark.parametrize(("angle", "wrapped"), [(pi, pi), (-pi, pi), (3 * pi, pi), (0.5, 0.5), (TURN, 0.0)])
def test_wrapping_at_the_edges(angle: float, wrapped: float) -> None:
    assert wrap_to_pi(angle) == pytest.approx(wrapped, abs=1e-15)
    assert wrap_to_pi(angle) > -pi


@pytest.mark.parametrize(
    ("angle", "near", "expected"),
    [
        (0.5, 0.4, 0.5),
        (-3.0, 3.0, -3.0 + TURN),
        (3.0, -3.0, 3.0 - TURN),
        (0.0, TURN, TURN),
        (0.1, 6.2, 0.1),
        (0.1, 7.0, 0.1),
        (-0.1, -7.0, -0.1),
        (3.0, 9.0, 3.0),
    ],
)
def test_nearest_turn_stays_inside_plus_minus_one_turn(angle: float, near: float, expected: float) -> None:
    assert nearest_turn(angle, near, -TURN, TURN) == pytest.approx(expected, abs=1e-15)


def test_nearest_turn_is_the_best_of_all_turns_within_the_range() -> None:
    rng = random.Random(9)
    for _ in range(1000):
        angle, near = rng.uniform(-pi, pi), rng.uniform(-20, 20)
        low = rng.uniform(-10, 5)
        high = low + rng.uniform(0, 15)
        turns = [angle + TURN * count for count in range(-4, 5)]
        inside = [turn for turn in turns if low <= turn <= high]
        found = nearest_turn(angle, near, low, high)
        if inside:
            assert found is not None
            assert abs(found - near) == pytest.approx(min(abs(turn - near) for turn in inside), abs=1e-12)
        else:
            assert found is None


def test_the_angle_itself_wins_halfway_between_two_turns() -> None:
    assert nearest_turn(pi, 0.0, -TURN, TURN) == pi
    assert nearest_turn(0.0, pi, -TURN, TURN) == 0.0


def test_rounding_at_the_border_of_the_range_is_put_on_the_border() -> None:
    assert nearest_turn(-1e-12, -6.0, -TURN, TURN) == -TURN
    assert nearest_turn(1e-12, 6.0, -TURN, TURN) == TURN
    assert nearest_turn(-2 * RANGE_TOLERANCE_RAD, -6.28, -TURN, TURN) == -2 * RANGE_TOLERANCE_RAD


def test_an_unlimited_joint_takes_the_nearest_turn() -> None:
    assert nearest_turn(0.3, 100.0, -inf, inf) == pytest.approx(0.3 + 16 * TURN)
