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
    if len(grid) == 2 and grid[0].is_free_ahead:
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
    if len(grid) == 2 and grid[0].is_free_ahead:
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
    for point in _grid(track, wanted, Law(wanted.peak_speed, a, a)):
        speed = wanted.speed_at_position(point.s)
        u = 0.0 if first_corner < point.s < last_corner else a
        for slope, curvature, qd_max, qdd_max in zip(
            point.slope, point.curvature, limits.qd_max, limits.qdd_max, strict=True
        ):
            if slope * speed > qd_max or slope * u + curvature * speed * speed > qdd_max:
                return False
    return True


_SAME_DURATION: Final = 1e-9
"""Relative difference up to which two durations differ by rounding."""

_CLOSEST: Final = 1e-6
"""Least distance of grid points, as a share of the path; nearer ones would only add rounding."""


class GridPoint(NamedTuple):
    """A point of the grid of the passes."""

    s: float
    slope: tuple[float, ...]
    """|q'| of each joint; zeros between free intervals."""
    curvature: tuple[float, ...]
    """|q''| of each joint; zeros between free intervals."""
    is_free_ahead: bool
    """Whether no joint can reach its limits on the way to the next grid point."""


def _grid(track: JointTrack, wanted: TimeLaw, law: Law) -> list[GridPoint]:
    """Return the grid of the passes: free intervals joined, the others subdivided.

    Inside an interval the joints are taken as the cubic through angles and slopes of its ends.
    The corners of the wanted profile are grid points too, so that it is kept exactly where possible.
    """
    v, a = law.v, max(law.a, law.brake)
    length, start = track.length, wanted.start
    closest = _CLOSEST * length
    grid: list[GridPoint] = []
    was_free = False
    slope: tuple[float, ...] = ZERO_SIX
    curvature: tuple[float, ...] = ZERO_SIX
    for k, (speed_ratio, acceleration_ratio, curvature_ratio) in enumerate(track.interval_ratios):
        s_a, s_b = track.grid_s[k], track.grid_s[k + 1]
        if s_b <= start + closest:
            continue
        s_first = max(s_a, start)
        if speed_ratio * v <= 1.0 and acceleration_ratio * a + curvature_ratio * v * v <= 1.0:
            if not was_free:
                grid.append(GridPoint(s_first, slope, curvature, True))
                slope = curvature = ZERO_SIX
            was_free = True
            continue
        h = s_b - s_a
        parts = max(SUBDIVISION, ceil(PARTS_MIN * h / length))
        positions = [s_first + (s_b - s_first) * part / parts for part in range(parts)]
        for corner in wanted.corners:
            if s_first < corner < s_b and all(abs(corner - s) > closest for s in (*positions, s_b)):
                insort(positions, corner)
        cubic = _Cubic(track, k)
        at_start = cubic.slope_and_curvature((s_first - s_a) / h)
        # The cubics of two intervals bend differently where they meet; the larger bend counts.
        grid.append(GridPoint(s_first, at_start[0], tuple(map(max, at_start[1], curvature)), False))
        grid += [GridPoint(s, *cubic.slope_and_curvature((s - s_a) / h), False) for s in positions[1:]]
        slope, curvature = cubic.slope_and_curvature(1.0)
        was_free = False
    grid.append(GridPoint(length, slope, curvature, False))
    return grid


