"""The arm behind a stream of joint targets, period by period."""

from itertools import pairwise
from math import exp, sqrt
from random import Random

import pytest

from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.servo import (
    APPROACH_SHARE,
    EASE_TICKS,
    GAIN_PER_S,
    ServoState,
    begun,
    followed,
    held,
    may_meet_obstacle,
)
from elitescript.motion.streaming.speed import RANGE_ROUNDING_RAD, Obstacle
from tests.motion.moves import limits_of

MODEL = load_model("CS66")
LIMITS = limits_of("CS66")
HOME = MODEL.home
ZEROS = (0.0,) * 6


def shifted(way):
    return (HOME[0] + way, *HOME[1:])


@pytest.mark.parametrize(("window", "gain"), [(8, 2000.0), (25, 300.0), (50, 100.0)])
def test_the_arm_is_late_by_half_the_window_and_by_the_gain(window, gain):
    state = begun(Setpoint(HOME, ZEROS))
    speed = 0.3
    for tick in range(1, 600):
        state = followed(state._replace(left=1), shifted(speed * tick * PERIOD_S), window, gain, LIMITS)
    lag_s = (speed * 599 * PERIOD_S - (state.q[0] - HOME[0])) / speed
    assert lag_s == pytest.approx(window * PERIOD_S / 2 + 10.0 / gain, abs=PERIOD_S)
    assert state.qd[0] == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("gain", [100.0, 300.0, 2000.0])
def test_when_targets_stop_the_arm_comes_to_rest_at_the_last_one_without_overshoot(gain):
    target = shifted(1.0)
    state = begun(Setpoint(HOME, ZEROS))._replace(left=1)
    for _ in range(1500):
        state = followed(state, target, 25, gain, LIMITS)
        assert state.q[0] <= target[0] + 1e-9
    assert state.is_at(target)


@pytest.mark.parametrize("seed", range(20))
def test_limits_hold_for_any_targets_from_any_state(seed):
    chance = Random(seed)
    qd = tuple(chance.uniform(-1, 1) * top for top in LIMITS.qd_max)
    state = begun(Setpoint(HOME, qd))
    window, gain = chance.randrange(8, 51), chance.uniform(100, 2000)
    for tick in range(600):
        if tick % 7 == 0:
            target = tuple(chance.uniform(-3, 3) for _ in range(6))
            state = state._replace(left=chance.randrange(1, 8))
        is_paused = 300 <= tick < 450
        after = held(state, 8.0, LIMITS) if is_paused else followed(state, target, window, gain, LIMITS)
        for joint in range(6):
            assert abs(after.qd[joint]) <= LIMITS.qd_max[joint] * (1 + 1e-12)
            assert abs(after.qd[joint] - state.qd[joint]) <= LIMITS.qdd_max[joint] * PERIOD_S * (1 + 1e-9)
        state = after
        if tick == 449:
            assert state.qd == ZEROS


def test_after_a_pause_the_arm_gathers_speed_gently():
    state = begun(Setpoint(HOME, ZEROS))
    way = 0.0
    for _ in range(100):
        way += 0.5 * PERIOD_S
        state = followed(state._replace(left=1), shifted(way), 25, 2000.0, LIMITS)
    while any(state.qd):
        state = held(state, 8.0, LIMITS)
    speeds = [0.0]
    for _ in range(200):
        way += 0.5 * PERIOD_S
        state = followed(state._replace(left=1), shifted(way), 25, 2000.0, LIMITS)
        speeds.append(state.qd[0])
    accelerations = [(b - a) / PERIOD_S for a, b in pairwise(speeds)]
    assert accelerations[0] <= 1.0
    assert max(accelerations) <= 15.0
    assert max(abs(b - a) for a, b in pairwise(accelerations)) <= 5.0
    assert speeds[-1] == pytest.approx(0.5, rel=1e-3)


def test_half_of_the_acceleration_is_used_in_the_period_in_which_a_stream_takes_over():
    state = begun(Setpoint(HOME, (1.0, *ZEROS[1:])))
    first = followed(state, HOME, 25, 300.0, LIMITS)
    second = followed(first, HOME, 25, 300.0, LIMITS)
    assert (1.0 - first.qd[0]) / PERIOD_S == pytest.approx(20.0)
    assert (first.qd[0] - second.qd[0]) / PERIOD_S == pytest.approx(40.0)


