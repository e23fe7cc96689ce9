"""Limits of an arm: sense of the numbers, joints outside their range."""

from __future__ import annotations

from math import inf, nan, nextafter, pi
from random import Random

import pytest

from elitescript.errors import UsageError
from elitescript.motion.limits import joint_outside, joint_range_error, unwrapped
from tests.motion.moves import FULL_TURN, LIMITS, limits_of, six


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"q_min": (0.0, 1.0, 0.0, 0.0, 0.0, 0.0), "q_max": (1.0,) * 6}, "joint shoulder is empty"),
        ({"qd_max": (1.0, 1.0, 0.0, 1.0, 1.0, 1.0)}, "qd_max of joint elbow is 0.0"),
        ({"qdd_max": (1.0, 1.0, 1.0, 1.0, 1.0, nan)}, "qdd_max of joint wrist3 is nan"),
        ({"tool_speed_max": -1.0}, "tool_speed_max is -1.0"),
        ({"tool_acceleration_max": inf}, "tool_acceleration_max is inf"),
        ({"equivalent_radius_m": 0.0}, "equivalent_radius_m is 0.0"),
    ],
)
def test_senseless_limits_are_refused_by_name(change: dict[str, object], word: str) -> None:
    with pytest.raises(UsageError, match=word):
        limits_of("CS66", **change)


def test_tool_rotation_is_limited_by_the_tool_speed_at_the_equivalent_radius() -> None:
    limits = limits_of("CS66", tool_speed_max=2.0, tool_acceleration_max=6.0, equivalent_radius_m=0.5)
    assert limits.tool_turn_speed_max == 4.0
    assert limits.tool_turn_acceleration_max == 12.0


def test_first_joint_outside_its_range_is_found() -> None:
    inside = (FULL_TURN, -FULL_TURN, 0.0, 0.0, 0.0, 0.0)
    assert joint_outside(LIMITS, inside) is None
    assert joint_outside(LIMITS, (0.0, 0.0, 6.3, 0.0, -7.0, 0.0)) == 2
    assert joint_outside(LIMITS, (0.0, 0.0, 0.0, 0.0, 0.0, nan)) == 5


def test_rounding_at_the_border_of_the_range_is_no_mistake() -> None:
    assert joint_outside(LIMITS, (FULL_TURN + 1e-12, 0.0, 0.0, 0.0, 0.0, 0.0)) is None
    assert joint_outside(LIMITS, (FULL_TURN + 1e-8, 0.0, 0.0, 0.0, 0.0, 0.0)) == 0


def test_range_error_names_joint_value_limit_and_unit() -> None:
    error = joint_range_error(LIMITS, 3, 7.0, "at the target")
    assert error.code == "R110"
    assert error.value == 7.0
    assert error.unit == "rad"
    assert error.limit == "[-6.28319, 6.28319]"
    assert str(error).startswith("at the target, joint wrist1 would be at 7.0000 rad (401.1 deg)")


def test_joints_are_put_on_the_nearest_turn() -> None:
    near = (0.1, 7.0, -6.0, 3.0, 0.0, -3.0)
    found = unwrapped((0.2, 0.7, 0.1, -3.1, 6.2, 3.1), near)
    expected = (0.2, 0.7 + FULL_TURN, 0.1 - FULL_TURN, -3.1 + FULL_TURN, 6.2 - FULL_TURN, 3.1 - FULL_TURN)
    assert found == pytest.approx(expected, abs=1e-15)


def test_joints_are_unwrapped_to_the_last_bit_as_by_the_formula() -> None:
    chance = Random(3)
    angles = (0.0, -0.0, pi, -pi, 0.5 * pi, 3.0, nextafter(pi, 0.0), nextafter(pi, 4.0))
    for number in range(2000):
        q, near = (six(chance.choice((*angles, chance.gauss(0.0, 4.0))) for _ in range(6)) for _ in range(2))
        if number % 2:
            near = six(x + chance.gauss(0.0, 0.3) for x in q)
        wanted = [x + FULL_TURN * round((other - x) / FULL_TURN) for x, other in zip(q, near, strict=True)]
        assert [x.hex() for x in unwrapped(q, near)] == [x.hex() for x in wanted]
