"""Compares what the arm does between two marks of two runs: where it goes, and when.

Where is compared without time: each recorded place with the nearest one of the simulated path, as far from the begin of
the path; no warping of time can hide a difference. When is compared by the time since the mark: a recorded place is in
time if the simulated arm is there within the tolerance.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from itertools import pairwise
from math import ceil, dist, inf, sqrt
from statistics import median
from typing import Final

from elitescript.audit.series import STANDS_RAD_S, Series
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.records import NamedTuple, record, replace

_SAME: Final = 1e-12
_FINE: Final = 1e-5
"""Distance of joints, rad, up to which a place is on the path without further search."""
_NEAR_ROWS: Final = 3
"""Steps of the simulated path that a place may be off along it, besides what is tolerated in time."""


@record
class Tolerance:
    """What does not count as a difference.

    Attributes:
        joints: distance of target joints, rad.
        time_s: of durations and edges.
        share: of a duration.
    """

    joints: float = 1e-3
    time_s: float = 2 * PERIOD_S
    share: float = 0.01

    def of(self, duration_s: float) -> float:
        """Return what a duration may differ, s."""
        return max(self.time_s, self.share * duration_s)


class Motion(NamedTuple):
    """Differences within one piece; rows are those of the recorded run."""

    sum_of_squares: float
    """Of the distances from the path, rad^2, of the joint that is furthest away."""
    rows: int
    """How many were compared."""
    largest: float
    """Distance from the path of the joint that is furthest away, rad."""
    joint: int
    """That joint, from 1 on."""
    row: int
    """Where that is."""
    off_path: int | None
    """First row off the path."""
    off_time: int | None
    """First row at which the simulated arm is elsewhere at that time."""
    ends_apart: float
    """Distance of the joints in the last row, rad."""
    is_beyond: bool
    """Whether only places behind the end of the other path are off it."""
    places: tuple[tuple[int, float], ...]
    """Rows and distances of the TCP there, m, of some rows."""


_PLACES_MAX: Final = 200
"""Rows of a piece whose places are compared."""


def compare_motion(
    recorded: Series,
    begin: int,
    end: int,
    other: Series,
    its_begin: int,
    its_end: int,
    tolerance: Tolerance,
    *,
    is_disturbed: bool = False,
) -> Motion:
    """Compare the rows of a piece, first and last included.

    Args:
        recorded: one run.
        begin, end: rows of it.
        other: the simulated run, with a row for each control period.
        its_begin, its_end: rows of it.
        tolerance: what does not count.
        is_disturbed: whether something from outside stopped the arm or changed its speed: when it came is known to a
            control period, and how far the arm got before with it.
    """
    count = end - begin + 1
    every = max(1, count // _PLACES_MAX)
    if count == its_end - its_begin + 1 and all(
        column[begin : end + 1] == its[its_begin : its_end + 1] for column, its in zip(recorded.q, other.q, strict=True)
    ):
        its_rows = [(row, 0.0) for row in range(its_begin, its_end + 1, every)]
        places = _places(recorded, range(begin, end + 1, every), other, its_rows)
        return Motion(0.0, count, 0.0, 1, begin, None, None, 0.0, False, tuple(places))
    points = [*zip(*(column[begin : end + 1] for column in recorded.q), strict=True)]
    # A mark may be seen so much later in one run; what the other arm does until then belongs to the piece.
    late_s, later_s = recorded.waited_s(begin), recorded.waited_s(end)
    low = max(0, its_begin - ceil(tolerance.time_s * TICKS_PER_S))
    high = min(len(other) - 1, its_end + ceil((tolerance.time_s + later_s) * TICKS_PER_S))
    path = [*zip(*(column[low : high + 1] for column in other.q), strict=True)]
    start = its_begin - low
    joints = tolerance.joints
    if is_disturbed:
        joints += tolerance.time_s * max(max(map(abs, column[begin : end + 1])) for column in recorded.qd)
    off_time = _off_time(points, recorded, begin, path, start, replace(tolerance, joints=joints), late_s)
    nearest = _projected(points, path, start, late_s)
    squares, largest, joint, row = 0.0, 0.0, 1, begin
    off_path = None
    gone = its_length = 0.0
    for before, now in pairwise(path[start : its_end - low + 1]):
        its_length += dist(before, now)
    for place, (apart, which, *_) in enumerate(nearest):
        squares += apart * apart
        if apart > largest:
            largest, joint, row = apart, which, begin + place
        if apart > tolerance.joints and off_path is None:
            off_path = begin + place
            gone = sum(dist(before, now) for before, now in pairwise(points[: place + 1]))
    rows = range(begin, end + 1, every)
    chosen = list(rows) if row in rows else [*rows, row]
    feet = [nearest[its - begin] for its in chosen]
    places = _places(recorded, chosen, other, [(low + foot.row, foot.share) for foot in feet])
    ends_apart = _apart(points[-1], path[its_end - low])
    if off_time is not None:
        off_time += begin
    is_beyond = off_path is not None and gone >= its_length
    return Motion(squares, count, largest, joint, row, off_path, off_time, ends_apart, is_beyond, tuple(places))


class _Foot(NamedTuple):
    """The nearest place on a path."""

    apart: float
    """Distance of the joint that is furthest away, rad."""
    joint: int
    """That joint, from 1 on."""
    row: int
    """Row of the path before the place."""
    share: float
    """Where the place is on the way to the next row, 0 to 1."""


def _places(
    recorded: Series, rows: Sequence[int], other: Series, its_rows: Sequence[tuple[int, float]]
) -> list[tuple[int, float]]:
    """Return rows and how far the TCP is from the other run's, whose rows have shares of the way to the next one."""
    if recorded.places is None or other.places is None:
        return []
    x, y, z = recorded.places
    found = []
    for row, (its, share) in zip(rows, its_rows, strict=False):
        later = min(its + 1, len(other) - 1)
        place = [axis[its] + share * (axis[later] - axis[its]) for axis in other.places]
        found.append((row, dist((x[row], y[row], z[row]), place)))
    return found


