"""Joint speeds in closed form, at random states, and the rule that keeps joints inside their ranges."""

from math import inf
from random import Random

import pytest

from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import (
    accelerated,
    braked,
    braked_apart,
    obstacle_at,
    obstacle_time,
    within_speed_limits,
)
from tests.motion.moves import limits_of

LIMITS = limits_of("CS66")
ZEROS = (0.0,) * 6
DECELERATION = 8.0


def random_start(chance):
    q = tuple(chance.uniform(-6.2, 6.2) for _ in range(6))
    return Setpoint(q, tuple(chance.uniform(-1, 1) * top for top in LIMITS.qd_max))


def test_all_joints_reach_their_speeds_together_and_the_leading_one_has_the_acceleration():
    start = Setpoint(ZEROS, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))
    profile = accelerated(start, (-0.5, 0.2, 0.0, 0.0, 0.0, 0.1), 2.0, LIMITS)
    assert profile.duration_s == 0.5
    assert profile.at(0.25).qd == pytest.approx((0.0, 0.1, 0.0, 0.0, 0.0, 0.05))
    assert profile.at(9.0).qd == (-0.5, 0.2, 0.0, 0.0, 0.0, 0.1)
    assert profile.at(1.5).q == pytest.approx((-0.5, 0.25, 0.0, 0.0, 0.0, 0.125))


def test_an_acceleration_above_the_limits_is_lowered_to_them():
    profile = accelerated(Setpoint(ZEROS, ZEROS), (1.0,) + (0.0,) * 5, 1e6, LIMITS)
    assert profile.duration_s == pytest.approx(1.0 / LIMITS.qdd_max[0])


def test_speeds_above_the_limits_keep_their_proportion():
    qd = (2.0 * LIMITS.qd_max[0], 0.4, 0.0, 0.0, 0.0, -0.2)
    assert within_speed_limits(qd, LIMITS) == pytest.approx((LIMITS.qd_max[0], 0.2, 0.0, 0.0, 0.0, -0.1))
    assert within_speed_limits((0.1,) * 6, LIMITS) == (0.1,) * 6


@pytest.mark.parametrize("seed", range(40))
def test_position_is_the_integral_of_a_continuous_speed(seed):
    chance = Random(seed)
    start = random_start(chance)
    profile = accelerated(start, random_start(chance).qd, chance.uniform(0.5, 60.0), LIMITS)
    assert profile.at(0.0) == start
    before = start
    step_s = profile.duration_s / 37
    for k in range(1, 50):
        now = profile.at(k * step_s)
        for joint in range(6):
            assert abs(now.qd[joint] - before.qd[joint]) <= LIMITS.qdd_max[joint] * step_s * (1 + 1e-9)
            assert abs(now.qd[joint]) <= LIMITS.qd_max[joint] * (1 + 1e-12)
            mean = 0.5 * (now.qd[joint] + before.qd[joint])
            assert now.q[joint] - before.q[joint] == pytest.approx(mean * step_s, abs=LIMITS.qdd_max[joint] * step_s**2)
        before = now


@pytest.mark.parametrize("seed", range(60))
def test_who_brakes_when_told_stays_inside_the_range(seed):
    chance = Random(seed)
    profile = accelerated(random_start(chance), random_start(chance).qd, chance.uniform(0.5, 20.0), LIMITS)
    time_s, joint = obstacle_time(profile, DECELERATION, LIMITS)
    assert time_s < inf
    # Who begins where stopping is no more possible is told at once.
    for k in range(200 if time_s else 0):
        state = profile.at(time_s * k / 200)
        assert obstacle_at(*state, DECELERATION, LIMITS) is None
    state = profile.at(time_s)
    if time_s > 0.0:
        just_after = profile.at(time_s + 1e-6)
        assert obstacle_at(*just_after, DECELERATION, LIMITS) == joint
        braking = braked_apart(state, DECELERATION, LIMITS)
        for k in range(101):
            q = braking.at(braking.duration_s * k / 100).q
            for angle, low, high in zip(q, LIMITS.q_min, LIMITS.q_max, strict=True):
                assert low - 1e-9 <= angle <= high + 1e-9
        end = LIMITS.q_max[joint] if state.qd[joint] > 0.0 else LIMITS.q_min[joint]
        assert braking.at(braking.duration_s).q[joint] == pytest.approx(end, abs=1e-9)


def test_speeds_of_zero_meet_no_obstacle():
    assert obstacle_time(accelerated(Setpoint(ZEROS, ZEROS), ZEROS, 1.0, LIMITS), DECELERATION, LIMITS)[0] == inf


def test_braking_in_proportion_ends_when_asked_except_at_the_end_of_a_range():
    profile = braked(Setpoint((0.0, 6.28, 0.0, 0.0, 0.0, 0.0), (1.0, 0.1, 0.0, 0.0, 0.0, -0.5)), 0.5, LIMITS)
    room = LIMITS.q_max[1] - 6.28
    assert profile.ramps_s == pytest.approx((0.5, 2 * room / 0.1, 0.0, 0.0, 0.0, 0.5))
    assert profile.at(0.5).qd == ZEROS
    assert profile.at(0.5).q[1] == pytest.approx(LIMITS.q_max[1], abs=1e-12)
