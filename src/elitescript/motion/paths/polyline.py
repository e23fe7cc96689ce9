"""Chains of straight lines with rounded corners that grow while the arm moves along them: `movep`.

The path position is the length of the polyline itself. Within d of a corner the path is the parabola that touches
both lines (`corner`); it takes 2 d of path position, as much as it replaces, so that position and slope are continuous
under any time law. With u1 and u2 the directions before and behind, the path bends there by |u2 - u1| / (2 d) per unit
of path position.

d is the larger of the blend radius and the d that keeps the speed at the corner, as long as the path passes the corner
within `DEVIATION_M`; and never more than half of either line.

The time law: in every interval of the path the speed squared x has a bound, from commanded speed, bending and joint
limits, and the acceleration along the path has one, so that both together keep the limits. A pass backwards from the
known end ensures that the arm can always stop there; a pass forwards from its position accelerates as much as allowed.
Later lines can only raise the speeds ahead. All of this is *assumed*: the command is in no manual.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import dist, hypot, inf, sqrt
from typing import Final

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.cartesian import LinePath
from elitescript.motion.paths.corner import Corner
from elitescript.motion.paths.track import JointTrack, follow
from elitescript.motion.segment import RunningSegment, added
from elitescript.motion.timing.profile import Law, TimeLaw
from elitescript.records import NamedTuple

DEVIATION_M: Final = 1e-4
"""Largest distance of the path from a corner without a blend radius."""

CORNER_MIN_M: Final = 2e-5
"""Smallest wanted d of a corner."""

CORNER_LEAST_M: Final = 1e-6
"""Smallest d of a corner, between lines that are no longer than that; below it the arm stops."""

NO_BEND: Final = 1e-9
"""Difference below which two directions are one."""

BEND_SHARE: Final = 0.8
"""Share of tool and joint accelerations that the bending of the path may use; the rest is for speeding up and
braking."""

SMOOTH_SHARE: Final = 0.2
"""Share of the tool acceleration that bending should use, where a larger corner can bring it so low: then nearly all
of it is left for speeding up and braking on a curve of short lines."""

LIMIT_SHARE: Final = 0.98
"""Share of joint limits that is used, as a reserve between the points of the grid."""

LINKS_MAX: Final = 500
"""Largest number of lines known ahead of the arm."""

FEED_MARGIN_S: Final = 0.020
"""Lead of the request for the next line before the arm would have to brake, or to leave the line for a corner."""


class ChainLine(NamedTuple):
    """One requested line of the chain, solved."""

    track: JointTrack
    """The whole line, from waypoint to waypoint."""
    law: Law
    r: float
    """Blend radius at its end, m."""

    @property
    def line(self) -> LinePath:
        """The geometry."""
        path = self.track.path
        assert isinstance(path, LinePath)
        return path


class Interval(NamedTuple):
    """A part of the path with one set of bounds."""

    start: float
    """Path position of the chain."""
    length: float
    x_max: float
    """Bound of the path speed squared."""
    a: float
    """Bound of the path acceleration, for speeding up and for braking."""
    x_start_max: float
    """Bound of the speed squared at its start: 0 where the arm must stop."""
    bend: float = 0.0
    """Part of `a` that the bending of the path takes per unit of the speed squared."""


class ChainStretch(NamedTuple):
    """A part of the path on one joint track."""

    start: float
    """Path position of the chain."""
    end: float
    track: JointTrack
    offset: float
    """Path position of the track at the start."""
    intervals: tuple[Interval, ...]


class ChainPath:
    """The known path, from a place behind the arm on; immutable. A `JointPath`."""

    __slots__ = ("_starts", "length", "link_start", "links", "stretches")

    kind = "chain"
    unit = "m"

    def __init__(
        self, stretches: Sequence[ChainStretch], links: Sequence[ChainLine], link_start: Sequence[float]
    ) -> None:
        """Take the stretches in order, and the lines with the path position of each."""
        self.stretches = tuple(stretches)
        self.links = tuple(links)
        self.link_start = tuple(link_start)
        self._starts = [stretch.start for stretch in stretches]
        self.length = stretches[-1].end

    @property
    def q_start(self) -> Six:
        return self.stretches[0].track.q(self.stretches[0].offset)

    @property
    def q_end(self) -> Six:
        return self.links[-1].track.q_end

    @property
    def T_base_tcp_end(self) -> Transform:
        return self.links[-1].track.T_base_tcp_end

    def q(self, s: float) -> Six:
        if s >= self.length:
            return self.q_end
        stretch = self._at(s)
        return stretch.track.q(s - stretch.start + stretch.offset)

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        stretch = self._at(s)
        return stretch.track.q_and_slope(s - stretch.start + stretch.offset)

    def turned(self, begin: float, end: float) -> Six:
        total = ZERO_SIX
        for stretch in self.stretches[max(0, bisect_right(self._starts, begin) - 1) :]:
            if stretch.start >= end:
                break
            shift = stretch.offset - stretch.start
            first, last = max(begin, stretch.start) + shift, min(end, stretch.end) + shift
            if first < last:
                total = added(total, stretch.track.turned(first, last))
        return total

    @property
    def course(self) -> None:
        """Not kept: the chain grows."""
        return

    def tool_rates(self, s: float) -> tuple[float, float]:
        stretch = self._at(s)
        return stretch.track.tool_rates(s - stretch.start + stretch.offset)

    def _at(self, s: float) -> ChainStretch:
        return self.stretches[max(0, bisect_right(self._starts, s) - 1)]


class Chained(NamedTuple):
    """A chain as known at a moment."""

    segment: RunningSegment
    path: ChainPath
    feed_s: float
    """Time of the segment at which the next line should be known."""


def begun(link: ChainLine) -> Chained:
    """Return a chain of one line, from standstill."""
    stretch = _straight(link, 0.0, 0.0, link.track.length, True)
    path = ChainPath((stretch,), (link,), (0.0,))
    profile = _profile(path, 0.0, 0.0)
    assert profile is not None
    return _chained(path, profile)


def extended(
    arm: Arm,
    limits: MotionLimits,
    chain: ChainPath,
    position: float,
    speed: float,
    link: ChainLine,
    T_flange_tcp: Transform,
) -> Chained:
    """Return a chain with one more line, as the arm goes on from a position and a speed.

    Args:
        arm: the arm.
        limits: its limits.
        chain: as it was known.
        position: path position of the arm.
        speed: its path speed at full speed percentage.
        link: the new line, from the end of the chain on.
        T_flange_tcp: TCP offset of all.
    """
    last = chain.links[-1]
    bend = _bend(last, link, limits.equivalent_radius_m)
    room = min(0.5 * last.track.length, 0.5 * link.track.length, chain.length - position)
    d = min(_corner_size(last, link, bend), room)
    stretches = [stretch for stretch in chain.stretches if stretch.end > position or stretch is chain.stretches[-1]]
    first = next((k for k, start in enumerate(chain.link_start[1:]) if start > position), len(chain.links) - 1)
    links = (*chain.links[first:], link)
    link_start = (*chain.link_start[first:], chain.length)
    while True:
        has_corner = bend >= NO_BEND and d >= CORNER_LEAST_M and bend < inf
        added = _corner(arm, limits, chain, last, link, d, bend, T_flange_tcp) if has_corner else None
        is_straight = bend < NO_BEND
        if added is not None:
            path = ChainPath((*stretches[:-1], *_cut(stretches[-1], chain.length - d), *added), links, link_start)
        else:
            path = ChainPath(
                (*stretches, _straight(link, chain.length, 0.0, link.track.length, not is_straight)), links, link_start
            )
        profile = _profile(path, position, speed * speed)
        if profile is not None:
            return _chained(path, profile)
        if not has_corner:
            # The arm was to stop here before, so it is too fast for it only by rounding.
            profile = _profile(path, position, speed * speed, is_checked=False)
            assert profile is not None
            return _chained(path, profile)
        d *= 0.5


def _chained(path: ChainPath, profile: TimeLaw) -> Chained:
    last = path.links[-1]
    v, a, _ = last.law
    # The largest corner to a next line of any direction; or the way to brake from full speed.
    largest = max(last.r, sqrt(4.0 * DEVIATION_M * v * v / (2.0 * SMOOTH_SHARE * a)))
    reserve = max(min(0.5 * last.track.length, largest), 0.5 * v * v / a)
    feed_s = min(profile.last_brake_s, profile.time_at(path.length - reserve)) - FEED_MARGIN_S
    if len(path.links) >= LINKS_MAX:
        feed_s = max(feed_s, profile.time_at(path.link_start[len(path.links) - LINKS_MAX + 1]))
    return Chained(RunningSegment(path, profile), path, feed_s)


def _bend(last: ChainLine, link: ChainLine, equivalent_radius_m: float) -> float:
    """Return how much the direction changes, with the rate of rotation counted as way; inf where units differ."""
    if last.track.unit != link.track.unit:
        return inf
    one, other = last.line, link.line
    turning = dist(one.rotation_slope, other.rotation_slope) * equivalent_radius_m
    if one.unit == "rad":
        return 0.0 if turning < NO_BEND else inf
    return hypot(dist(one.point_slope(0.0), other.point_slope(0.0)), turning)


def _corner_size(last: ChainLine, link: ChainLine, bend: float) -> float:
    """Return the wanted d of a corner."""
    if bend < NO_BEND or bend == inf:
        return 0.0
    v, a = min(last.law.v, link.law.v), min(last.law.a, link.law.a)
    keeps_speed = 0.5 * v * v * bend / (SMOOTH_SHARE * a)
    return max(last.r, CORNER_MIN_M, min(keeps_speed, 4.0 * DEVIATION_M / bend))


def _straight(link: ChainLine, start: float, begin: float, end: float, stops_at_start: bool) -> ChainStretch:
    """Return the part of a line between two of its own positions; `start` is the chain's position of the first."""
    intervals = _intervals(link.track, start, begin, end, link.law.v * link.law.v, link.law.a)
    if stops_at_start:
        intervals[0] = intervals[0]._replace(x_start_max=0.0)
    return ChainStretch(start, start + end - begin, link.track, begin, tuple(intervals))


