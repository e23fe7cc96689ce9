"""The time law of a path on which joint limits bind in places.

With the path speed squared x = s'^2 and the path acceleration u = s'', a joint has the speed
q' sqrt(x) and the acceleration q' u + q'' x, where primes of q are derivatives by s. The method
is the usual one of time-optimal path parametrisation on a grid (Bobrow, Dubowsky and Gibson
1985; Pham and Pham 2018): a bound for x at each grid point, a pass from the end backwards that
lowers x so far that every bound ahead can be reached by braking, a pass forwards that
accelerates as much as allowed. Between grid points u is constant.

The acceleration limit is used in the form |q'| |u| + |q''| x <= qdd_max, which holds for either
direction of u. It is somewhat stricter than necessary and makes both passes free of dead ends: a
lower speed always allows all that a higher one does.

Only places are slowed down where a limit binds. Intervals of the track in which no joint can reach
its limits under the wanted trapezoid are *free*: there the profile is a trapezoid itself, and
when all are free it is exactly the wanted one.
"""

from __future__ import annotations

from bisect import insort
from collections.abc import Sequence
from math import ceil, inf, sqrt
from typing import Final

from elitescript.messages.state import ZERO_SIX
from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.track import JointTrack
from elitescript.motion.timing.profile import Law, TimeLaw, trapezoid_of
from elitescript.records import NamedTuple

SUBDIVISION: Final = 6
"""Parts of an interval of the joint track that is not free; the slopes there come from its cubic
interpolation."""

PARTS_MIN: Final = 48
"""Least number of parts of a path without free intervals, for accurate corners of the speed on short
paths too."""

SPEED_MARGIN: Final = 0.998
"""Share of the joint speed limits that is used, as a reserve between grid points."""

ACCELERATION_MARGIN: Final = 0.99
"""The same for acceleration limits."""

CURVATURE_SHARE: Final = 0.8
"""Share of the joint acceleration limits that the bending of the path may use. The rest is for
speeding up and slowing down where the path bends most."""


class SlowPlace(NamedTuple):
    """Place at which a retimed move is slowed down most."""

    s: float
    speed: float
    speed_wanted: float
    joint: int
    """Index of the joint that is nearest to a limit there."""


class Retimed(NamedTuple):
    """A profile within the joint limits."""

    profile: TimeLaw
    slow_place: SlowPlace | None
    """None when the wanted profile was kept."""


def retimed(track: JointTrack, limits: MotionLimits, wanted: TimeLaw, law: Law | None = None) -> Retimed:
    """Return the profile that is nowhere quicker than a wanted trapezoid and keeps the joint limits.

    When no joint limit binds this is the wanted profile itself.

    Args:
        track: the path.
        limits: limits of the arm.
        wanted: a trapezoid from standstill.
        law: of the trapezoid, where its ramps differ.
    """
    if law is None:
        a = wanted.acceleration(0.0)
        law = Law(wanted.peak_speed, a, a)
    law = law._replace(v=wanted.peak_speed)
    grid = _grid(track, wanted, law)
    if grid.is_free:
        return Retimed(wanted, None)
    x = _passed(grid, limits, law, 0.0)
    assert x is not None
    profile = _profile(grid, x, law)
    if profile.duration_s <= wanted.duration_s * (1.0 + _SAME_DURATION):
        return Retimed(wanted, None)
    return Retimed(profile, _slow_place(grid, x, limits, wanted))


def entered(track: JointTrack, limits: MotionLimits, law: Law, start: float, v_start: float) -> TimeLaw | None:
    """Return the quickest profile within law and joint limits from a position and a speed on.

    None when that is too fast there, or too fast for what comes.
    """
    way = track.length - start
    if way <= 0.0 or v_start > law.v or v_start * v_start > 2.0 * law.brake * way:
        return None
    wanted = trapezoid_of(track.length, law, start, v_start)
    law = law._replace(v=wanted.peak_speed)
    grid = _grid(track, wanted, law)
    if grid.is_free:
        return wanted
    x = _passed(grid, limits, law, v_start * v_start)
    if x is None:
        return None
    profile = _profile(grid, x, law)
    return wanted if profile.duration_s <= wanted.duration_s * (1.0 + _SAME_DURATION) else profile


def keeps_limits(track: JointTrack, limits: MotionLimits, wanted: TimeLaw) -> bool:
    """Return whether every joint stays within its speed and acceleration limits under a trapezoid."""
    a = wanted.acceleration(0.0)
    first_corner, last_corner = wanted.corners[0], wanted.corners[-1]
    grid = _grid(track, wanted, Law(wanted.peak_speed, a, a))
    for s, slopes, curvatures in zip(grid.s, grid.slopes, grid.curvatures, strict=True):
        speed = wanted.speed_at_position(s)
        u = 0.0 if first_corner < s < last_corner else a
        for slope, curvature, qd_max, qdd_max in zip(slopes, curvatures, limits.qd_max, limits.qdd_max, strict=True):
            if slope * speed > qd_max or slope * u + curvature * speed * speed > qdd_max:
                return False
    return True


