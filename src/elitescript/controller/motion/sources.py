"""Sources of motion: planned moves, chains and braking.

A *source* gives the joints at any tick from its beginning up to `due_tick`, the next tick at which it changes by
itself. `MotionControl` holds one at a time. A source in closed form is due rarely; a stepped one
(`stepped_drives`) is due at every tick while it moves.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Hashable
from math import inf, isinf
from typing import Final, Protocol

from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform, position_of
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S, ticks_for
from elitescript.motion.course import rounded
from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.polyline import ChainLine, begun, extended
from elitescript.motion.paths.track import JointTrack
from elitescript.motion.planner import Plan
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import SpeedProfile
from elitescript.motion.timing.timescale import TimeScale, change_ramp, stop_ramp
from elitescript.records import NamedTuple, replace

NEVER: Final = 1 << 62
"""Tick of an event that does not happen by itself."""


class MotionCall(NamedTuple):
    """The call of a program that asks for a motion."""

    number: int
    tick: int
    line: int
    thread: str
    T_flange_tcp: Transform


class MotionSource(Protocol):
    """The present motion of the arm."""

    number: int
    """Of its call."""
    thread: str
    is_stopping: bool
    """Whether it comes to rest for good."""
    reaches_end: bool
    """Whether it comes to rest at its target."""

    @property
    def is_stepped(self) -> bool:
        """Whether it is known for the next tick only, not in between."""

    @property
    def end_tick(self) -> int:
        """Tick at which the arm rests; NEVER if unknown."""

    @property
    def due_tick(self) -> int:
        """Next tick at which something changes by itself."""

    @property
    def q_rest(self) -> Six:
        """Joints at `end_tick`, rad."""

    def setpoint(self, tick: float) -> Setpoint:
        """Return the target joints at a tick up to `due_tick`: rad, rad/s."""

    def is_awaited(self, number: int) -> bool:
        """Return whether the call of that number is not over."""


def _time_s(tick: int) -> float:
    return tick * PERIOD_S


class Move:
    """One accepted move, from its start to standstill, or until the next one takes over with a blend.

    The call of a move with a blend radius returns at `return_tick`, when its blend begins; a move that is requested in
    that tick is blended, otherwise the arm goes on to its waypoint.

    Args:
        call: of the move.
        plan: of the move, with its own segment or that of a blend.
        start_tick: its beginning.
        scale: path time against time.
        waypoint: pose of its end.
    """

    __slots__ = (
        "T_flange_tcp",
        "_return_s",
        "end_tick",
        "is_paused",
        "is_returned",
        "is_stopping",
        "line",
        "number",
        "plan",
        "reaches_end",
        "return_tick",
        "returned_tick",
        "scale",
        "segment",
        "start_tick",
        "thread",
        "waypoint",
    )

    is_stepped = False

    def __init__(self, call: MotionCall, plan: Plan, start_tick: int, scale: TimeScale, waypoint: Six) -> None:
        self.number = call.number
        self.plan = plan
        self.segment = plan.segment
        self.start_tick = start_tick
        self.scale = scale
        self.thread = call.thread
        self.line = call.line
        self.waypoint = waypoint
        self.T_flange_tcp = call.T_flange_tcp
        self.is_stopping = False
        self.is_paused = False
        self.is_returned = False
        self.returned_tick = -1
        self.reaches_end = True
        """Whether the arm comes to rest at the end of the path."""
        self._return_s = inf if plan.zone is None else plan.segment.time_at(plan.zone.begin)
        self._lay()

    def _lay(self) -> None:
        """Compute when the move ends and when its call returns."""
        arrival_s = self.scale.time_of(self.segment.duration_s)
        # A move takes at least the tick in which it is commanded (assumed), so that a loop of empty moves waits.
        self.end_tick = NEVER if isinf(arrival_s) else max(ticks_for(arrival_s), self.start_tick + 1)
        self.return_tick = NEVER
        if not (self.is_returned or self.is_paused or self.is_stopping or isinf(self._return_s)):
            return_s = self.scale.time_of(self._return_s)
            if not isinf(return_s):
                self.return_tick = max(ticks_for(return_s), self.start_tick + 1)
                if self.return_tick >= self.end_tick:
                    self.return_tick = NEVER

    @property
    def due_tick(self) -> int:
        """Next tick at which the move changes by itself."""
        return min(self.end_tick, self.return_tick)

    def setpoint(self, tick: float) -> Setpoint:
        """Return the target joints at a tick from the start on."""
        if tick >= self.end_tick:
            return Setpoint(self.q_rest, ZERO_SIX)
        q, qd = self.segment.setpoint(self.path_time_s(tick))
        rate = self.scale.rate(tick * PERIOD_S)
        if rate != 1.0:
            a, b, c, d, e, f = qd
            qd = (a * rate, b * rate, c * rate, d * rate, e * rate, f * rate)
        return Setpoint(q, qd)

    def setpoints(self, ticks: range) -> list[tuple[Six, Six]]:
        """Return what `setpoint` returns, for many ticks in rising order."""
        scale = self.scale
        begin = bisect_left(ticks, scale.settled_s, key=_time_s)
        end = max(begin, bisect_left(ticks, self.end_tick))
        path_times = scale.settled_path_times([tick * PERIOD_S for tick in ticks[begin:end]])
        found = self.segment.setpoints(path_times)
        rate = scale.rate_target
        if rate != 1.0:
            found = [
                (q, (a * rate, b * rate, c * rate, d * rate, e * rate, f * rate)) for q, (a, b, c, d, e, f) in found
            ]
        # In a ramp the rate is different at every tick.
        return [*map(self.setpoint, ticks[:begin]), *found, *map(self.setpoint, ticks[end:])]

    def turned(self, begin: int, end: int) -> Six | None:
        """Return how far each joint turns between two ticks, at most; see `JointPath.turned`."""
        return self.segment.turned(self.path_time_s(begin), self.path_time_s(end))

    def tool_way(self, begin: int, end: int) -> tuple[float, float, Vector3] | None:
        """Return how far the TCP goes between two ticks, m, how far the tool turns, rad, and the TCP, flange frame.

        None if that is not known.
        """
        found = self.segment.tool_way(self.path_time_s(begin), self.path_time_s(end))
        return None if found is None else (*found, position_of(self.T_flange_tcp))

    def course(self, begin: int, end: int) -> Hashable | None:
        """Return what the target joints at the ticks between two ticks follow from, but for rounding.

        None if that is not known, or not likely to come again: in a ramp of the speed percentage and after it.
        """
        scale, course = self.scale, self.segment.course
        start = self.start_tick
        if course is None or scale.ramp_s or scale.s_start_s or scale.t_start_s != start * PERIOD_S:
            return None
        tcp = rounded(position_of(self.T_flange_tcp))
        return course, scale.rate_target, begin - start, end - start, tcp

    def is_awaited(self, number: int) -> bool:
        """Return whether the call of that number is not over."""
        return number == self.number and not self.is_returned

    def can_blend(self, tick: int) -> bool:
        """Return whether a move that is requested in this tick may be blended with this one."""
        return self.is_returned and self.returned_tick == tick and not (self.is_stopping or self.is_paused)

    def note_return(self, tick: int) -> None:
        """End the call; the move goes on."""
        self.is_returned = True
        self.returned_tick = tick
        self.return_tick = NEVER

    def set_rate(self, tick: int, rate: float, ramp_s: float) -> None:
        """Let path time run at `rate`, reached after a ramp."""
        self.is_paused = False
        self.scale = self.scale.with_target(tick * PERIOD_S, rate, ramp_s)
        self._lay()

    def change_rate(self, tick: int, rate: float, least_s: float, qdd_max: Six) -> None:
        """Change the rate in a ramp of `least_s`, or a longer one that the joints can follow."""
        tick = max(tick, self.start_tick)
        now, path_time_s = self.scale.rate(tick * PERIOD_S), self.path_time_s(tick)
        self.set_rate(tick, rate, change_ramp(self.segment, path_time_s, now, rate, least_s, qdd_max))

    def stop_ramp_s(self, tick: int, deceleration: float) -> float:
        """Return the time in which the joints can be brought to rest on the path with a deceleration, rad/s^2."""
        rate = self.scale.rate(tick * PERIOD_S)
        return max(stop_ramp(self.segment, self.path_time_s(tick), rate, deceleration), PERIOD_S)

    def pause(self, tick: int, ramp_s: float) -> None:
        """Come to rest within a time until a rate is set; the call does not return meanwhile."""
        self.set_rate(tick, 0.0, ramp_s)
        self.is_paused = True
        self.return_tick = NEVER

    def stop(self, tick: int, ramp_s: float) -> None:
        """Come to rest on the path within `ramp_s`, or at its end if that is nearer."""
        self.set_rate(tick, 0.0, ramp_s)
        self.is_stopping = True
        self.is_returned = False
        self.return_tick = NEVER
        standstill_tick = max(ticks_for(tick * PERIOD_S + ramp_s), self.start_tick + 1)
        self.reaches_end = self.end_tick <= standstill_tick
        self.end_tick = min(self.end_tick, standstill_tick)

    def hold(self, tick: int) -> None:
        """Keep the arm at the start of the move from a tick on, until a rate is set."""
        self.start_tick = tick
        self.scale = TimeScale.start(self.start_tick * PERIOD_S, 0.0)
        self.end_tick = self.return_tick = NEVER

    def begin_at(self, tick: int, scale: TimeScale) -> None:
        """Begin at another tick than planned."""
        self.start_tick = tick
        self.scale = scale
        self._lay()

    def path_time_s(self, tick: float) -> float:
        """Return the place along the segment, as time at full speed."""
        return min(self.scale.path_time(tick * PERIOD_S), self.segment.duration_s)

    @property
    def q_rest(self) -> Six:
        """Joints at the end of the move, rad."""
        return self.segment.q_end if self.reaches_end else self.segment.sample(self.path_time_s(self.end_tick))


class MovePChain(Move):
    """A chain of `movep` lines that grows while the arm moves along it.

    The call of a line returns when the next one should be known; that of an early line in the tick in which it is made,
    but not before the arm is on the chain.
    """

    __slots__ = ("_path",)

    def __init__(
        self, call: MotionCall, plan: Plan, r: float, start_tick: int, scale: TimeScale, waypoint: Six, begins_now: bool
    ) -> None:
        known = begun(_link(plan, r))
        super().__init__(call, replace(plan, segment=known.segment), start_tick, scale, waypoint)
        self._path = known.path
        self._return_s = known.feed_s
        self._lay()
        if begins_now:
            self._feed(start_tick)

    def can_blend(self, tick: int) -> bool:
        return False

    def can_grow(self, T_flange_tcp: Transform) -> bool:
        """Return whether the call of its last line is over and another line may be appended."""
        is_going_on = not (self.is_stopping or self.is_paused)
        return self.is_returned and is_going_on and T_flange_tcp == self.T_flange_tcp

    def extend(self, call: MotionCall, plan: Plan, r: float, waypoint: Six, limits: MotionLimits) -> None:
        """Append one line, planned from the end of the last."""
        track = plan.segment.path
        assert isinstance(track, JointTrack)
        self.number, self.thread, self.line, self.waypoint = call.number, call.thread, call.line, waypoint
        self.is_returned = False
        if track.length == 0.0:
            # No way to go: the call takes the tick that every call of a move takes.
            self._return_s = 0.0
            self._lay()
            return
        begin_tick = max(call.tick, self.start_tick)
        position, speed = self.segment.profile.at(self.path_time_s(begin_tick))
        known = extended(track.arm, limits, self._path, position, speed, _link(plan, r), self.T_flange_tcp)
        self.segment = known.segment
        self.scale = self.scale.rebased(begin_tick * PERIOD_S)
        self.start_tick = begin_tick
        self._path = known.path
        self._return_s = known.feed_s
        self._lay()
        self._feed(begin_tick)

    def _feed(self, tick: int) -> None:
        """End the call at once if the next line is needed already."""
        if self._return_s <= 0.0 and not self.is_paused:
            self.note_return(tick)


def _link(plan: Plan, r: float) -> ChainLine:
    track = plan.segment.path
    assert isinstance(track, JointTrack)
    return ChainLine(track, plan.law, r)


class Braking:
    """Joints that come to rest by a fixed profile in closed form.

    Args:
        number: of the call that ends at standstill.
        thread: of that call.
        profile: ends at rest.
        start_tick: its beginning.
    """

    __slots__ = ("end_tick", "is_stopping", "number", "profile", "q_rest", "reaches_end", "start_tick", "thread")

    is_stepped = False

    def __init__(self, number: int, thread: str, profile: SpeedProfile, start_tick: int) -> None:
        self.number = number
        self.thread = thread
        self.profile = profile
        self.start_tick = start_tick
        self.is_stopping = True
        self.reaches_end = False
        self.end_tick = start_tick + max(1, ticks_for(profile.duration_s))
        self.q_rest = profile.at(profile.duration_s).q

    @property
    def due_tick(self) -> int:
        """Tick of standstill."""
        return self.end_tick

    def setpoint(self, tick: float) -> Setpoint:
        """Return the target joints at a tick from the start on."""
        if tick >= self.end_tick:
            return Setpoint(self.q_rest, ZERO_SIX)
        return self.profile.at((tick - self.start_tick) * PERIOD_S)

    def is_awaited(self, number: int) -> bool:
        """Return whether the call of that number is not over."""
        return number == self.number
