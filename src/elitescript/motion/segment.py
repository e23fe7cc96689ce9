"""A planned move: a path and its profile, sampled at any time and in any order."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Hashable, Iterator, Sequence
from typing import Final, Protocol

from elitescript.kinematics.transforms import Transform
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.motion.course import rounded
from elitescript.motion.timing.profile import TimeLaw
from elitescript.records import NamedTuple


class Setpoint(NamedTuple):
    """Target state of the joints."""

    q: Six
    """rad"""
    qd: Six
    """rad/s"""


class AnyPath(Protocol):
    """Properties of every path."""

    @property
    def kind(self) -> str:
        """`joint`, `line`, `arc`, `blend`, `chain` or `points`."""

    @property
    def unit(self) -> str:
        """Unit of the path position: `rad` of the leading joint or of the tool, `m` of the TCP, or `s` of a file."""

    @property
    def length(self) -> float:
        """Path position at the end."""

    @property
    def T_base_tcp_end(self) -> Transform:
        """TCP pose at the end."""


class JointPath(AnyPath, Protocol):
    """Joint angles over the path position: a straight line in joint space, a followed Cartesian path, or points."""

    @property
    def q_start(self) -> Six:
        """Joint angles at the start, rad."""

    @property
    def q_end(self) -> Six:
        """Joint angles at the end, rad."""

    def q(self, s: float) -> Six:
        """Return the joint angles at a path position, rad; exact at both ends."""

    def q_and_slope(self, s: float) -> tuple[Six, Six]:
        """Return the joint angles and their derivatives by the path position."""

    def turned(self, begin: float, end: float) -> Six | None:
        """Return how far each joint turns between two path positions, back and forth added up, at most, rad.

        None if that is not known without solving every point.
        """

    @property
    def course(self) -> Hashable | None:
        """What the joints follow from, but for rounding; None if that is not kept."""

    def tool_rates(self, s: float) -> tuple[float, float]:
        """Return the way (m) and rotation (rad) of the tool per unit of path position."""


_TOOL_PATHS: Final = ("line", "arc", "blend")
"""Kinds of paths whose `tool_rates` are the same everywhere, or bounds."""


class Segment:
    """Joint targets as a function of the time since the start of the move; immutable.

    Times outside [0, duration_s] give the start or the end, at rest.
    """

    __slots__ = ("duration_s", "path", "profile")

    def __init__(self, path: JointPath, profile: TimeLaw) -> None:
        self.path = path
        self.profile = profile
        self.duration_s = profile.duration_s

    @property
    def kind(self) -> str:
        """Kind of the path."""
        return self.path.kind

    @property
    def q_start(self) -> Six:
        """Joint angles at the start, rad."""
        return self.path.q_start

    @property
    def q_end(self) -> Six:
        """Joint angles at the end, rad; equal to `sample(duration_s)`."""
        return self.path.q_end

    @property
    def T_base_tcp_end(self) -> Transform:
        """TCP pose at the end: the waypoint of the move."""
        return self.path.T_base_tcp_end

    def sample(self, t_s: float) -> Six:
        """Return the joint angles at a time, rad."""
        if t_s <= 0.0 or self.path.length == 0.0:
            return self.path.q_start
        if t_s >= self.duration_s:
            return self.path.q_end
        return self.path.q(self.profile.at(t_s)[0])

    def sample_speed(self, t_s: float) -> Six:
        """Return the joint speeds at a time, rad/s."""
        return self.setpoint(t_s).qd

    def setpoint(self, t_s: float) -> Setpoint:
        """Return joint angles and speeds at a time; cheaper than one by one."""
        if t_s <= 0.0 or self.path.length == 0.0:
            return Setpoint(self.path.q_start, ZERO_SIX)
        if t_s >= self.duration_s:
            return Setpoint(self.path.q_end, ZERO_SIX)
        return _state(self.path, *self.profile.at(t_s))

    def setpoints(self, times_s: Sequence[float]) -> list[tuple[Six, Six]]:
        """Return what `setpoint` returns, for many times in rising order."""
        path = self.path
        if path.length == 0.0:
            return [(path.q_start, ZERO_SIX)] * len(times_s)
        begin, end = bisect_right(times_s, 0.0), bisect_left(times_s, self.duration_s)
        passages = self.profile.at_times(times_s[begin:end])
        return [
            *[(path.q_start, ZERO_SIX)] * begin,
            *_states(path, passages),
            *[(path.q_end, ZERO_SIX)] * (len(times_s) - max(begin, end)),
        ]

    def turned(self, begin_s: float, end_s: float) -> Six | None:
        """Return how far each joint turns between two times, back and forth added up, at most, rad; see `JointPath`."""
        total = ZERO_SIX
        for path, begin, end in self._stretches(begin_s, end_s):
            turned = path.turned(begin, end)
            if turned is None:
                return None
            total = added(total, turned)
        return total

    def tool_way(self, begin_s: float, end_s: float) -> tuple[float, float] | None:
        """Return how far the TCP goes between two times, m, and how far the tool turns, rad, at most.

        None if the path has no rates of the tool that hold everywhere on it.
        """
        total_way = total_turn = 0.0
        for path, begin, end in self._stretches(begin_s, end_s):
            if path.kind not in _TOOL_PATHS:
                return None
            way, turn = path.tool_rates(begin)
            total_way, total_turn = total_way + way * (end - begin), total_turn + turn * (end - begin)
        return total_way, total_turn

    @property
    def course(self) -> Hashable | None:
        """What the joints at any time follow from, but for rounding; None if that is not kept."""
        course = self.path.course
        return None if course is None else (course, self.profile.course)

    def _stretches(self, begin_s: float, end_s: float) -> Iterator[tuple[JointPath, float, float]]:
        """Yield the paths that are followed between two times, and begin and end on each."""
        yield self.path, self.profile.at(begin_s)[0], self.profile.at(end_s)[0]

    def profile_time(self, t_s: float) -> float:
        """Return the time of the profile at a time of the segment; below 0 before the path is entered."""
        return t_s

    def time_at(self, position: float) -> float:
        """Return the time at which a path position is passed."""
        return self.profile.time_at(position)

    def tool_speed(self, t_s: float) -> tuple[float, float]:
        """Return the speed of the TCP, m/s, and of the tool's rotation, rad/s, at a time."""
        position, speed = self.profile.at(t_s)
        way, turn = self.path.tool_rates(position)
        return way * speed, turn * speed