def _apart(point: Sequence[float], other: Sequence[float]) -> float:
    return max([abs(a - b) for a, b in zip(point, other, strict=True)])


def _off_time(
    points: Sequence[Sequence[float]],
    recorded: Series,
    begin: int,
    path: Sequence[Sequence[float]],
    start: int,
    tolerance: Tolerance,
    late_s: float,
) -> int | None:
    """Return the place of the first point at which the other arm is not within the tolerance of that time.

    The path has a row for each control period; its row `start` is of the time of the first point.
    """
    last = len(path) - 1
    t0 = recorded.t[begin]
    for place, point in enumerate(points):
        elapsed_s = recorded.t[begin + place] - t0
        at = start + elapsed_s * TICKS_PER_S
        near = min(round(at), last)
        if _apart(point, path[near]) <= tolerance.joints:
            continue
        reach = (tolerance.of(elapsed_s) + PERIOD_S) * TICKS_PER_S
        low = min(max(0, int(at - reach)), last)
        high = min(last, int(at + reach + late_s * TICKS_PER_S))
        is_there = any(_apart(point, path[row]) <= tolerance.joints for row in range(low, high + 1))
        if not is_there and not _between(point, path, low, high, tolerance.joints):
            return place
    return None


def _between(point: Sequence[float], path: Sequence[Sequence[float]], low: int, high: int, joints: float) -> bool:
    """Return whether a point is on the path between two of its rows: a fast joint goes far in a control period."""
    return any(_apart(point, _foot(point, path[row], path[row + 1])[0]) <= joints for row in range(low, high))


def _foot(point: Sequence[float], begin: Sequence[float], end: Sequence[float]) -> tuple[Sequence[float], float]:
    """Return the nearest place on the straight line between two others, and its share of that way."""
    way = [b - a for a, b in zip(begin, end, strict=True)]
    squared = sum([step * step for step in way])
    if squared < _SAME * _SAME:
        return begin, 0.0
    share = sum([(p - a) * step for p, a, step in zip(point, begin, way, strict=True)]) / squared
    share = min(max(share, 0.0), 1.0)
    return [a + share * step for a, step in zip(begin, way, strict=True)], share