def _intervals(
    track: JointTrack, start: float, begin: float, end: float, x_top: float, a: float, curvature: float = 0.0
) -> list[Interval]:
    """Return the bounds along a part of a track; neighbours of the same bounds are one interval.

    Args:
        track: joints.
        start: the chain's position of the first.
        begin: of the part, on the track.
        end: of the part, on the track.
        x_top: bound of the path speed squared without the joints.
        a: the same of the acceleration.
        curvature: by how much the path bends per unit of path position.
    """
    found: list[Interval] = []
    grid_s, x_before, a_before = track.grid_s, -1.0, -1.0
    for k, ratios in enumerate(track.interval_ratios):
        s_a, s_b = max(grid_s[k], begin), min(grid_s[k + 1], end)
        if s_b > s_a:
            x_max, most = _bounded(x_top, a, ratios)
            first, length = start + s_a - begin, s_b - s_a
            if x_max == x_before and most == a_before:
                length = first + length - found[-1].start
                first = found.pop().start
            found.append(Interval(first, length, x_max, most, inf, curvature * most / a))
            x_before, a_before = x_max, most
    return found


def _cut(stretch: ChainStretch, end: float) -> tuple[ChainStretch, ...]:
    """Return the rest of a stretch that now ends sooner; none when nothing is left."""
    if end - stretch.start <= _ROUNDING_M:
        return ()
    intervals = [interval for interval in stretch.intervals if interval.start < end - _ROUNDING_M]
    for k, interval in enumerate(intervals):
        if interval.length > end - interval.start:
            intervals[k] = interval._replace(length=end - interval.start)
    return (ChainStretch(stretch.start, end, stretch.track, stretch.offset, tuple(intervals)),)


