"""The curve through points at a constant interval."""

from __future__ import annotations

from math import cos, sin
from random import Random
from typing import Any

import pytest

from elitescript.motion.paths.spline import JointSpline

H = 0.008


def spline_of(function: Any, count: int = 40, h: float = H) -> JointSpline:
    """Six joints that follow the function, each a little stronger than the one before."""
    return JointSpline([[(1.0 + 0.1 * joint) * function(k * h) for k in range(count)] for joint in range(6)], h)


def random_columns(seed: int, count: int) -> list[list[float]]:
    chance = Random(seed)
    return [[chance.uniform(-1.0, 1.0) for _ in range(count)] for _ in range(6)]


@pytest.mark.parametrize("count", [2, 3, 4, 5, 50])
def test_passes_through_every_point_at_its_time(count: int) -> None:
    columns = random_columns(count, count)
    spline = JointSpline(columns, H)
    for k in range(count):
        assert spline.q_and_speed(k * H)[0] == pytest.approx([column[k] for column in columns], abs=1e-12)
    assert spline.duration_s == (count - 1) * H
    assert spline.point(-1) == tuple(column[-1] for column in columns)


def test_speed_and_acceleration_are_continuous_at_the_points() -> None:
    spline = JointSpline(random_columns(3, 12), H)
    d = 1e-9
    for k in range(1, 11):
        before, behind = (spline.q_and_speed(k * H + side)[1] for side in (-d, d))
        # Up to 1e6 rad/s^2 times the width of the difference.
        assert before == pytest.approx(behind, abs=5e-3)
        earlier, later = (spline.q_and_speed(k * H + side)[1] for side in (-1e-5, 1e-5))
        for joint in range(6):
            here = spline.q_and_speed(k * H)[1][joint]
            left, right = (here - earlier[joint]) / 1e-5, (later[joint] - here) / 1e-5
            m = spline.seconds[joint][k]
            scale = max(map(abs, spline.seconds[joint]))
            assert left == pytest.approx(m, abs=1e-2 * scale)
            assert right == pytest.approx(m, abs=1e-2 * scale)


def test_speed_is_the_derivative_of_the_position() -> None:
    spline = spline_of(lambda t: sin(3.0 * t))
    for k in range(1, 300):
        t_s = k * 0.001
        after, before = spline.q_and_speed(t_s + 1e-6)[0], spline.q_and_speed(t_s - 1e-6)[0]
        slope = [(b - a) / 2e-6 for a, b in zip(before, after, strict=True)]
        assert spline.q_and_speed(t_s)[1] == pytest.approx(slope, abs=1e-6)


def test_follows_a_smooth_motion_between_the_points() -> None:
    spline = spline_of(lambda t: sin(3.0 * t))
    for k in range(312):
        q, speed = spline.q_and_speed(k * 0.001)
        # h^4 q'''' / 384 inside; the estimate of the speed at the ends costs h^2 q''' / 3 of speed there.
        assert q[0] == pytest.approx(sin(0.003 * k), abs=3e-6)
        assert speed[0] == pytest.approx(3.0 * cos(0.003 * k), abs=2e-3)


@pytest.mark.parametrize(
    ("function", "is_at_rest"),
    [
        (lambda t: t, False),
        (lambda t: t + 5.0 * t * t, False),
        (lambda t: 0.0, True),
        (lambda t: 2.0 * t * t, True),
        (lambda t: 40.0 * t**3, True),
        (lambda t: 1.0 - cos(5.0 * t), True),
        (lambda t: max(0.0, t - 2 * H), True),
        (lambda t: 5e-4 * t, True),
    ],
)
def test_tells_a_start_at_rest_from_one_at_a_speed(function: Any, is_at_rest: bool) -> None:
    spline = spline_of(function)
    assert spline.is_start_at_rest is is_at_rest
    backwards = spline_of(lambda t: function(39 * H - t))
    assert backwards.is_end_at_rest is is_at_rest
    if is_at_rest:
        assert spline.q_and_speed(0.0)[1] == pytest.approx((0.0,) * 6, abs=1e-12)