class _Cubic:
    """Joints inside one interval of a track."""

    __slots__ = ("_bows", "_h", "_slope_a", "_slope_change")

    def __init__(self, track: JointTrack, k: int) -> None:
        h = track.grid_s[k + 1] - track.grid_s[k]
        slope_a, slope_b = track.grid_slope[k], track.grid_slope[k + 1]
        self._h = h
        self._slope_a = slope_a
        self._slope_change = [b - a for a, b in zip(slope_a, slope_b, strict=True)]
        self._bows = [
            6.0 * (qb - qa) / h - 3.0 * (da + db)
            for qa, qb, da, db in zip(track.grid_q[k], track.grid_q[k + 1], slope_a, slope_b, strict=True)
        ]

    def slope_and_curvature(self, f: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return |q'| and |q''| of the joints at a fraction of the interval."""
        bend, turn = f * (1.0 - f), 1.0 - 2.0 * f
        slope = [
            abs(start + change * f + bow * bend)
            for start, change, bow in zip(self._slope_a, self._slope_change, self._bows, strict=True)
        ]
        curvature = [
            abs(change + bow * turn) / self._h for change, bow in zip(self._slope_change, self._bows, strict=True)
        ]
        return tuple(slope), tuple(curvature)


def _bound(point: GridPoint, limits: MotionLimits) -> float:
    """Return the largest x that speed limits and the bending of the path allow."""
    bound = inf
    for slope, curvature, qd_max, qdd_max in zip(
        point.slope, point.curvature, limits.qd_max, limits.qdd_max, strict=True
    ):
        if slope * slope * bound > (SPEED_MARGIN * qd_max) ** 2:
            bound = (SPEED_MARGIN * qd_max / slope) ** 2
        if curvature * bound > CURVATURE_SHARE * qdd_max:
            bound = CURVATURE_SHARE * qdd_max / curvature
    return bound


def _passed(grid: list[GridPoint], limits: MotionLimits, law: Law, x_start: float) -> list[float] | None:
    """Return x at the grid points after the pass backwards and the pass forwards; None when x_start is too much."""
    x_max = law.v * law.v
    x = [min(x_max, _bound(point, limits)) for point in grid]
    x[-1] = 0.0
    for here in range(len(x) - 2, -1, -1):
        is_free = grid[here].is_free_ahead
        x[here] = min(x[here], _reachable(grid[here], grid[here + 1], x[here + 1], is_free, limits, law.brake))
    if x_start > x[0] * (1.0 + _SAME_DURATION):
        return None
    x[0] = x_start
    for here in range(1, len(x)):
        is_free = grid[here - 1].is_free_ahead
        x[here] = min(x[here], _reachable(grid[here], grid[here - 1], x[here - 1], is_free, limits, law.a))
    return x


def _reachable(
    point: GridPoint, neighbour: GridPoint, x_neighbour: float, is_free: bool, limits: MotionLimits, a: float
) -> float:
    """Return the largest x from which, or to which, the neighbour's x can be changed on the way between."""
    way = 2.0 * abs(neighbour.s - point.s)
    reachable = x_neighbour + way * a
    if is_free:
        return reachable
    for slope, curvature, slope_there, curvature_there, qdd_max in zip(
        point.slope, point.curvature, neighbour.slope, neighbour.curvature, limits.qdd_max, strict=True
    ):
        allowed = ACCELERATION_MARGIN * qdd_max
        room = slope + way * curvature
        if room * reachable > slope * x_neighbour + way * allowed:
            reachable = (slope * x_neighbour + way * allowed) / room
        if slope_there * (reachable - x_neighbour) > way * (allowed - curvature_there * x_neighbour):
            reachable = x_neighbour + way * (allowed - curvature_there * x_neighbour) / slope_there
    return reachable


def _profile(grid: list[GridPoint], x: list[float], law: Law) -> TimeLaw:
    """Return the profile through x at the grid points: constant acceleration, or a trapezoid where it is free."""
    start_s: list[float] = []
    positions: list[float] = []
    speeds: list[float] = []
    accelerations: list[float] = []
    t_s = 0.0
    x_max, a, brake = law.v * law.v, law.a, law.brake
    share = brake / (a + brake)
    pieces: tuple[tuple[float, float, float, float], ...]
    for here, ahead, x_here, x_ahead in zip(grid, grid[1:], x, x[1:], strict=False):
        h = ahead.s - here.s
        if here.is_free_ahead:
            x_top = min(x_max, share * x_here + (1.0 - share) * x_ahead + a * (2.0 * share) * h)
            rise = (x_top - x_here) / (2.0 * a)
            fall = (x_top - x_ahead) / (2.0 * brake)
            pieces = (
                (here.s, x_here, a, rise),
                (here.s + rise, x_top, 0.0, h - rise - fall),
                (ahead.s - fall, x_top, -brake, fall),
            )
        else:
            pieces = ((here.s, x_here, (x_ahead - x_here) / (2.0 * h), h),)
        for s, x_piece, u, way in pieces:
            if way <= _NO_WAY * h:
                continue
            speed = sqrt(x_piece)
            start_s.append(t_s)
            positions.append(s)
            speeds.append(speed)
            accelerations.append(u)
            t_s += 2.0 * way / (speed + sqrt(max(0.0, x_piece + 2.0 * u * way)))
    return TimeLaw(grid[-1].s, t_s, start_s, positions, speeds, accelerations)


_NO_WAY: Final = 1e-12
"""Share of its stretch below which a piece is rounding."""


def _slow_place(grid: list[GridPoint], x: list[float], limits: MotionLimits, wanted: TimeLaw) -> SlowPlace:
    """Return the point that is passed most slowly against the wanted profile."""
    slowest, least = 1, inf
    for k in range(1, len(grid) - 1):
        speed_wanted = wanted.speed_at_position(grid[k].s)
        if x[k] < least * speed_wanted * speed_wanted:
            slowest, least = k, x[k] / (speed_wanted * speed_wanted)
    point = grid[slowest]
    speed = sqrt(x[slowest])
    u = abs(x[slowest + 1] - x[slowest]) / (2.0 * (grid[slowest + 1].s - point.s))
    shares = [
        max(slope * speed / qd_max, (slope * u + curvature * speed * speed) / qdd_max)
        for slope, curvature, qd_max, qdd_max in zip(
            point.slope, point.curvature, limits.qd_max, limits.qdd_max, strict=True
        )
    ]
    return SlowPlace(point.s, speed, wanted.speed_at_position(point.s), shares.index(max(shares)))