class BlendedSegment(Segment):
    """A move with a blend at its begin: the path before, the corner, the rest of its own path; immutable.

    Args:
        before: the path before.
        before_profile: its time law.
        before_s: time of that law at which this segment begins.
        approach_s: how long the path before is still followed.
        corner: joints over the time of the blend, s.
        path: of the move.
        profile: of its rest, from the end of the blend on.
    """

    __slots__ = ("approach_s", "before", "before_profile", "before_s", "corner", "entered_s")

    def __init__(
        self,
        before: JointPath,
        before_profile: TimeLaw,
        before_s: float,
        approach_s: float,
        corner: JointPath,
        path: JointPath,
        profile: TimeLaw,
    ) -> None:
        super().__init__(path, profile)
        self.before = before
        self.before_profile = before_profile
        self.before_s = before_s
        self.approach_s = approach_s
        self.corner = corner
        self.entered_s = approach_s + corner.length
        """Time of the end of the corner."""
        self.duration_s = self.entered_s + profile.duration_s

    @property
    def q_start(self) -> Six:
        return self.sample(0.0)

    def sample(self, t_s: float) -> Six:
        return self.setpoint(t_s).q

    def setpoint(self, t_s: float) -> Setpoint:
        if t_s >= self.duration_s:
            return Setpoint(self.path.q_end, ZERO_SIX)
        if t_s >= self.entered_s:
            return _state(self.path, *self.profile.at(t_s - self.entered_s))
        if t_s >= self.approach_s:
            return Setpoint(*self.corner.q_and_slope(t_s - self.approach_s))
        return _state(self.before, *self.before_profile.at(self.before_s + max(0.0, t_s)))

    def setpoints(self, times_s: Sequence[float]) -> list[tuple[Six, Six]]:
        approach_s, entered_s, before_s = self.approach_s, self.entered_s, self.before_s
        corner, rest, end = [bisect_left(times_s, t_s) for t_s in (approach_s, entered_s, self.duration_s)]
        before_times = [before_s + max(0.0, t_s) for t_s in times_s[:corner]]
        rest_times = [t_s - entered_s for t_s in times_s[rest:end]]
        return [
            *_states(self.before, self.before_profile.at_times(before_times)),
            *[self.corner.q_and_slope(t_s - approach_s) for t_s in times_s[corner:rest]],
            *_states(self.path, self.profile.at_times(rest_times)),
            *[(self.path.q_end, ZERO_SIX)] * (len(times_s) - end),
        ]

    @property
    def course(self) -> Hashable | None:
        courses = (self.before.course, self.corner.course, self.path.course)
        profiles = (self.before_profile.course, self.profile.course)
        times_s = (self.before_s, self.approach_s, self.entered_s)
        return None if None in courses else (courses, profiles, rounded(times_s))

    def _stretches(self, begin_s: float, end_s: float) -> Iterator[tuple[JointPath, float, float]]:
        approach_s, entered_s = self.approach_s, self.entered_s
        if begin_s < approach_s:
            at, before_s = self.before_profile.at, self.before_s
            yield self.before, at(before_s + max(begin_s, 0.0))[0], at(before_s + min(end_s, approach_s))[0]
        if begin_s < entered_s and end_s > approach_s:
            yield self.corner, max(begin_s, approach_s) - approach_s, min(end_s, entered_s) - approach_s
        if end_s > entered_s:
            yield self.path, self.profile.at(begin_s - entered_s)[0], self.profile.at(end_s - entered_s)[0]

    def profile_time(self, t_s: float) -> float:
        return t_s - self.entered_s

    def time_at(self, position: float) -> float:
        return self.entered_s + self.profile.time_at(position)

    def tool_speed(self, t_s: float) -> tuple[float, float]:
        if t_s >= self.entered_s:
            path, (position, speed) = self.path, self.profile.at(t_s - self.entered_s)
        elif t_s >= self.approach_s:
            return self.corner.tool_rates(t_s - self.approach_s)
        else:
            path, (position, speed) = self.before, self.before_profile.at(self.before_s + max(0.0, t_s))
        way, turn = path.tool_rates(position)
        return way * speed, turn * speed


