"""Speed percentage, pause and stop as a scale of time."""

from __future__ import annotations

import random
from itertools import pairwise
from math import inf, nan

import pytest

from elitescript.errors import UsageError
from elitescript.messages.motion import MoveJ
from elitescript.motion.planner import plan_movej, plan_movel
from elitescript.motion.segment import Segment
from elitescript.motion.timing.timescale import TimeScale, change_ramp, stop_ramp, stop_ramp_tool
from tests.invariants.cases import first_of
from tests.motion.moves import ARM, LIMITS, Q_NEAR_WRIST, Q_WORK, T_FLANGE_TCP, line_by

ROUNDING_S = 1e-12


def random_scales(seed: int, changes: int = 12) -> list[TimeScale]:
    """A scale and its successors, changed at random times, also in the middle of ramps."""
    rng = random.Random(seed)
    scale = TimeScale.start(rng.uniform(-5, 5), rng.choice([0.0, 1.0, rng.random()]))
    scales = [scale]
    t_s = scale.t_start_s
    for _ in range(changes):
        t_s += rng.choice([0.0, 0.05, rng.uniform(0.0, 0.5), rng.uniform(0.0, 3.0)])
        scale = scale.with_target(t_s, rng.choice([0.0, 1.0, rng.random()]), rng.uniform(0.01, 1.0))
        scales.append(scale)
    return scales


def test_constant_rate_scales_time() -> None:
    scale = TimeScale.start(2.0, 0.5)
    assert scale.path_time(2.0) == 0.0
    assert scale.path_time(6.0) == 2.0
    assert scale.rate(6.0) == 0.5
    assert scale.time_of(2.0) == 6.0
    assert scale.settled_s == 2.0


def test_scale_may_begin_inside_a_move() -> None:
    scale = TimeScale.start(2.0, 1.0, s_start_s=0.75)
    assert scale.path_time(2.5) == 1.25
    assert scale.time_of(0.5) == 2.0


def test_pause_comes_to_rest_after_half_the_ramp_in_path_time() -> None:
    scale = TimeScale.start(0.0, 1.0).with_target(1.0, 0.0, 0.2)
    assert scale.rate(1.1) == pytest.approx(0.5)
    assert scale.path_time(1.1) == pytest.approx(1.075)
    assert scale.path_time(1.2) == scale.path_time(99.0) == pytest.approx(1.1)
    assert scale.rate(99.0) == 0.0


def test_what_a_stop_does_not_reach_is_never_reached() -> None:
    scale = TimeScale.start(0.0, 1.0).with_target(1.0, 0.0, 0.2)
    assert scale.time_of(1.1 + 1e-9) == inf
    assert scale.time_of(1.1 - 1e-9) < 1.2
    assert scale.time_of(1.09) == pytest.approx(1.2 - 0.2 * (0.01 / 0.1) ** 0.5)
    assert TimeScale.start(0.0, 0.0).time_of(1e-9) == inf


def test_resume_goes_on_where_the_pause_stopped() -> None:
    paused = TimeScale.start(0.0, 1.0).with_target(1.0, 0.0, 0.2)
    resumed = paused.with_target(5.0, 1.0, 0.4)
    assert resumed.path_time(5.0) == paused.path_time(5.0)
    assert resumed.path_time(5.4) == pytest.approx(1.1 + 0.2)
    assert resumed.time_of(2.3) == pytest.approx(6.4)


def test_change_without_a_ramp_takes_effect_at_once() -> None:
    scale = TimeScale.start(0.0, 0.0).with_target(1.0, 0.7, 0.0)
    assert scale.rate(1.0) == 0.7
    assert scale.path_time(2.0) == 0.7


@pytest.mark.parametrize("seed", first_of(range(100), 40))
def test_path_time_and_rate_are_continuous_where_the_target_changes(seed: int) -> None:
    scales = random_scales(seed)
    for before, after in pairwise(scales):
        assert after.path_time(after.t_start_s) == before.path_time(after.t_start_s)
        assert after.rate(after.t_start_s) == before.rate(after.t_start_s)