_SAME_DURATION: Final = 1e-9
"""Relative difference up to which two durations differ by rounding."""

_CLOSEST: Final = 1e-6
"""Least distance of grid points, as a share of the path; nearer ones would only add rounding."""


class _Grid:
    """The grid of the passes, as columns: one value for each point."""

    __slots__ = ("curvatures", "is_free_ahead", "s", "slopes")

    def __init__(self) -> None:
        self.s: list[float] = []
        self.slopes: list[Sequence[float]] = []
        """|q'| of each joint; zeros between free intervals."""
        self.curvatures: list[Sequence[float]] = []
        """|q''| of each joint; zeros between free intervals."""
        self.is_free_ahead: list[bool] = []
        """Whether no joint can reach its limits on the way to the next grid point."""

    def add(self, s: float, slopes: Sequence[float], curvatures: Sequence[float], is_free_ahead: bool) -> None:
        self.s.append(s)
        self.slopes.append(slopes)
        self.curvatures.append(curvatures)
        self.is_free_ahead.append(is_free_ahead)

    @property
    def is_free(self) -> bool:
        """Whether no joint can reach its limits anywhere."""
        return len(self.s) == 2 and self.is_free_ahead[0]


def _grid(track: JointTrack, wanted: TimeLaw, law: Law) -> _Grid:
    """Return the grid of the passes: free intervals joined, the others subdivided.

    Inside an interval the joints are taken as the cubic through angles and slopes of its ends.
    The corners of the wanted profile are grid points too, so that it is kept exactly where possible.
    """
    v, a = law.v, max(law.a, law.brake)
    length, start = track.length, wanted.start
    closest = _CLOSEST * length
    grid = _Grid()
    was_free = False
    slopes_here: Sequence[float] = ZERO_SIX
    curvatures_here: Sequence[float] = ZERO_SIX
    for k, (speed_ratio, acceleration_ratio, curvature_ratio) in enumerate(track.interval_ratios):
        s_a, s_b = track.grid_s[k], track.grid_s[k + 1]
        if s_b <= start + closest:
            continue
        s_first = max(s_a, start)
        if speed_ratio * v <= 1.0 and acceleration_ratio * a + curvature_ratio * v * v <= 1.0:
            if not was_free:
                grid.add(s_first, slopes_here, curvatures_here, True)
                slopes_here = curvatures_here = ZERO_SIX
            was_free = True
            continue
        h = s_b - s_a
        parts = max(SUBDIVISION, ceil(PARTS_MIN * h / length))
        positions = [s_first + (s_b - s_first) * part / parts for part in range(parts)]
        for corner in wanted.corners:
            if s_first < corner < s_b and all(abs(corner - s) > closest for s in (*positions, s_b)):
                insort(positions, corner)
        slopes, curvatures = _bent(track, k, [(s - s_a) / h for s in positions] + [1.0])
        # The cubics of two intervals bend differently where they meet; the larger bend counts.
        curvatures[0] = tuple(map(max, curvatures[0], curvatures_here))
        slopes_here, curvatures_here = slopes.pop(), curvatures.pop()
        grid.s += positions
        grid.slopes += slopes
        grid.curvatures += curvatures
        grid.is_free_ahead += [False] * len(positions)
        was_free = False
    grid.add(length, slopes_here, curvatures_here, False)
    return grid


def _bent(
    track: JointTrack, k: int, fractions: Sequence[float]
) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
    """Return |q'| and |q''| of the joints at fractions of an interval of a track."""
    h = track.grid_s[k + 1] - track.grid_s[k]
    ways = [(f, f * (1.0 - f), 1.0 - 2.0 * f) for f in fractions]
    slopes: list[list[float]] = []
    curvatures: list[list[float]] = []
    for qa, qb, da, db in zip(
        track.grid_q[k], track.grid_q[k + 1], track.grid_slope[k], track.grid_slope[k + 1], strict=True
    ):
        change = db - da
        bow = 6.0 * (qb - qa) / h - 3.0 * (da + db)
        slopes.append([abs(da + change * f + bow * bend) for f, bend, _ in ways])
        curvatures.append([abs(change + bow * turn) / h for _, _, turn in ways])
    return list(zip(*slopes, strict=True)), list(zip(*curvatures, strict=True))


def _bounds(grid: _Grid, limits: MotionLimits) -> list[float]:
    """Return the largest x that speed limits and the bending of the path allow at each grid point."""
    tops = [
        (SPEED_MARGIN * qd_max, (SPEED_MARGIN * qd_max) ** 2, CURVATURE_SHARE * qdd_max)
        for qd_max, qdd_max in zip(limits.qd_max, limits.qdd_max, strict=True)
    ]
    bounds = []
    for slopes, curvatures in zip(grid.slopes, grid.curvatures, strict=True):
        bound = inf
        for slope, curvature, (top, top_square, bend_top) in zip(slopes, curvatures, tops, strict=True):
            if slope * slope * bound > top_square:
                bound = (top / slope) ** 2
            if curvature * bound > bend_top:
                bound = bend_top / curvature
        bounds.append(bound)
    return bounds