class RunningSegment(Segment):
    """A path that is entered at the position and the speed with which its profile starts; immutable."""

    __slots__ = ()

    def sample(self, t_s: float) -> Six:
        return self.setpoint(t_s).q

    def setpoint(self, t_s: float) -> Setpoint:
        if t_s >= self.duration_s:
            return Setpoint(self.path.q_end, ZERO_SIX)
        return _state(self.path, *self.profile.at(t_s))

    def setpoints(self, times_s: Sequence[float]) -> list[tuple[Six, Six]]:
        end = bisect_left(times_s, self.duration_s)
        passages = self.profile.at_times(times_s[:end])
        return [*_states(self.path, passages), *[(self.path.q_end, ZERO_SIX)] * (len(times_s) - end)]


def added(turned: Six, more: Six) -> Six:
    """Return the sum of two turns of each joint, rad."""
    a, b, c, d, e, f = turned
    g, h, i, j, k, m = more
    return a + g, b + h, c + i, d + j, e + k, f + m


def _state(path: JointPath, position: float, speed: float) -> Setpoint:
    """Return joint angles and speeds where a path position is passed at a path speed."""
    q, (d1, d2, d3, d4, d5, d6) = path.q_and_slope(position)
    return Setpoint(q, (d1 * speed, d2 * speed, d3 * speed, d4 * speed, d5 * speed, d6 * speed))


def _states(path: JointPath, passages: Sequence[tuple[float, float]]) -> list[tuple[Six, Six]]:
    """Return what `_state` returns, for many positions and speeds."""
    q_and_slope = path.q_and_slope
    found: list[tuple[Six, Six]] = []
    for position, speed in passages:
        q, (d1, d2, d3, d4, d5, d6) = q_and_slope(position)
        found.append((q, (d1 * speed, d2 * speed, d3 * speed, d4 * speed, d5 * speed, d6 * speed)))
    return found
