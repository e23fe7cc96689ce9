"""The arm behind a stream of joint targets, period by period."""

from itertools import pairwise
from random import Random

import pytest

from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.servo import begun, followed, held
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