def _passed(grid: _Grid, limits: MotionLimits, law: Law, x_start: float) -> list[float] | None:
    """Return x at the grid points after the pass backwards and the pass forwards; None when x_start is too much.

    A point that is no faster than its neighbour can always be reached: bending takes `CURVATURE_SHARE` of the joint
    accelerations at most, which is less than `ACCELERATION_MARGIN`.
    """
    x_max = law.v * law.v
    allowed = [ACCELERATION_MARGIN * qdd_max for qdd_max in limits.qdd_max]
    x = [min(x_max, bound) for bound in _bounds(grid, limits)]
    x[-1] = 0.0
    for here in range(len(x) - 2, -1, -1):
        if x[here] > x[here + 1]:
            x[here] = min(x[here], _reachable(grid, here, here + 1, x[here + 1], allowed, law.brake))
    if x_start > x[0] * (1.0 + _SAME_DURATION):
        return None
    x[0] = x_start
    for here in range(1, len(x)):
        if x[here] > x[here - 1]:
            x[here] = min(x[here], _reachable(grid, here, here - 1, x[here - 1], allowed, law.a))
    return x


def _reachable(grid: _Grid, here: int, there: int, x_there: float, allowed: Sequence[float], a: float) -> float:
    """Return the largest x at a point from which, or to which, the x of its neighbour can be changed."""
    way = 2.0 * abs(grid.s[there] - grid.s[here])
    reachable = x_there + way * a
    if grid.is_free_ahead[min(here, there)]:
        return reachable
    for slope, curvature, slope_there, curvature_there, most in zip(
        grid.slopes[here], grid.curvatures[here], grid.slopes[there], grid.curvatures[there], allowed, strict=True
    ):
        room = slope + way * curvature
        gained = slope * x_there + way * most
        if room * reachable > gained:
            reachable = gained / room
        left = way * (most - curvature_there * x_there)
        if slope_there * (reachable - x_there) > left:
            reachable = x_there + left / slope_there
    return reachable


def _profile(grid: _Grid, x: list[float], law: Law) -> TimeLaw:
    """Return the profile through x at the grid points: constant acceleration, or a trapezoid where it is free."""
    start_s: list[float] = []
    positions: list[float] = []
    speeds: list[float] = []
    accelerations: list[float] = []
    t_s = 0.0
    x_max, a, brake = law.v * law.v, law.a, law.brake
    share = brake / (a + brake)
    pieces: tuple[tuple[float, float, float, float], ...]
    for s_here, s_ahead, is_free, x_here, x_ahead in zip(
        grid.s, grid.s[1:], grid.is_free_ahead, x, x[1:], strict=False
    ):
        h = s_ahead - s_here
        if is_free:
            x_top = min(x_max, share * x_here + (1.0 - share) * x_ahead + a * (2.0 * share) * h)
            rise = (x_top - x_here) / (2.0 * a)
            fall = (x_top - x_ahead) / (2.0 * brake)
            pieces = (
                (s_here, x_here, a, rise),
                (s_here + rise, x_top, 0.0, h - rise - fall),
                (s_ahead - fall, x_top, -brake, fall),
            )
        else:
            pieces = ((s_here, x_here, (x_ahead - x_here) / (2.0 * h), h),)
        for s, x_piece, u, way in pieces:
            if way <= _NO_WAY * h:
                continue
            speed = sqrt(x_piece)
            start_s.append(t_s)
            positions.append(s)
            speeds.append(speed)
            accelerations.append(u)
            t_s += 2.0 * way / (speed + sqrt(max(0.0, x_piece + 2.0 * u * way)))
    return TimeLaw(grid.s[-1], t_s, start_s, positions, speeds, accelerations)


_NO_WAY: Final = 1e-12
"""Share of its stretch below which a piece is rounding."""


def _slow_place(grid: _Grid, x: list[float], limits: MotionLimits, wanted: TimeLaw) -> SlowPlace:
    """Return the point that is passed most slowly against the wanted profile."""
    slowest, least = 1, inf
    for k in range(1, len(x) - 1):
        speed_wanted = wanted.speed_at_position(grid.s[k])
        if x[k] < least * speed_wanted * speed_wanted:
            slowest, least = k, x[k] / (speed_wanted * speed_wanted)
    s, speed = grid.s[slowest], sqrt(x[slowest])
    u = abs(x[slowest + 1] - x[slowest]) / (2.0 * (grid.s[slowest + 1] - s))
    shares = [
        max(slope * speed / qd_max, (slope * u + curvature * speed * speed) / qdd_max)
        for slope, curvature, qd_max, qdd_max in zip(
            grid.slopes[slowest], grid.curvatures[slowest], limits.qd_max, limits.qdd_max, strict=True
        )
    ]
    return SlowPlace(s, speed, wanted.speed_at_position(s), shares.index(max(shares)))
