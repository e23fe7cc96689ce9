"""Drives that go from one control period to the next: `speedl` and `servoj`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from math import hypot
from typing import Final

from elitescript.controller.motion.joint_drive import Drive
from elitescript.controller.motion.sources import NEVER, MotionCall
from elitescript.kinematics.jacobian import joint_speeds
from elitescript.messages.motion import DriveRequest, ServoJ, Six, SpeedL
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S, ticks_for
from elitescript.motion.limits import MotionLimits
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.servo import ServoState, begun, followed, held, may_meet_obstacle
from elitescript.motion.streaming.speed import Obstacle
from elitescript.motion.streaming.twist import ToolMotion, TwistState

LOOKAHEAD_TICKS_MAX: Final = 50
"""Longest window of the smoothing of `servoj`: 0.2 s."""


class Stepped(Drive, ABC):
    """A drive that advances tick by tick; the next state is computed when it is read."""

    __slots__ = ("_ahead", "_tick")

    is_stepped = True
    _ahead: TwistState | ServoState | Obstacle | None

    def __init__(self, call: MotionCall, request: DriveRequest, t_s: float | None) -> None:
        super().__init__(call, request, t_s)
        self._tick = call.tick

    @property
    def due_tick(self) -> int:
        """The next tick; a later one only at standstill."""
        if self._stands_still:
            return min(self.return_tick, self.end_tick)
        return self._tick + 1

    @property
    def end_tick(self) -> int:
        """Tick at which the arm rests for good; NEVER before."""
        return max(self._tick, self._may_end_tick) if self._has_arrived else NEVER

    @property
    @abstractmethod
    def _stands_still(self) -> bool:
        """Whether the arm stands, perhaps in a pause."""

    @property
    @abstractmethod
    def _has_arrived(self) -> bool:
        """Whether the arm stands until the next request."""

    @property
    @abstractmethod
    def _setpoint(self) -> Setpoint: ...

    @abstractmethod
    def _next(self) -> TwistState | ServoState | Obstacle:
        """Return the state of the next tick, or the obstacle in its way."""

    @abstractmethod
    def _look_ahead(self) -> Setpoint:
        """Return the setpoint of the next tick."""

    @abstractmethod
    def _step(self) -> None:
        """Take the state of the next tick."""

    @abstractmethod
    def set_fraction(self, tick: int, fraction: float) -> None:
        """Set the speed percentage; the acceleration of the call leads to it."""

    def _change(self) -> None:
        self._ahead = None

    @property
    def _may_meet_obstacle(self) -> bool:
        """Whether the state of the next tick may be an obstacle."""
        return True

    def obstacle(self, tick: int) -> Obstacle | None:
        """Return the obstacle that the drive meets at a tick."""
        if not self._may_meet_obstacle or self._stands_still:
            return None
        ahead = self._next()
        return ahead if isinstance(ahead, Obstacle) else None

    def pause(self, tick: int) -> None:
        """Brake until `resume`."""
        self._hold(tick)
        self._change()

    def resume(self, tick: int, fraction: float) -> None:
        """Go on after a pause."""
        self._release(tick)
        self.set_fraction(tick, fraction)

    def setpoint(self, tick: float) -> Setpoint:
        """Return the target joints at a tick up to `due_tick`."""
        return self._setpoint if tick <= self._tick or self._stands_still else self._look_ahead()

    def advance(self, tick: int) -> bool:
        """Advance to a tick; return False if it is there already."""
        if self._tick >= tick:
            return False
        while self._tick < tick:
            if self._stands_still:
                self._tick = tick
            else:
                self._step()
                self._tick += 1
        return True


class ToolDrive(Stepped):
    """Runs `speedl`: the TCP at a velocity."""

    __slots__ = ("_a", "_a_rot", "_fraction", "_is_reached", "_motion", "_xd", "state")

    _ahead: TwistState | Obstacle | None

    def __init__(self, call: MotionCall, request: SpeedL, start: Setpoint, fraction: float, motion: ToolMotion) -> None:
        super().__init__(call, request, request.t_s)
        self._motion = motion
        self._xd = motion.within_limits(request.xd)
        limits = motion.limits
        self._a = min(request.a, limits.tool_acceleration_max)
        self._a_rot = min(request.a_rot, limits.tool_turn_acceleration_max)
        self._fraction = fraction
        self._is_reached = False
        self._ahead = None
        self.state = motion.begin(start)

    @property
    def is_lowered(self) -> bool:
        """Whether the tool cannot reach the requested speed."""
        return isinstance(self.request, SpeedL) and self._xd != self.request.xd

    def leads_into(self, obstacle: Obstacle, q: Six) -> bool:
        """Return whether it is to go there; standstill may be requested anywhere."""
        return self._xd != ZERO_SIX

    @property
    def q_rest(self) -> Six:
        """Present joints, rad."""
        return self.state.q

    def at_full_speed(self, tick: int, points: int) -> Iterator[Setpoint]:
        """Yield the present joints with the requested velocity."""
        q, motion = self.state.q, self._motion
        yield Setpoint(q, joint_speeds(motion.arm, q, self._xd, motion.T_flange_tcp) or self.state.qd)

    @property
    def _target(self) -> Six:
        k = 0.0 if self.is_paused else self._fraction
        a, b, c, d, e, f = self._xd
        return (a * k, b * k, c * k, d * k, e * k, f * k)

    @property
    def _reached_tick(self) -> int:
        return self._tick if self._is_reached else NEVER

    @property
    def _setpoint(self) -> Setpoint:
        return Setpoint(self.state.q, self.state.qd)

    @property
    def _stands_still(self) -> bool:
        # The call of a motion that is not to move takes a tick all the same.
        is_reached = self._is_reached or self.is_paused
        return is_reached and self.state.qd == ZERO_SIX and self._target == ZERO_SIX

    @property
    def _has_arrived(self) -> bool:
        return self._is_reached and self.state.qd == ZERO_SIX and self._xd == ZERO_SIX

    def set_fraction(self, tick: int, fraction: float) -> None:
        self._fraction = fraction
        self._change()

    def stop(self, number: int, a: float) -> None:
        """Brake along the path, m/s^2 and rad/s^2 alike; the call of that number waits for standstill."""
        self._xd = ZERO_SIX
        limits = self._motion.limits
        self._a, self._a_rot = min(a, limits.tool_acceleration_max), min(a, limits.tool_turn_acceleration_max)
        self.number = number
        self.is_stopping, self.is_returned = True, False
        self._timeout_tick = NEVER
        self._held_ticks = -1
        self._change()

    @property
    def _may_end_tick(self) -> int:
        return 0 if self.is_stopping else super()._may_end_tick

    def _change(self) -> None:
        super()._change()
        self._is_reached = False

    def _next(self) -> TwistState | Obstacle:
        if self._ahead is None:
            a, a_rot = self._a, self._a_rot
            if self.is_paused:
                # All joints stand within the time that the quickest takes, as in every other motion.
                qd, twist = self.state.qd, self.state.twist
                ramp_s = max(max(map(abs, qd)) / self._motion.deceleration, PERIOD_S)
                a, a_rot = max(a, hypot(*twist[:3]) / ramp_s), max(a_rot, hypot(*twist[3:]) / ramp_s)
            self._ahead = self._motion.next(self.state, self._target, a, a_rot)
        return self._ahead

    def _look_ahead(self) -> Setpoint:
        ahead = self._next()
        return self._setpoint if isinstance(ahead, Obstacle) else Setpoint(ahead.q, ahead.qd)

    def _step(self) -> None:
        ahead = self._next()
        if not isinstance(ahead, Obstacle):
            self.state = ahead
            self._is_reached = ahead.twist == self._target and not ahead.is_slowed
        self._ahead = None


class ServoDrive(Stepped):
    """Runs `servoj`: the arm follows a stream of targets; the speed percentage does not count (*assumed*)."""

    __slots__ = (
        "_deceleration",
        "_gain",
        "_has_arrived",
        "_is_near_range",
        "_limits",
        "_q_target",
        "_window",
        "state",
    )

    has_target = True
    _has_arrived: bool
    """Found once for each state and target; asked several times in a tick."""

    _ahead: ServoState | Obstacle | None

    def __init__(
        self, call: MotionCall, request: ServoJ, start: Setpoint, limits: MotionLimits, deceleration: float
    ) -> None:
        super().__init__(call, request, request.t_s)
        self._limits = limits
        self._deceleration = deceleration
        self.state = begun(start)
        self._is_near_range = may_meet_obstacle(self.state, limits)
        """Whether the next state may be an obstacle, whatever the target."""
        self.take(call, request)

    def take(self, call: MotionCall, request: ServoJ) -> None:
        """Take the next target of the stream."""
        was_paused = self.is_paused
        ticks = self._begin_call(call, request, request.t_s)
        if was_paused:
            self._hold(call.tick)
        self._q_target = request.q_target
        self._gain = request.gain
        self._window = min(max(1, ticks_for(request.lookahead_s)), LOOKAHEAD_TICKS_MAX)
        q, qd, stream, _, is_limited, ease, is_taken_over = self.state
        self._take_state(ServoState(q, qd, stream, ticks, is_limited, ease, is_taken_over))

    def _take_state(self, state: ServoState) -> None:
        self.state, self._ahead = state, None
        self._has_arrived = state.is_at(self._q_target)

    @property
    def is_lowered(self) -> bool:
        """Whether a joint at its largest speed is behind the targets."""
        return self.state.is_limited

    @property
    def q_rest(self) -> Six:
        """The last target, rad."""
        return self._q_target

    @property
    def _setpoint(self) -> Setpoint:
        return Setpoint(self._q_target, ZERO_SIX) if self._has_arrived else Setpoint(self.state.q, self.state.qd)

    @property
    def _stands_still(self) -> bool:
        return self._has_arrived or (self.is_paused and self.state.qd == ZERO_SIX)

    @property
    def _may_meet_obstacle(self) -> bool:
        # The next target often comes before the next state is needed, so that state is not computed to look at it.
        return self._is_near_range

    def leads_into(self, obstacle: Obstacle, q: Six) -> bool:
        """Return False: a target is inside the range, so the arm only brakes in front of it."""
        return False

    def set_fraction(self, tick: int, fraction: float) -> None:
        """Do not change the speed."""
        self._change()

    def at_full_speed(self, tick: int, points: int) -> Iterator[Setpoint]:
        """Yield nothing: the stream alone determines the speed."""
        return iter(())

    def _next(self) -> ServoState | Obstacle:
        if self._ahead is None:
            if self.is_paused:
                self._ahead = held(self.state, self._deceleration, self._limits)
            else:
                may_meet = self._is_near_range
                self._ahead = followed(
                    self.state, self._q_target, self._window, self._gain, self._limits, may_meet=may_meet
                )
        return self._ahead

    def _look_ahead(self) -> Setpoint:
        ahead = self._next()
        if isinstance(ahead, Obstacle):
            return self._setpoint
        return Setpoint(self._q_target, ZERO_SIX) if ahead.is_at(self._q_target) else Setpoint(ahead.q, ahead.qd)

    def _step(self) -> None:
        ahead = self._next()
        if isinstance(ahead, Obstacle):
            self._ahead = None
        else:
            self._take_state(ahead)
            self._is_near_range = may_meet_obstacle(ahead, self._limits)
