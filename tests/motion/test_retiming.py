"""Slowing down where joint limits bind, and only there."""

from __future__ import annotations

import pytest

from elitescript.kinematics.transforms import compose, transform_from_pose
from elitescript.messages.motion import Six
from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.cartesian import line
from elitescript.motion.paths.track import JointTrack, follow
from elitescript.motion.segment import RunningSegment
from elitescript.motion.timing.profile import Law, TimeLaw, trapezoid, trapezoid_lasting, trapezoid_of
from elitescript.motion.timing.retiming import entered, keeps_limits, retimed
from tests.motion.moves import (
    ARM,
    LIMITS,
    Q_NEAR_WRIST,
    Q_WORK,
    T_FLANGE_TCP,
    limits_of,
    shifted,
    wrist_passage,
)

WEAK = limits_of("CS66", qdd_max=(5.0,) * 6)
PASSING = (0.05, 0.2, -0.05)
"""A shift from `Q_NEAR_WRIST` that passes near the wrist singularity and leaves it behind."""


def track_by(q_start: Six, limits: MotionLimits, v: float, a: float, *offset: float) -> JointTrack:
    T_base_flange = ARM.forward(q_start)
    T_end = transform_from_pose(shifted(q_start, *offset))
    path = line(T_base_flange, compose(T_base_flange, T_FLANGE_TCP), T_end, 0.25)
    return follow(ARM, limits, path, q_start, v, a)


def worst_shares(track: JointTrack, limits: MotionLimits, profile: TimeLaw) -> tuple[float, float]:
    """Largest share of the speed and of the acceleration limits that any joint uses."""
    speed_share = acceleration_share = 0.0
    h = 1e-6 * track.length
    for k in range(1, 1000):
        s = track.length * k / 1000
        _, before = track.q_and_slope(s - h)
        _, slope = track.q_and_slope(s)
        _, after = track.q_and_slope(s + h)
        speed = profile.speed_at_position(s)
        x_before, x_after = profile.speed_at_position(s - h) ** 2, profile.speed_at_position(s + h) ** 2
        u = (x_after - x_before) / (4.0 * h)
        for d, d_before, d_after, qd_max, qdd_max in zip(
            slope, before, after, limits.qd_max, limits.qdd_max, strict=True
        ):
            speed_share = max(speed_share, abs(d) * speed / qd_max)
            curvature = (d_after - d_before) / (2.0 * h)
            acceleration_share = max(acceleration_share, abs(d * u + curvature * speed * speed) / qdd_max)
    return speed_share, acceleration_share


def test_trapezoid_is_kept_as_it_is_where_no_limit_binds() -> None:
    track = track_by(Q_WORK, LIMITS, 0.25, 1.2, 0.1, 0.15, -0.08)
    wanted = trapezoid(track.length, 0.25, 1.2)
    result = retimed(track, LIMITS, wanted)
    assert result.profile is wanted
    assert result.slow_place is None
    assert keeps_limits(track, LIMITS, wanted)


@pytest.mark.parametrize("limits", [LIMITS, WEAK], ids=["strong", "weak"])
@pytest.mark.parametrize(
    ("q_start", "offset"),
    [
        (Q_NEAR_WRIST, PASSING),
        (Q_WORK, (0.0, 0.4, -0.2)),
        (Q_WORK, (0.001, 0.0, 0.0, 0.0, 0.0, 1.5)),
    ],
    ids=["wrist", "long", "turn on the spot"],
)
def test_joints_keep_their_limits(limits: MotionLimits, q_start: Six, offset: tuple[float, ...]) -> None:
    track = track_by(q_start, limits, 2.0, 20.0, *offset)
    wanted = trapezoid(track.length, 2.0, 20.0)
    assert not keeps_limits(track, limits, wanted)
    result = retimed(track, limits, wanted)
    assert result.profile.duration_s > wanted.duration_s
    speed_share, acceleration_share = worst_shares(track, limits, result.profile)
    assert speed_share <= 1.0 + 1e-3
    assert acceleration_share <= 1.02
    # It is not slow for nothing: somewhere a limit is used up.
    assert max(speed_share, acceleration_share) > 0.95


def test_only_the_place_of_the_limit_is_slowed_down() -> None:
    q_start, request = wrist_passage(0.05)
    T_base_flange = ARM.forward(q_start)
    T_end = transform_from_pose(request.p_target)
    track = follow(
        ARM, LIMITS, line(T_base_flange, compose(T_base_flange, T_FLANGE_TCP), T_end, 0.25), q_start, 0.25, 1.2
    )
    wanted = trapezoid(track.length, 0.25, 1.2)
    result = retimed(track, LIMITS, wanted)
    place = result.slow_place
    assert place is not None
    assert place.s == pytest.approx(0.5 * track.length, abs=0.002)
    assert place.joint in (3, 5)
    assert place.speed < 0.5 * place.speed_wanted == 0.125
    for s in (0.001, 0.01, 0.03, 0.05, 0.15, 0.17, 0.19, 0.199):
        assert result.profile.speed_at_position(s) == pytest.approx(wanted.speed_at_position(s), rel=1e-9)