def _corner(
    arm: Arm,
    limits: MotionLimits,
    chain: ChainPath,
    last: ChainLine,
    link: ChainLine,
    d: float,
    bend: float,
    T_flange_tcp: Transform,
) -> tuple[ChainStretch, ...] | None:
    """Return the corner and the line behind it; None when the arm cannot follow it."""
    corner = Corner(last.line, link.line, d, d, 2.0 * d, "m", T_flange_tcp)
    v, a = min(last.law.v, link.law.v), min(last.law.a, link.law.a)
    try:
        track = follow(arm, limits, corner, last.track.q(last.track.length - d), v, a)
    except MotionError:
        return None
    start = chain.length - d
    # Bending by |u2 - u1| / (2 d) takes that times the speed squared of the acceleration.
    curvature = 0.5 * bend / d
    x_tool = min(v * v, BEND_SHARE * a / curvature)
    intervals = _intervals(track, start, 0.0, 2.0 * d, x_tool, a, curvature)
    round_it = ChainStretch(start, start + 2.0 * d, track, 0.0, tuple(intervals))
    if link.track.length - d <= _ROUNDING_M:
        return (round_it,)
    return round_it, _straight(link, start + 2.0 * d, d, link.track.length, False)


def _bounded(x_max: float, a: float, ratios: tuple[float, float, float]) -> tuple[float, float]:
    """Return bounds of speed squared and acceleration that keep the joint limits too."""
    speed_ratio, acceleration_ratio, curvature_ratio = ratios
    if speed_ratio * speed_ratio * x_max > LIMIT_SHARE * LIMIT_SHARE:
        x_max = (LIMIT_SHARE / speed_ratio) ** 2
    if acceleration_ratio * a + curvature_ratio * x_max > LIMIT_SHARE:
        if curvature_ratio * x_max > BEND_SHARE * LIMIT_SHARE:
            x_max = BEND_SHARE * LIMIT_SHARE / curvature_ratio
        if acceleration_ratio * a > LIMIT_SHARE - curvature_ratio * x_max:
            a = (LIMIT_SHARE - curvature_ratio * x_max) / acceleration_ratio
    return x_max, a


