"""Time laws against their closed forms."""

from __future__ import annotations

import random
from math import sqrt

import pytest

from elitescript.errors import InternalError
from elitescript.motion.timing.profile import (
    RAMP_SHARE,
    Law,
    TimeLaw,
    trapezoid,
    trapezoid_lasting,
    trapezoid_of,
    trapezoid_of_duration,
)


def random_laws(count: int, seed: int) -> list[tuple[float, float, float]]:
    rng = random.Random(seed)
    return [(10 ** rng.uniform(-6, 2), 10 ** rng.uniform(-3, 1), 10 ** rng.uniform(-2, 2)) for _ in range(count)]


def test_long_move_lasts_length_by_speed_plus_speed_by_acceleration() -> None:
    profile = trapezoid(1.0, 0.25, 1.25)
    assert profile.duration_s == pytest.approx(1.0 / 0.25 + 0.25 / 1.25, rel=1e-15)
    assert profile.peak_speed == 0.25
    assert profile.at(2.0) == pytest.approx((0.5 * 0.25 * 0.2 + 0.25 * 1.8, 0.25), rel=1e-14)


def test_short_move_lasts_twice_the_root_of_length_by_acceleration() -> None:
    profile = trapezoid(0.01, 5.0, 1.0)
    assert profile.duration_s == 2.0 * sqrt(0.01)
    assert profile.peak_speed == pytest.approx(0.1)
    assert profile.at(0.1) == pytest.approx((0.005, 0.1))


def test_move_that_just_reaches_the_speed_obeys_both_laws() -> None:
    length, v, a = 0.5, 1.0, 2.0
    assert trapezoid(length, v, a).duration_s == pytest.approx(length / v + v / a)
    assert trapezoid(length, v, a).duration_s == pytest.approx(2.0 * sqrt(length / a))


@pytest.mark.parametrize(("length", "v", "a"), random_laws(200, 1))
def test_trapezoid_keeps_speed_and_acceleration_and_ends_exactly(length: float, v: float, a: float) -> None:
    profile = trapezoid(length, v, a)
    check_motion(profile, length, v, a)
    law = length / v + v / a if length >= v * v / a else 2.0 * sqrt(length / a)
    assert profile.duration_s == pytest.approx(law, rel=1e-12)


@pytest.mark.parametrize(("length", "v", "a"), random_laws(200, 2))
def test_prescribed_duration_is_kept_exactly_or_impossible(length: float, v: float, a: float) -> None:
    fastest = trapezoid(length, v, a).duration_s
    for factor in (1.0 + 1e-9, 1.01, 1.2, 3.0, 50.0):
        profile = trapezoid_lasting(length, fastest * factor, v, a)
        assert profile is not None
        assert profile.duration_s == fastest * factor
        check_motion(profile, length, v, a)
    for factor in (1.0 - 1e-9, 0.9, 0.1, 1e-6):
        assert trapezoid_lasting(length, fastest * factor, v, a) is None


def check_motion(profile: TimeLaw, length: float, v: float, a: float) -> None:
    assert profile.at(0.0) == (0.0, 0.0)
    assert profile.at(profile.duration_s) == (length, 0.0)
    steps = 60
    dt = profile.duration_s / steps
    before = (0.0, 0.0)
    for step in range(1, steps + 1):
        position, speed = profile.at(step * dt)
        assert before[0] <= position <= length
        assert 0.0 <= speed <= v * (1.0 + 1e-12)
        assert abs(speed - before[1]) <= a * dt * (1.0 + 1e-9)
        # The way between lies between what the two speeds and the acceleration allow.
        mean = 0.5 * (speed + before[1])
        assert position - before[0] == pytest.approx(mean * dt, abs=0.125 * 2.0 * a * dt * dt + 1e-12 * length)
        assert profile.speed_at_position(position) == pytest.approx(speed, abs=1e-6 * v + 1e-7 * sqrt(a * length))
        before = position, speed


def test_ramps_of_a_prescribed_duration_take_a_third_each() -> None:
    profile = trapezoid_lasting(0.3, 2.0, 10.0, 100.0)
    assert profile is not None
    v = 1.5 * 0.3 / 2.0
    assert profile.peak_speed == pytest.approx(v)
    assert profile.acceleration(0.0) == pytest.approx(v / (2.0 * RAMP_SHARE))
    assert profile.acceleration(1.0) == 0.0
    assert profile.acceleration(1.5) == pytest.approx(-v / (2.0 * RAMP_SHARE))


def test_ramps_get_shorter_where_the_speed_limit_asks_for_it() -> None:
    profile = trapezoid_lasting(0.3, 2.0, 0.2, 100.0)
    assert profile is not None
    assert profile.peak_speed == pytest.approx(0.2)
    assert profile.acceleration(0.0) == pytest.approx(0.2 / 0.5)


def test_ramps_get_longer_where_the_acceleration_limit_asks_for_it() -> None:
    profile = trapezoid_lasting(0.3, 2.0, 10.0, 0.31)
    assert profile is not None
    assert profile.acceleration(0.0) == pytest.approx(0.31)


def test_profile_rests_before_and_after() -> None:
    profile = trapezoid(1.0, 1.0, 1.0)
    assert profile.at(-1.0) == (0.0, 0.0)
    assert profile.at(99.0) == (1.0, 0.0)
    assert profile.acceleration(-1.0) == profile.acceleration(99.0) == 0.0
    assert profile.speed_at_position(-0.1) == profile.speed_at_position(1.1) == 0.0


