"""Motions that begin in any state and go on after the call: base class, and `speedj`.

A drive is a `MotionSource` that other requests, the speed percentage and pauses change while it runs. The call
that asked for it returns at `return_tick`; the drive lives on until another request takes over, until it
is stopped, or until it stands for good. Before anything is changed at a tick, `advance` brings it there.
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.controller.motion.sources import NEVER, MotionCall, MotionSource
from elitescript.errors import MotionError
from elitescript.messages.motion import DriveRequest, Six, SpeedJ
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S, ticks_for
from elitescript.motion.limits import MotionLimits
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import (
    Obstacle,
    SpeedProfile,
    accelerated,
    braked,
    obstacle_time,
    range_obstacle,
    within_speed_limits,
)
from elitescript.said import said


class Drive:
    """Base of all drives: the call, and when it returns.

    Args:
        call: asks for it.
        request: of the call.
        t_s: time after which the call returns; None returns when the speed is reached.
    """

    __slots__ = ("_held_ticks", "_timeout_tick", "is_returned", "is_stopping", "line", "number", "request", "thread")

    reaches_end = True
    is_stepped = False
    has_target = False
    """Whether it comes to rest at a target, `q_rest`."""

    def __init__(self, call: MotionCall, request: DriveRequest, t_s: float | None) -> None:
        self.is_stopping = False
        self._begin_call(call, request, t_s)

    def _begin_call(self, call: MotionCall, request: DriveRequest, t_s: float | None) -> int:
        """Begin a call; return its ticks, 0 if it has no time."""
        self.number = call.number
        self.thread = call.thread
        self.line = call.line
        self.request = request
        self.is_returned = False
        ticks = 0 if t_s is None else max(1, ticks_for(t_s))
        self._timeout_tick = None if t_s is None else call.tick + ticks
        self._held_ticks = -1
        return ticks

    @property
    def command(self) -> str:
        """Name of the command that asked for it last."""
        return type(self.request).__name__.lower()

    def is_awaited(self, number: int) -> bool:
        """Return whether the call of that number is not over."""
        return number == self.number and not self.is_returned

    @property
    def is_paused(self) -> bool:
        """Whether the time of the call is held."""
        return self._held_ticks >= 0

    @property
    def return_tick(self) -> int:
        """Tick at which the call returns; NEVER when it has, and while that is not known."""
        if self.is_returned or self.is_paused:
            return NEVER
        return self._reached_tick if self._timeout_tick is None else self._timeout_tick

    @property
    def _reached_tick(self) -> int:
        return NEVER

    @property
    def _may_end_tick(self) -> int:
        """Tick from which standstill ends the drive; a call lasts for its whole time."""
        return NEVER if self.is_paused else 0 if self.is_returned else self._timeout_tick or 0

    def note_return(self, tick: int) -> None:
        """End the call; the motion goes on."""
        self.is_returned = True

    def advance(self, tick: int) -> bool:
        """Advance to a tick that is not after the next one due; return whether its state may be another one then."""
        return True

    def _hold(self, tick: int) -> None:
        self._held_ticks = max(0, (self._timeout_tick or tick) - tick)

    def _release(self, tick: int) -> None:
        if self.is_paused and self._timeout_tick is not None:
            self._timeout_tick = tick + max(1, self._held_ticks)
        self._held_ticks = -1


class JointDrive(Drive):
    """Runs `speedj`: a function of time, computed anew when speed percentage or pause change."""

    __slots__ = ("_a", "_deceleration", "_limit_tick", "_limits", "_obstacle_joint", "_qd", "_start_tick", "profile")

    def __init__(
        self,
        call: MotionCall,
        request: SpeedJ,
        start: Setpoint,
        fraction: float,
        limits: MotionLimits,
        deceleration: float,
    ) -> None:
        super().__init__(call, request, request.t_s)
        self._qd = within_speed_limits(request.qd, limits)
        self._a = request.a
        self._limits = limits
        self._deceleration = deceleration
        self._accelerate(call.tick, start, fraction)

    @property
    def is_lowered(self) -> bool:
        """Whether a joint cannot turn as fast as asked."""
        return isinstance(self.request, SpeedJ) and self._qd != self.request.qd

    @property
    def end_tick(self) -> int:
        """Tick at which the arm rests for good; NEVER unless all requested speeds are zero."""
        return max(self._ramp_end_tick, self._may_end_tick) if self._qd == ZERO_SIX else NEVER

    @property
    def q_rest(self) -> Six:
        """Joints at that rest, rad."""
        return self.profile.at(self.profile.duration_s).q

    @property
    def due_tick(self) -> int:
        """Next tick at which something changes by itself."""
        return min(self.return_tick, self._limit_tick, self.end_tick)

    @property
    def _reached_tick(self) -> int:
        return self._ramp_end_tick

    @property
    def _ramp_end_tick(self) -> int:
        return self._start_tick + max(1, ticks_for(self.profile.duration_s))

    def setpoint(self, tick: float) -> Setpoint:
        """Return the target joints at a tick up to `due_tick`."""
        return self.profile.at((tick - self._start_tick) * PERIOD_S)

    def at_full_speed(self, tick: int, points: int) -> Iterator[Setpoint]:
        """Return states up to the next tick that is due, with the requested speeds."""
        due_tick = self.due_tick
        step = (due_tick - tick) / points if due_tick < NEVER else 0.0
        return (Setpoint(self.setpoint(tick + k * step).q, self._qd) for k in range(points + 1 if step else 1))

    def obstacle(self, tick: int) -> Obstacle | None:
        """Return the obstacle that the drive meets at a tick."""
        if tick < self._limit_tick:
            return None
        return range_obstacle(self._limits, self._obstacle_joint, self.setpoint(tick).q, "speedj")

    def leads_into(self, obstacle: Obstacle, q: Six) -> bool:
        """Return whether the joint at the end of its range is to go further out."""
        joint = obstacle.joint
        middle = 0.5 * (self._limits.q_min[joint] + self._limits.q_max[joint])
        return self._qd[joint] * (q[joint] - middle) > 0.0

    def set_fraction(self, tick: int, fraction: float) -> None:
        """Set the speed percentage; the acceleration of the call leads to it."""
        self._accelerate(tick, self.setpoint(tick), fraction)

    def pause(self, tick: int) -> None:
        """Brake until `resume`."""
        self._hold(tick)
        start = self.setpoint(tick)
        ramp_s = max(map(abs, start.qd)) / self._deceleration
        self._lay(tick, braked(start, ramp_s, self._limits))

    def resume(self, tick: int, fraction: float) -> None:
        """Go on after a pause."""
        self._release(tick)
        self.set_fraction(tick, fraction)

    def _accelerate(self, tick: int, start: Setpoint, fraction: float) -> None:
        a, b, c, d, e, f = self._qd
        qd = (a * fraction, b * fraction, c * fraction, d * fraction, e * fraction, f * fraction)
        self._lay(tick, accelerated(start, qd, self._a, self._limits))

    def _lay(self, tick: int, profile: SpeedProfile) -> None:
        self._start_tick = tick
        self.profile = profile
        time_s, self._obstacle_joint = obstacle_time(profile, self._deceleration, self._limits)
        self._limit_tick = tick + int(time_s / PERIOD_S) if time_s < 1e9 else NEVER


def busy_error(source: MotionSource, thread: str) -> MotionError:
    """Return the refusal (R114) of a planned move while another motion is under way."""
    if isinstance(source, Drive):
        what = type(source.request).__name__.lower()
        return MotionError(
            said(
                "the arm is moving already: {what} of line {line}, thread {thread!r}, goes on after its "
                "call, and a planned move begins at standstill",
                what=what,
                line=source.line,
                thread=source.thread,
            ),
            code="R114",
            hint="brake with stopj or stopl first",
        )
    return MotionError(
        said("the arm is moving already, for the thread {thread!r}; one motion at a time", thread=thread),
        code="R114",
        hint="let one thread do all moves, or wait for the other with join_thread",
    )