_ROUNDING_M: Final = 1e-12


def _profile(path: ChainPath, position: float, x_start: float, *, is_checked: bool = True) -> TimeLaw | None:
    """Return the time law from a position on; None when x_start, the speed squared there, is too much."""
    ahead = [
        interval
        for stretch in path.stretches
        for interval in stretch.intervals
        if interval.start + interval.length > position + _ROUNDING_M
    ]
    if not ahead:
        ahead = [path.stretches[-1].intervals[-1]]
    if ahead[0].start < position:
        gone = position - ahead[0].start
        ahead[0] = ahead[0]._replace(start=position, length=max(0.0, ahead[0].length - gone), x_start_max=inf)
    x = [0.0] * (len(ahead) + 1)
    reachable = 0.0
    for k in range(len(ahead) - 1, -1, -1):
        _, length, x_max, a, x_start_max, bend = ahead[k]
        reachable += 2.0 * length * a
        if bend:
            reachable /= 1.0 + 2.0 * length * bend
        if x_max < reachable:
            reachable = x_max
        if x_start_max < reachable:
            reachable = x_start_max
        if k and ahead[k - 1].x_max < reachable:
            reachable = ahead[k - 1].x_max
        x[k] = reachable
    if is_checked and x_start > x[0] * (1.0 + 1e-9) + 1e-15:
        return None
    x[0] = x_start
    for k, (_, length, _, a, _, bend) in enumerate(ahead, 1):
        reachable = x[k - 1] + 2.0 * length * a
        if bend:
            reachable /= 1.0 + 2.0 * length * bend
        if reachable < x[k]:
            x[k] = reachable
    start_s: list[float] = []
    positions: list[float] = []
    speeds: list[float] = []
    accelerations: list[float] = []
    t_s = 0.0
    for (start, length, x_max, a, _, bend), x_here, x_ahead in zip(ahead, x, x[1:], strict=False):
        s = start
        pieces: tuple[tuple[float, float, float, float], ...]
        if bend and x_here + x_ahead > 0.0 and length > 0.0:
            pieces = ((length, x_here, x_ahead, 0.5 * (x_ahead - x_here) / length),)
        elif x_here == x_ahead == x_max:
            pieces = ((length, x_max, x_max, 0.0),)
        else:
            top = max(x_here, x_ahead, min(x_max, 0.5 * (x_here + x_ahead) + a * length))
            rise, fall = 0.5 * (top - x_here) / a, 0.5 * (top - x_ahead) / a
            pieces = (
                (rise, x_here, top, a),
                (length - rise - fall, top, top, 0.0),
                (fall, top, x_ahead, -a),
            )
        for way, x_from, x_to, u in pieces:
            if way > _ROUNDING_M:
                v_from, v_to = sqrt(x_from), sqrt(x_to)
                start_s.append(t_s)
                positions.append(s)
                speeds.append(v_from)
                accelerations.append(u)
                t_s += 2.0 * way / (v_from + v_to)
                s += way
    if not positions:
        return TimeLaw(path.length, 0.0, (0.0,), (path.length,), (0.0,), (0.0,))
    return TimeLaw(path.length, t_s, start_s, positions, speeds, accelerations)