def test_a_path_without_length_rests_for_as_long_as_it_is_told():
    assert trapezoid(0.0, 1.0, 1.0).duration_s == 0.0
    profile = trapezoid_lasting(0.0, 5.0, 1.0, 1.0)
    assert profile.duration_s == 5.0
    assert profile.at(0.0) == profile.at(3.0) == (0.0, 0.0)


def test_stretching_keeps_the_way_and_lowers_speed_and_acceleration() -> None:
    profile = trapezoid(1.0, 0.5, 2.0)
    slow = profile.stretched(2.0 * profile.duration_s)
    assert slow.duration_s == 2.0 * profile.duration_s
    for step in range(21):
        t_s = profile.duration_s * step / 20
        position, speed = profile.at(t_s)
        assert slow.at(2.0 * t_s) == pytest.approx((position, 0.5 * speed), abs=1e-15)
        assert slow.acceleration(2.0 * t_s) == pytest.approx(0.25 * profile.acceleration(t_s))


def test_profile_is_never_stretched_to_a_shorter_time() -> None:
    with pytest.raises(InternalError):
        trapezoid(1.0, 0.5, 2.0).stretched(0.1)


def random_entries(count: int, seed: int) -> list[tuple[float, Law, float, float]]:
    """Length, law, start position and a speed from which the rest is enough to stop."""
    rng = random.Random(seed)
    entries = []
    for length, v, a in random_laws(count, seed):
        law = Law(v, a, a * rng.uniform(0.3, 1.0))
        start = length * rng.choice((0.0, rng.uniform(0.0, 0.9)))
        fastest = sqrt(2.0 * law.brake * (length - start))
        entries.append((length, law, start, rng.choice((0.0, 1.0, rng.random())) * min(fastest, 1.5 * v)))
    return entries


@pytest.mark.parametrize(("length", "law", "start", "v_start"), random_entries(200, 3))
def test_a_profile_from_a_position_and_a_speed_keeps_its_law_and_ends_exactly(
    length: float, law: Law, start: float, v_start: float
) -> None:
    profile = trapezoid_of(length, law, start, v_start)
    position, speed = profile.at(0.0)
    assert position == start
    assert speed == pytest.approx(v_start, abs=1e-9 * law.v)
    assert profile.at(profile.duration_s) == (length, 0.0)
    dt = profile.duration_s / 60
    for step in range(1, 61):
        next_position, next_speed = profile.at(step * dt)
        assert next_speed <= max(law.v, v_start) * (1.0 + 1e-9)
        change = next_speed - speed
        assert -law.brake * dt * (1.0 + 1e-6) - 1e-9 * law.v <= change <= law.a * dt * (1.0 + 1e-6) + 1e-9 * law.v
        assert profile.time_at(next_position) <= step * dt * (1.0 + 1e-9) + 1e-12
        assert profile.at(profile.time_at(next_position))[0] == pytest.approx(next_position, abs=1e-9 * length)
        position, speed = next_position, next_speed


@pytest.mark.parametrize(("length", "law", "start", "v_start"), random_entries(100, 4))
def test_a_duration_from_a_position_and_a_speed_is_kept_or_impossible(
    length: float, law: Law, start: float, v_start: float
) -> None:
    quickest = trapezoid_of(length, law, start, v_start).duration_s
    for factor in (1.0 + 1e-6, 1.3, 10.0):
        profile = trapezoid_of_duration(length, law, quickest * factor, start, v_start)
        if profile is None:
            # All of the way is braking.
            assert 0.5 * v_start**2 / law.brake >= (length - start) * 0.98
            continue
        assert profile.duration_s == pytest.approx(quickest * factor, rel=1e-6)
    if quickest > 0.0:
        assert trapezoid_of_duration(length, law, 0.99 * quickest, start, v_start) is None


def test_what_cannot_stop_is_an_error() -> None:
    with pytest.raises(InternalError):
        trapezoid_of(1.0, Law(2.0, 1.0, 1.0), 0.9, 1.0)


def test_the_last_braking_begins_where_nothing_else_follows() -> None:
    assert trapezoid(1.0, 0.5, 1.0).last_brake_s == pytest.approx(2.0)
    assert trapezoid_of(0.125, Law(1.0, 1.0, 1.0), 0.0, 0.5).last_brake_s == 0.0


def test_one_motion_after_another() -> None:
    first, second = trapezoid(1.0, 0.25, 1.25), trapezoid(0.1, 3.0, 2.0)
    both = first.followed_by(second)
    assert both.length == 1.1
    assert both.duration_s == first.duration_s + second.duration_s
    for k in range(50):
        t_s = k * 0.1
        (s_1, v_1), (s_2, v_2) = first.at(t_s), second.at(t_s - first.duration_s)
        assert both.at(t_s) == pytest.approx((s_1 + s_2, v_1 + v_2), abs=1e-12)


def test_many_times_give_what_one_time_gives() -> None:
    rng = random.Random(5)
    profiles = [trapezoid(*law) for law in random_laws(100, 8)]
    profiles += [trapezoid(0.0, 1.0, 1.0), trapezoid(0.4, 0.25, 1.25).followed_by(trapezoid(0.01, 5.0, 1.0))]
    profiles += [trapezoid_of(0.5, Law(0.3, 1.0, 0.7), start=0.1, v_start=0.2)]
    for profile in profiles:
        corners = [profile.time_at(position) for position in profile.corners]
        times = [-1.0, 0.0, *corners, profile.duration_s, profile.duration_s + 1.0]
        times += [rng.uniform(-0.1, 1.1) * profile.duration_s for _ in range(50)]
        for order in (sorted(times), times):
            assert profile.at_times(order) == [profile.at(t_s) for t_s in order]