def followed_by_the_book(state, q_target, window, gain):
    """The law of `followed`, written as it reads; None where a joint cannot stop inside its range."""
    newest = state.stream[-1]
    if state.left:
        newest = tuple(place + (end - place) / state.left for place, end in zip(newest, q_target, strict=True))
        newest = newest if state.left > 1 else q_target
    before = state.stream
    if len(before) < window:
        before = (before[0],) * (window - len(before)) + before
    stream = (*before[len(before) - window + 1 :], newest)
    rate = (1.0 - exp(-gain / GAIN_PER_S * PERIOD_S)) / PERIOD_S
    share = 0.5 if state.is_taken_over else 1.0
    ease = max(0.0, state.ease - 1.0)
    speeds, is_limited = [], False
    for joint in range(6):
        column = [place[joint] for place in stream]
        mean = column[0] + sum([place - column[0] for place in column]) / window
        way, deceleration = mean - state.q[joint], APPROACH_SHARE * LIMITS.qdd_max[joint]
        near = deceleration / (rate * rate)
        wanted = rate * way
        if abs(way) > near:
            wanted = sqrt(2.0 * deceleration * (abs(way) - 0.5 * near)) * (1.0 if way > 0.0 else -1.0)
        top = LIMITS.qd_max[joint]
        if abs(wanted) > top:
            wanted, is_limited = (top if wanted > 0.0 else -top), True
        wanted *= 1.0 - ease / EASE_TICKS
        w, change = state.qd[joint], share * LIMITS.qdd_max[joint] * PERIOD_S
        speeds.append(min(max(wanted, w - change), w + change))
    q = tuple(angle + w * PERIOD_S for angle, w in zip(state.q, speeds, strict=True))
    for angle, w, low, high in zip(q, speeds, LIMITS.q_min, LIMITS.q_max, strict=True):
        stop = angle + w * abs(w) / (2.0 * min(LIMITS.qdd_max))
        if (w > 0.0 and stop > high + RANGE_ROUNDING_RAD) or (w < 0.0 and stop < low - RANGE_ROUNDING_RAD):
            return None
    return ServoState(q, tuple(speeds), stream, max(0, state.left - 1), is_limited, ease)


def any_target(chance, near):
    """Six angles: where the stream is, a jump, the end of a range, or a zero of either sign."""
    return tuple(
        chance.choice((angle, angle, angle + chance.uniform(-0.02, 0.02), chance.uniform(low, high), high, 0.0, -0.0))
        for angle, low, high in zip(near, LIMITS.q_min, LIMITS.q_max, strict=True)
    )


@pytest.mark.parametrize("seed", range(20))
def test_every_bit_is_that_of_the_law(seed):
    chance = Random(seed)
    q = tuple(chance.choice((angle, 0.0, -0.0)) for angle in HOME)
    state = begun(Setpoint(q, tuple(chance.uniform(-1, 1) * top * chance.randrange(2) for top in LIMITS.qd_max)))
    window, gain = chance.randrange(1, 51), chance.uniform(100, 2000)
    target = q
    for tick in range(400):
        if tick % 7 == 0:
            target = any_target(chance, target)
            state = state._replace(left=chance.randrange(1, 8))
        expected = followed_by_the_book(state, target, window, gain)
        after = held(state, 8.0, LIMITS) if 200 <= tick < 230 else followed(state, target, window, gain, LIMITS)
        if not 200 <= tick < 230:
            assert isinstance(after, Obstacle) == (expected is None)
            assert expected is None or repr(after) == repr(expected)
        if isinstance(after, Obstacle):
            break
        state = after


def test_where_no_joint_can_come_to_its_range_none_does():
    """From states at the ends of the ranges, with any speeds: there both answers are frequent."""
    chance = Random(3)
    met = {True: 0, False: 0}
    certain = 0
    for _ in range(6000):
        q = tuple(
            chance.choice((low, high)) + chance.uniform(-1, 1) * chance.choice((1e-12, 1e-3, 0.1, 0.3))
            for low, high in zip(LIMITS.q_min, LIMITS.q_max, strict=True)
        )
        q = tuple(min(max(a, low), high) for a, low, high in zip(q, LIMITS.q_min, LIMITS.q_max, strict=True))
        if chance.random() < 0.6:
            keep = chance.randrange(6)
            q = tuple(angle if joint == keep else HOME[joint] for joint, angle in enumerate(q))
        qd = tuple(chance.choice((0.0, -0.0, chance.uniform(-1, 1), -1.0, 1.0)) * top for top in LIMITS.qd_max)
        state = begun(Setpoint(q, qd))._replace(left=1, is_taken_over=False)
        is_possible = may_meet_obstacle(state, LIMITS)
        ends = (
            followed(state, any_target(chance, q), 8, 2000.0, LIMITS),
            held(state, chance.uniform(1.0, 40.0), LIMITS),
        )
        is_met = any(isinstance(end, Obstacle) for end in ends)
        met[is_met] += 1
        certain += not is_possible
        assert is_possible or not is_met
    assert min(met.values()) > 300
    assert certain > 300
