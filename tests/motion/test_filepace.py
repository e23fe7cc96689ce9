"""The rate at which a file is played."""

from __future__ import annotations

from math import cos, pi, sin
from random import Random
from typing import Any

import pytest

from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.spline import JointSpline
from elitescript.motion.timing import point_timing
from elitescript.motion.timing.point_timing import PointTiming, paced
from tests.motion.moves import limits_of

H = 0.004
LIMITS = limits_of("CS66", qd_max=(2.0,) * 6, qdd_max=(20.0,) * 6)


def spline_of(function: Any, count: int, h: float = H) -> JointSpline:
    return JointSpline([[(1.0 - 0.1 * joint) * function(k * h) for k in range(count)] for joint in range(6)], h)


def check_limits(spline: JointSpline, pace: PointTiming, limits: MotionLimits = LIMITS) -> tuple[float, float]:
    """Check speeds and accelerations between all samples; return the largest shares of the limits."""
    profile = pace.profile
    steps = 4000
    d = profile.duration_s / steps
    shares = [0.0, 0.0]
    before: Any = None
    for k in range(steps + 1):
        s, rate = profile.at(k * d)
        assert 0.0 <= rate <= 1.0 + 1e-12
        q, slope = spline.q_and_speed(s)
        qd = [rate * w for w in slope]
        shares[0] = max(shares[0], *(abs(w) / top for w, top in zip(qd, limits.qd_max, strict=True)))
        if before is not None:
            for joint in range(6):
                assert abs(q[joint] - before[0][joint]) <= limits.qd_max[joint] * d * (1.0 + 1e-9)
                share = abs(qd[joint] - before[1][joint]) / d / limits.qdd_max[joint]
                shares[1] = max(shares[1], share)
        before = q, qd
    assert shares[0] <= 1.0 + 1e-9
    assert shares[1] <= 1.0 + 1e-6
    return shares[0], shares[1]


def test_a_file_from_rest_to_rest_takes_exactly_its_time() -> None:
    spline = spline_of(lambda t: 0.2 * (1.0 - cos(pi * t / 0.8)), 401)
    pace = paced(spline, LIMITS)
    assert pace.profile.duration_s == 400 * H
    assert pace.too_fast is None
    assert [pace.profile.at(t) for t in (0.1, 0.8, 1.5)] == [(0.1, 1.0), (0.8, 1.0), (1.5, 1.0)]


def test_a_file_at_a_speed_is_longer_by_its_ramps() -> None:
    pace = paced(spline_of(lambda t: 1.5 * t, 201), LIMITS)
    # Both ramps last v / a and cover v^2 / 2 a of the way.
    assert pace.profile.duration_s == pytest.approx(0.8 + 1.5 / 20.0, rel=1e-9)
    assert pace.too_fast is None
    assert pace.profile.at(0.0) == (0.0, 0.0)
    assert pace.profile.at(0.4)[1] == 1.0


@pytest.mark.parametrize("count", [2, 3, 4])
def test_few_points_far_apart_in_time_have_short_ramps_too(count: int) -> None:
    spline = spline_of(lambda t: 0.5 * t, count, h=1.0)
    pace = paced(spline, LIMITS)
    assert pace.profile.duration_s == pytest.approx(count - 1.0 + 0.5 / 20.0, rel=1e-9)
    check_limits(spline, pace)


def test_too_little_way_for_the_speed_of_the_file() -> None:
    spline = spline_of(lambda t: 1.9 * t, 2)
    pace = paced(spline, LIMITS)
    assert pace.profile.duration_s == pytest.approx(2.0 * (1.9 * H / 20.0) ** 0.5, rel=1e-9)
    check_limits(spline, pace)


def test_standing_still_takes_its_time() -> None:
    pace = paced(spline_of(lambda t: 0.3, 101), LIMITS)
    assert pace.profile.duration_s == 100 * H


def test_too_high_a_speed_is_lowered_where_it_is_too_high_only() -> None:
    # 1 rad/s, and 3 rad/s from 0.5 s to 0.7 s, with changes of 50 ms.
    speeds = [1.0 + 2.0 * min(1.0, max(0.0, min(k * H - 0.5, 0.75 - k * H) / 0.05)) for k in range(300)]
    way = [H * sum(speeds[:k]) for k in range(301)]
    spline = JointSpline([[(1.0 - 0.1 * joint) * s for s in way] for joint in range(6)], H)
    pace = paced(spline, LIMITS)
    assert pace.too_fast is not None
    assert 124 <= pace.too_fast.interval <= 190
    assert pace.too_fast.joint == 0
    assert check_limits(spline, pace)[0] > 0.99
    # The 200 ms at 3 rad/s take 100 ms longer at 2, and braking for that some more.
    assert 1.2 + 0.1 < pace.profile.duration_s < 1.2 + 0.35
    assert pace.profile.at(0.3) == pytest.approx((0.3 - 0.5 / 20.0 / 1.0 * 1.0, 1.0), abs=2e-3)


def test_a_corner_is_passed_slowly() -> None:
    spline = spline_of(lambda t: abs(t - 0.4), 201)
    pace = paced(spline, LIMITS)
    assert pace.too_fast is not None
    assert abs(pace.too_fast.interval - 100) <= 2
    assert not pace.too_fast.is_speed
    assert pace.too_fast.rate < 0.5
    assert check_limits(spline, pace)[1] > 0.8


@pytest.mark.parametrize("seed", range(25))
def test_limits_hold_for_smooth_and_for_rough_points(seed: int) -> None:
    chance = Random(seed)
    h = chance.choice((0.002, 0.004, 0.008, 0.02, 0.1))
    waves = [
        [(chance.uniform(0.0, 0.5), chance.uniform(0.5, 12.0), chance.uniform(0.0, 6.0)) for _ in range(3)]
        for _ in range(6)
    ]
    noise = chance.choice((0.0, 1e-6, 1e-4, 1e-2))
    columns = [
        [sum(a * sin(w * k * h + p) for a, w, p in wave) + chance.uniform(-noise, noise) for k in range(120)]
        for wave in waves
    ]
    spline = JointSpline(columns, h)
    pace = paced(spline, LIMITS)
    assert pace.profile.duration_s >= spline.duration_s
    assert pace.profile.at(pace.profile.duration_s) == (spline.duration_s, 0.0)
    check_limits(spline, pace)


@pytest.mark.parametrize("count", [401, 4001])
def test_even_intervals_are_one_piece_made_at_once(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    added: list[tuple[float, ...]] = []
    add = point_timing._Pieces.add

    def counted(pieces: point_timing._Pieces, *piece: float) -> None:
        added.append(piece)
        add(pieces, *piece)

    monkeypatch.setattr(point_timing._Pieces, "add", counted)
    profile = paced(spline_of(lambda t: 1.5 * t, count), LIMITS).profile
    (even,) = [piece for piece in added if piece[1] - piece[0] > 2.0 * H]
    assert even[2:] == (1.0, 1.0, 0.0)
    # What is left are the ramps.
    assert 1 < len(added) <= 3 * 2 * round(1.5 / 20.0 / H)
    assert profile.at(0.5 * profile.duration_s) == (pytest.approx(0.5 * (count - 1) * H), 1.0)