@pytest.mark.parametrize("seed", first_of(range(100), 40))
def test_rate_stays_between_its_targets_and_changes_no_faster_than_the_ramp(seed: int) -> None:
    for scale in random_scales(seed):
        low, high = sorted((scale.rate_start, scale.rate_target))
        dt = 0.01
        for k in range(150):
            t_s = scale.t_start_s + k * dt
            assert low <= scale.rate(t_s) <= high
            change = abs(scale.rate(t_s + dt) - scale.rate(t_s))
            if scale.ramp_s:
                assert change <= (high - low) / scale.ramp_s * dt * (1.0 + 1e-9) + 1e-15
            else:
                assert change == 0.0


@pytest.mark.parametrize("seed", first_of(range(100), 40))
def test_path_time_is_the_integral_of_the_rate(seed: int) -> None:
    for scale in random_scales(seed):
        for t_s, dt in ((scale.t_start_s, 0.5 * scale.ramp_s), (scale.settled_s, 1.3)):
            # The trapezoidal rule is exact for a linear rate.
            gained = scale.path_time(t_s + dt) - scale.path_time(t_s)
            assert gained == pytest.approx(0.5 * (scale.rate(t_s) + scale.rate(t_s + dt)) * dt, abs=ROUNDING_S)
            assert gained >= -ROUNDING_S


@pytest.mark.parametrize("seed", first_of(range(100), 40))
def test_time_of_finds_the_path_time_again(seed: int) -> None:
    rng = random.Random(seed)
    for scale in random_scales(seed):
        for _ in range(10):
            t_s = scale.t_start_s + rng.choice([rng.uniform(0.0, scale.ramp_s), rng.uniform(0.0, 5.0)])
            s = scale.path_time(t_s)
            found_s = scale.time_of(s)
            assert scale.t_start_s <= found_s <= t_s + 1e-6
            assert scale.path_time(found_s) == pytest.approx(s, abs=ROUNDING_S)


def test_time_before_the_scale_began_is_refused() -> None:
    scale = TimeScale.start(2.0, 1.0)
    for t_s in (1.999, nan):
        with pytest.raises(UsageError, match="before this time scale began"):
            scale.path_time(t_s)
        with pytest.raises(UsageError):
            scale.rate(t_s)


@pytest.mark.parametrize("rate", [-0.1, nan, inf])
def test_senseless_rates_are_refused(rate: float) -> None:
    with pytest.raises(UsageError, match="speed fraction"):
        TimeScale.start(0.0, rate)
    with pytest.raises(UsageError, match="speed fraction"):
        TimeScale.start(0.0, 1.0).with_target(1.0, rate, 0.1)


@pytest.mark.parametrize("ramp_s", [-0.1, nan, inf])
def test_senseless_ramps_are_refused(ramp_s: float) -> None:
    with pytest.raises(UsageError, match="ramp"):
        TimeScale.start(0.0, 1.0).with_target(1.0, 0.0, ramp_s)


MOVEJ = plan_movej(ARM, LIMITS, Q_WORK, MoveJ((1.3, -1.0, -0.4, -2.9, 1.4, 0.3), 1.396263, 1.047197)).segment
MOVEL = plan_movel(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, line_by(Q_WORK, 0.1, 0.2, -0.1)).segment
SINGULAR = plan_movel(ARM, LIMITS, Q_NEAR_WRIST, T_FLANGE_TCP, line_by(Q_NEAR_WRIST, 0.05, 0.2, -0.05, v=0.5)).segment


def hardest_braking(segment: Segment, scale: TimeScale) -> float:
    """Largest deceleration of a joint during a ramp, by differences, rad/s^2."""
    hardest = 0.0
    dt = scale.ramp_s / 400
    for k in range(400):
        t_s = scale.t_start_s + k * dt
        now, later = (
            [scale.rate(t) * speed for speed in segment.sample_speed(scale.path_time(t))] for t in (t_s, t_s + dt)
        )
        hardest = max(hardest, *((abs(a) - abs(b)) / dt for a, b in zip(now, later, strict=True)))
    return hardest