def _lengths(points: Sequence[Sequence[float]]) -> list[float]:
    found, total = [0.0], 0.0
    for before, now in pairwise(points):
        total += dist(before, now)
        found.append(total)
    return found


def _projected(
    points: Sequence[Sequence[float]], path: Sequence[Sequence[float]], start: int, late_s: float
) -> list[_Foot]:
    """Return the nearest place on the path for each point.

    It is about as far from the row `start` of the path as the point is from the first point.
    """
    rows = [0]
    for row in range(1, len(path)):
        if dist(path[row], path[rows[-1]]) > _SAME:
            rows.append(row)
    nodes = [path[row] for row in rows]
    its = _lengths(nodes)
    ahead = its[bisect_right(rows, start) - 1]
    gone = [ahead + far for far in _lengths(points)]
    step = max((b - a for a, b in pairwise(its)), default=0.0)
    found: list[_Foot] = []
    at, last = 0, len(nodes) - 1
    for point, far in zip(points, gone, strict=True):
        while at < last and its[at + 1] <= far:
            at += 1
        # Where it should be; else as far around it as the tolerance of time reaches.
        apart, where, node, share = _nearest(point, nodes, at, at)
        if apart > _FINE:
            reach = step * (_NEAR_ROWS + late_s * TICKS_PER_S) + 0.01 * (far - ahead)
            low, high = bisect_left(its, far - reach), bisect_right(its, far + reach)
            first, final = max(min(low, at) - 1, 0), min(max(high, at), last)
            apart, where, node, share = _nearest(point, nodes, first, final)
        gaps = [abs(a - b) for a, b in zip(point, where, strict=True)]
        widest = max(gaps)
        # Behind a node the path stands for as long as the rows are the same.
        row = rows[node + 1] - 1 if share and node < last else rows[node]
        found.append(_Foot(widest, gaps.index(widest) + 1, row, share))
    return found


def _nearest(
    point: Sequence[float], nodes: Sequence[Sequence[float]], low: int, high: int
) -> tuple[float, Sequence[float], int, float]:
    """Return the nearest place on the path behind the nodes `low` to `high`.

    Returns:
        its distance, the place, the node before it, and its share of the way to the next node.
    """
    best, where, found, share = inf, nodes[low], low, 0.0
    for node in range(low, high + 1):
        foot, its = (nodes[node], 0.0) if node == len(nodes) - 1 else _foot(point, nodes[node], nodes[node + 1])
        apart = dist(point, foot)
        if apart < best:
            best, where, found, share = apart, foot, node, its
    return best, where, found, share


class Profile(NamedTuple):
    """How the arm moves in a piece."""

    moving_s: float
    standing_s: float
    speed: float
    """Largest target speed of a joint, rad/s."""
    acceleration: float
    """Largest change of a target speed, rad/s^2."""
    usual_speed: float
    """Median of the largest target speed while the arm moves, rad/s; 0 if it does not."""


def profile_of(series: Series, begin: int, end: int) -> Profile:
    """Return how the arm moves from a row to another one."""
    moving_s = speed = acceleration = 0.0
    speeds: list[float] = []
    t = series.t
    for row in range(begin, end):
        step_s = t[row + 1] - t[row]
        now = max(abs(column[row]) for column in series.qd)
        later = max(abs(column[row + 1]) for column in series.qd)
        if now > STANDS_RAD_S or later > STANDS_RAD_S:
            moving_s += step_s
            speeds.append(now)
        speed = max(speed, now, later)
        if 0.0 < step_s < 1.5 * PERIOD_S:
            acceleration = max(acceleration, max(abs(column[row + 1] - column[row]) for column in series.qd) / step_s)
    return Profile(moving_s, t[end] - t[begin] - moving_s, speed, acceleration, median(speeds) if speeds else 0.0)


def root_mean_square(sum_of_squares: float, count: int) -> float:
    """Return the square root of a mean of squares; 0 of nothing."""
    return sqrt(sum_of_squares / count) if count else 0.0