def test_profile_is_nowhere_quicker_than_wanted() -> None:
    track = track_by(Q_WORK, WEAK, 1.0, 8.0, 0.0, 0.4, -0.2)
    wanted = trapezoid(track.length, 1.0, 8.0)
    profile = retimed(track, WEAK, wanted).profile
    for k in range(1001):
        s = track.length * k / 1000
        assert profile.speed_at_position(s) <= wanted.speed_at_position(s) * (1.0 + 1e-9) + 1e-8
    assert abs(max(abs(profile.acceleration(profile.duration_s * k / 500)) for k in range(500))) <= 8.0 * (1.0 + 1e-9)


def test_profile_is_continuous_and_ends_exactly() -> None:
    track = track_by(Q_NEAR_WRIST, WEAK, 0.5, 4.0, *PASSING)
    profile = retimed(track, WEAK, trapezoid(track.length, 0.5, 4.0)).profile
    assert profile.at(profile.duration_s) == (track.length, 0.0)
    step_s = profile.duration_s / 5000
    for k in range(5000):
        s, v = profile.at(k * step_s)
        s_next, v_next = profile.at((k + 1) * step_s)
        assert abs(v_next - v) <= 4.0 * step_s * (1.0 + 1e-9)
        assert s_next - s == pytest.approx(0.5 * (v + v_next) * step_s, abs=4.0 * step_s**2)


def test_finer_grid_hardly_changes_the_duration(monkeypatch: pytest.MonkeyPatch) -> None:
    track = track_by(Q_NEAR_WRIST, WEAK, 0.5, 4.0, *PASSING)
    wanted = trapezoid(track.length, 0.5, 4.0)
    duration_s = retimed(track, WEAK, wanted).profile.duration_s
    monkeypatch.setattr("elitescript.motion.timing.retiming.SUBDIVISION", 40)
    assert retimed(track, WEAK, wanted).profile.duration_s == pytest.approx(duration_s, rel=0.01)


def test_prescribed_duration_is_checked_against_the_joints() -> None:
    track = track_by(Q_NEAR_WRIST, LIMITS, 0.5, 4.0, *PASSING)
    slow = trapezoid_lasting(track.length, 30.0, 2.5, 40.0)
    quick = trapezoid_lasting(track.length, 0.6, 2.5, 40.0)
    assert slow is not None and keeps_limits(track, LIMITS, slow)
    assert quick is not None and not keeps_limits(track, LIMITS, quick)


def test_entering_at_speed_goes_on_from_there_within_the_limits() -> None:
    track = track_by(Q_NEAR_WRIST, LIMITS, 0.5, 4.0, *PASSING)
    law = Law(0.5, 4.0, 3.2)
    from_rest = entered(track, LIMITS, law, 0.0, 0.0)
    assert from_rest is not None
    start, speed = 0.4 * track.length, from_rest.speed_at_position(0.4 * track.length)
    profile = entered(track, LIMITS, law, start, 0.9 * speed)
    assert profile is not None
    assert profile.at(0.0) == (start, pytest.approx(0.9 * speed))
    assert profile.at(profile.duration_s) == (track.length, 0.0)
    segment = RunningSegment(track, profile)
    for k in range(500):
        t_s = (segment.duration_s - 1e-5) * k / 500
        qd, qd_later = segment.sample_speed(t_s), segment.sample_speed(t_s + 1e-5)
        for w, w_later, top, a_top in zip(qd, qd_later, LIMITS.qd_max, LIMITS.qdd_max, strict=True):
            assert abs(w) <= top * 1.001
            assert abs(w_later - w) <= a_top * 1e-5 * 1.03


def test_entering_faster_than_the_limits_allow_is_impossible() -> None:
    track = track_by(Q_NEAR_WRIST, LIMITS, 0.5, 4.0, *PASSING)
    law = Law(0.5, 4.0, 4.0)
    retimed_profile = retimed(track, LIMITS, trapezoid(track.length, 0.5, 4.0)).profile
    slow_s = min((0.02 * k * track.length for k in range(5, 45)), key=retimed_profile.speed_at_position)
    assert entered(track, LIMITS, law, slow_s, 0.5) is None
    assert entered(track, LIMITS, law, track.length, 0.1) is None
    assert entered(track, LIMITS, law, 0.999 * track.length, 0.4) is None


def test_entering_a_free_path_is_the_trapezoid() -> None:
    track = track_by(Q_WORK, LIMITS, 0.1, 1.0, 0.0, 0.1)
    law = Law(0.1, 1.0, 0.8)
    profile = entered(track, LIMITS, law, 0.01, 0.05)
    assert profile is not None
    assert profile.duration_s == trapezoid_of(track.length, law, 0.01, 0.05).duration_s