@pytest.mark.parametrize("rate", [1.0, 0.4])
@pytest.mark.parametrize("share", [0.05, 0.2, 0.5, 0.8, 0.97])
@pytest.mark.parametrize("segment", [MOVEJ, MOVEL], ids=["movej", "movel"])
def test_stop_keeps_the_deceleration_of_every_joint(segment: Segment, share: float, rate: float) -> None:
    path_time_s = share * segment.duration_s
    ramp_s = stop_ramp(segment, path_time_s, rate, 8.0)
    scale = TimeScale.start(0.0, rate, path_time_s).with_target(0.0, 0.0, ramp_s)
    assert hardest_braking(segment, scale) <= 8.0 * 1.02
    # And it is no longer than that: a quarter shorter would be too hard, unless the move ends by itself.
    if share < 0.8:
        short = TimeScale.start(0.0, rate, path_time_s).with_target(0.0, 0.0, 0.75 * ramp_s)
        assert hardest_braking(segment, short) > 8.0 * 1.02


def test_stop_of_a_cruising_movej_takes_speed_by_deceleration() -> None:
    assert stop_ramp(MOVEJ, 0.5 * MOVEJ.duration_s, 1.0, 8.0) == pytest.approx(1.047197 / 8.0, rel=1e-3)
    assert stop_ramp(MOVEJ, 0.5 * MOVEJ.duration_s, 0.5, 8.0) == pytest.approx(0.5 * 1.047197 / 8.0, rel=1e-3)


@pytest.mark.parametrize("share", [0.01, 0.02, 0.05, 0.1])
def test_stop_near_a_singularity_looks_ahead(share: float) -> None:
    path_time_s = share * SINGULAR.duration_s
    ramp_s = stop_ramp(SINGULAR, path_time_s, 1.0, 20.0)
    scale = TimeScale.start(0.0, 1.0, path_time_s).with_target(0.0, 0.0, ramp_s)
    # The planned braking uses up to 40 rad/s^2 here; the stop adds half of its own at most.
    assert hardest_braking(SINGULAR, scale) <= 40.0 + 10.0


def test_stop_that_is_next_to_none_has_a_ramp_all_the_same() -> None:
    ramp_s = stop_ramp(MOVEJ, 0.5 * MOVEJ.duration_s, 1.0, 5e-324)
    scale = TimeScale.start(0.0, 1.0).with_target(0.5 * MOVEJ.duration_s, 0.0, ramp_s)
    assert scale.time_of(MOVEJ.duration_s) == pytest.approx(MOVEJ.duration_s)


def test_arm_at_rest_needs_no_ramp() -> None:
    for path_time_s, rate in ((0.0, 1.0), (MOVEJ.duration_s, 1.0), (0.5 * MOVEJ.duration_s, 0.0)):
        assert stop_ramp(MOVEJ, path_time_s, rate, 8.0) == pytest.approx(0.0, abs=1e-3)


def test_tool_stop_of_a_cruising_line_takes_speed_by_deceleration() -> None:
    assert stop_ramp_tool(MOVEL, 0.5 * MOVEL.duration_s, 1.0, 3.0) == pytest.approx(0.25 / 3.0, rel=1e-3)


def test_tool_stop_also_bounds_the_rotation_of_the_tool() -> None:
    spin = plan_movej(ARM, LIMITS, Q_WORK, MoveJ((*Q_WORK[:5], 2.0), 1.4, 1.0)).segment
    assert stop_ramp_tool(spin, 0.5 * spin.duration_s, 1.0, 3.0) == pytest.approx(1.0 / 3.0, rel=1e-3)


