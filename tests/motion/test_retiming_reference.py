"""Speeds within the joint limits, to the last bit as the plainest code finds them: point by point, bound by bound."""

from __future__ import annotations

from bisect import insort
from math import ceil, inf
from random import Random
from typing import NamedTuple

import pytest

from elitescript.errors import MotionError
from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.track import JointTrack, follow
from elitescript.motion.timing import retiming
from elitescript.motion.timing.profile import Law, TimeLaw, trapezoid_of
from tests.invariants.cases import CASES
from tests.motion.test_track_reference import random_follows


class Point(NamedTuple):
    s: float
    slope: tuple[float, ...]
    curvature: tuple[float, ...]
    is_free_ahead: bool


def slope_and_curvature(track: JointTrack, k: int, f: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    h = track.grid_s[k + 1] - track.grid_s[k]
    slope, curvature = [], []
    for j in range(6):
        da, db = track.grid_slope[k][j], track.grid_slope[k + 1][j]
        bow = 6.0 * (track.grid_q[k + 1][j] - track.grid_q[k][j]) / h - 3.0 * (da + db)
        slope.append(abs(da + (db - da) * f + bow * (f * (1.0 - f))))
        curvature.append(abs(db - da + bow * (1.0 - 2.0 * f)) / h)
    return tuple(slope), tuple(curvature)


def plain_grid(track: JointTrack, wanted: TimeLaw, law: Law) -> list[Point]:
    a = max(law.a, law.brake)
    closest = 1e-6 * track.length
    grid: list[Point] = []
    was_free = False
    slope: tuple[float, ...] = (0.0,) * 6
    curvature: tuple[float, ...] = (0.0,) * 6
    for k, (speed_ratio, acceleration_ratio, curvature_ratio) in enumerate(track.interval_ratios):
        s_a, s_b = track.grid_s[k], track.grid_s[k + 1]
        if s_b <= wanted.start + closest:
            continue
        s_first = max(s_a, wanted.start)
        if speed_ratio * law.v <= 1.0 and acceleration_ratio * a + curvature_ratio * law.v * law.v <= 1.0:
            if not was_free:
                grid.append(Point(s_first, slope, curvature, True))
                slope = curvature = (0.0,) * 6
            was_free = True
            continue
        h = s_b - s_a
        parts = max(retiming.SUBDIVISION, ceil(retiming.PARTS_MIN * h / track.length))
        positions = [s_first + (s_b - s_first) * part / parts for part in range(parts)]
        for corner in wanted.corners:
            if s_first < corner < s_b and all(abs(corner - s) > closest for s in (*positions, s_b)):
                insort(positions, corner)
        for s in positions:
            here = slope_and_curvature(track, k, (s - s_a) / h)
            bend = tuple(map(max, here[1], curvature)) if s == s_first else here[1]
            grid.append(Point(s, here[0], bend, False))
        slope, curvature = slope_and_curvature(track, k, 1.0)
        was_free = False
    return [*grid, Point(track.length, slope, curvature, False)]


def plain_bound(point: Point, limits: MotionLimits) -> float:
    bound = inf
    for j in range(6):
        slope, curvature = point.slope[j], point.curvature[j]
        top = retiming.SPEED_MARGIN * limits.qd_max[j]
        if slope * slope * bound > top**2:
            bound = (top / slope) ** 2
        if curvature * bound > retiming.CURVATURE_SHARE * limits.qdd_max[j]:
            bound = retiming.CURVATURE_SHARE * limits.qdd_max[j] / curvature
    return bound


def plain_reach(point: Point, near: Point, x_near: float, is_free: bool, limits: MotionLimits, a: float) -> float:
    way = 2.0 * abs(near.s - point.s)
    reachable = x_near + way * a
    for j in () if is_free else range(6):
        slope, curvature, allowed = point.slope[j], point.curvature[j], retiming.ACCELERATION_MARGIN * limits.qdd_max[j]
        if (slope + way * curvature) * reachable > slope * x_near + way * allowed:
            reachable = (slope * x_near + way * allowed) / (slope + way * curvature)
        if near.slope[j] * (reachable - x_near) > way * (allowed - near.curvature[j] * x_near):
            reachable = x_near + way * (allowed - near.curvature[j] * x_near) / near.slope[j]
    return reachable


def plainly_passed(grid: list[Point], limits: MotionLimits, law: Law, x_start: float) -> list[float] | None:
    """The squares of the speeds, with every neighbour looked at in both passes."""
    x = [min(law.v * law.v, plain_bound(point, limits)) for point in grid]
    x[-1] = 0.0
    for k in range(len(x) - 2, -1, -1):
        x[k] = min(x[k], plain_reach(grid[k], grid[k + 1], x[k + 1], grid[k].is_free_ahead, limits, law.brake))
    if x_start > x[0] * (1.0 + 1e-9):
        return None
    x[0] = x_start
    for k in range(1, len(x)):
        x[k] = min(x[k], plain_reach(grid[k], grid[k - 1], x[k - 1], grid[k - 1].is_free_ahead, limits, law.a))
    return x


def random_tracks(count: int) -> list[tuple[JointTrack, MotionLimits, float, float, Random]]:
    tracks = []
    for number, (arm, limits, path, q_start, speed, acceleration) in enumerate(random_follows(count)):
        try:
            track = follow(arm, limits, path, q_start, speed, acceleration)
        except MotionError:
            continue
        if path.kind != "blend":
            tracks.append((track, limits, speed, acceleration, Random(number)))
    return tracks


@pytest.mark.invariants
def test_random_paths_get_the_speeds_of_the_plainest_code() -> None:
    slowed = refused = 0
    for track, limits, v, a, chance in random_tracks(10 * CASES):
        law = Law(v, a, chance.choice((a, 0.8 * a)))
        start = chance.choice((0.0, 0.3 * track.length))
        v_start = chance.choice((0.0, 0.5, 1.0)) * min(v, (2.0 * law.brake * (track.length - start)) ** 0.5)
        v_start *= start > 0.0
        wanted = trapezoid_of(track.length, law, start, v_start)
        law = law._replace(v=wanted.peak_speed)
        points = plain_grid(track, wanted, law)
        grid = retiming._grid(track, wanted, law)
        assert [tuple(map(tuple, row)) for row in (grid.slopes, grid.curvatures)] == [
            tuple(point.slope for point in points),
            tuple(point.curvature for point in points),
        ]
        assert (grid.s, grid.is_free_ahead) == (
            [point.s for point in points],
            [point.is_free_ahead for point in points],
        )
        x = plainly_passed(points, limits, law, v_start * v_start)
        assert retiming._passed(grid, limits, law, v_start * v_start) == x
        slowed += len(points) > 2
        refused += x is None
    assert slowed > CASES
    assert refused