def test_one_moving_joint_is_enough_for_a_start_at_a_speed() -> None:
    columns = [[0.0] * 9 for _ in range(5)] + [[0.01 * k for k in range(9)]]
    assert not JointSpline(columns, H).is_start_at_rest


def test_two_points_are_a_straight_line() -> None:
    spline = JointSpline([[0.0, 0.5]] * 6, 0.1)
    assert spline.q_and_speed(0.025) == ((0.125,) * 6, (5.0,) * 6)


@pytest.mark.parametrize("seed", range(20))
def test_largest_speeds_accelerations_and_positions_are_those_of_the_curve(seed: int) -> None:
    spline = JointSpline(random_columns(seed, 8), H)
    for interval in range(7):
        rows = [spline.q_and_speed((interval + f / 200) * H) for f in range(201)]
        for joint in range(6):
            speed, acceleration = spline.largest(joint, interval)
            largest = max(abs(row[1][joint]) for row in rows)
            assert largest <= speed * (1.0 + 1e-9)
            assert speed <= 1.001 * largest + 0.01
            m = spline.seconds[joint]
            assert acceleration == max(abs(m[interval]), abs(m[interval + 1]))
            low, high = spline.extremes(joint, interval)
            positions = [row[0][joint] for row in rows]
            assert low == pytest.approx(min(positions), abs=1e-3)
            assert high == pytest.approx(max(positions), abs=1e-3)
            assert low <= min(positions) + 1e-12
            assert high >= max(positions) - 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_excess_finds_exactly_the_intervals_beyond_the_limits(seed: int) -> None:
    chance = Random(seed)
    columns = random_columns(seed, 30)
    # Quiet stretches, for which the cheap test has to be right too.
    for column in columns:
        for k in range(8, 22):
            column[k] = 0.5 + chance.uniform(-1e-4, 1e-4)
    spline = JointSpline(columns, H)
    v, a = (30.0,) * 6, (chance.choice((3e3, 1e9)),) * 6
    wanted = {}
    for interval in range(29):
        shares = [
            (speed / v[0], acceleration / a[0])
            for speed, acceleration in (spline.largest(j, interval) for j in range(6))
        ]
        joint = max(range(6), key=lambda j: max(shares[j][0] ** 2, shares[j][1]))
        if max(shares[joint][0] ** 2, shares[joint][1]) > 1.0:
            wanted[interval] = (joint, *shares[joint])
    found = spline.excess(v, a)
    assert found.keys() == wanted.keys()
    assert wanted
    for interval, expected in wanted.items():
        assert found[interval] == pytest.approx(expected)


def plain_seconds(q: list[float], h: float, speed_start: float, speed_end: float) -> list[float]:
    """The elimination point by point, with its factors made anew for each joint."""
    factor, c = 6.0 / h, 0.5
    g = 0.5 * factor * ((q[1] - q[0]) / h - speed_start)
    rows = [(c, g)]
    for k in range(2, len(q)):
        c = 1.0 / (4.0 - c)
        g = (factor * ((q[k] - q[k - 1]) / h - (q[k - 1] - q[k - 2]) / h) - g) * c
        rows.append((c, g))
    m = [(factor * (speed_end - (q[-1] - q[-2]) / h) - g) / (2.0 - c)]
    for c, g in reversed(rows):
        m.append(g - c * m[-1])
    return m[::-1]


@pytest.mark.parametrize("count", [2, 3, 6, 19, 24, 25, 26, 60])
def test_accelerations_are_to_the_last_bit_those_of_the_plain_elimination(count: int) -> None:
    columns = random_columns(count, count)
    for column in columns:
        # At rest at both ends.
        column[:3] = column[:1] * len(column[:3])
        column[-3:] = column[-1:] * len(column[-3:])
    spline = JointSpline(columns, H)
    assert spline.is_start_at_rest and spline.is_end_at_rest
    for column, m, largest in zip(columns, spline.seconds, spline.largest_accelerations, strict=True):
        assert m.tolist() == plain_seconds(column, H, 0.0, 0.0)
        assert largest == max(map(abs, m))