@pytest.mark.parametrize("deceleration", [0.0, -1.0, nan, inf])
def test_senseless_decelerations_are_refused(deceleration: float) -> None:
    with pytest.raises(UsageError, match="deceleration"):
        stop_ramp(MOVEJ, 0.5, 1.0, deceleration)
    with pytest.raises(UsageError, match="deceleration"):
        stop_ramp_tool(MOVEJ, 0.5, 1.0, deceleration)


def test_a_rebased_scale_goes_on_with_rate_and_ramp() -> None:
    scale = TimeScale.start(1.0, 1.0).with_target(2.0, 0.3, 0.5)
    for t_s in (2.0, 2.2, 2.5, 7.0):
        rebased = scale.rebased(t_s)
        assert rebased.path_time(t_s) == 0.0
        for later_s in (t_s, t_s + 0.1, t_s + 0.4, t_s + 3.0):
            assert rebased.rate(later_s) == pytest.approx(scale.rate(later_s), abs=1e-12)
            gone_s = scale.path_time(later_s) - scale.path_time(t_s)
            assert rebased.path_time(later_s) == pytest.approx(gone_s, abs=1e-12)


@pytest.mark.parametrize(("rate", "rate_target"), [(1.0, 0.3), (0.3, 1.0), (1.0, 0.0), (0.0, 1.0)])
@pytest.mark.parametrize("share", [0.02, 0.1, 0.3, 0.6, 0.9, 0.97])
def test_another_rate_leaves_the_joints_within_their_limits(rate: float, rate_target: float, share: float) -> None:
    home = (0.0,) * 6
    quick = plan_movej(ARM, LIMITS, home, MoveJ((3.0, -1.0, 1.0, 1.0, 1.0, 1.0), 40.0, 3.0)).segment
    for segment in (quick, MOVEJ, SINGULAR):
        path_time_s = share * segment.duration_s
        ramp_s = change_ramp(segment, path_time_s, rate, rate_target, 0.2, LIMITS.qdd_max)
        assert ramp_s >= 0.2
        scale = TimeScale(0.0, path_time_s, rate, rate_target, ramp_s)
        dt = 1e-4
        for step in range(int((ramp_s + 0.2) / dt)):
            before, after = [
                [w * scale.rate(t) for w in segment.sample_speed(min(scale.path_time(t), segment.duration_s))]
                for t in (step * dt, (step + 1) * dt)
            ]
            for w, w_later, limit in zip(before, after, LIMITS.qdd_max, strict=True):
                assert abs(w_later - w) / dt <= 1.06 * limit


def test_another_rate_takes_its_time_where_there_is_room() -> None:
    assert change_ramp(MOVEL, 0.5 * MOVEL.duration_s, 1.0, 0.5, 0.2, LIMITS.qdd_max) == 0.2


@pytest.mark.parametrize("share", [0.3, 0.9, 0.95, 0.99])
def test_a_move_that_brakes_nearly_as_hard_as_asked_is_left_to_its_braking(share: float) -> None:
    """Where the plan leaves room for nothing more, a stop of 1.3 m/s^2 lets it come to rest at its target."""
    path_time_s = share * MOVEL.duration_s
    ramp_s = stop_ramp_tool(MOVEL, path_time_s, 1.0, 1.3)
    scale = TimeScale.start(0.0, 1.0, path_time_s).with_target(0.0, 0.0, ramp_s)
    dt = 1e-3

    def speed(t_s: float) -> float:
        at_s = scale.path_time(t_s)
        return MOVEL.tool_speed(at_s)[0] * scale.rate(t_s) if at_s < MOVEL.duration_s else 0.0

    speeds = [speed(dt * k) for k in range(500)]
    assert max(a - b for a, b in pairwise(speeds)) <= 1.3 * 1.02 * dt
    assert speeds[-1] == 0.0
    assert next(k for k, v in enumerate(speeds) if v == 0.0) * dt <= 2.0 * speeds[0] / 1.3 + dt
