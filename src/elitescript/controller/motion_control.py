"""Takes motion requests, holds the one active move, and says where the arm is at any tick.

A move that is accepted at tick N begins at the time of tick N. The setpoint of tick K is the state at the
time of tick K: what scripts read during tick K, and what the plant reached after the motion phase of tick K-1. Speed
percentage, pause, resume and stop change only how path time runs against time (`motion.timescale`), so position
never jumps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import isinf
from typing import Final

from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import Transform, pose_from_transform
from elitescript.messages.events import Event, MotionEnded, MotionStarted, Warned
from elitescript.messages.motion import MotionRequest, MoveJ, MoveL, MoveRequest, Six, StopJ, StopL
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S, ticks_for
from elitescript.models.model import RobotModel
from elitescript.motion.limits import MotionLimits
from elitescript.motion.planner import Plan, plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import Segment, Setpoint
from elitescript.motion.timescale import TimeScale, stop_ramp, stop_ramp_tool

SPEED_RAMP_S: Final = 0.2
"""Time in which a new speed percentage takes hold (*assumed*)."""

NEVER: Final = 1 << 62
"""Tick of what does not end by itself."""

_INSTANT_S: Final = 1e-6
"""Over this time the acceleration is taken as constant. Rounding of the speeds makes up some 1e-8 rad/s^2 of the
difference, the bending of a path some 1e-5."""


class Move:
    """One accepted move, from its start to standstill."""

    __slots__ = (
        "end_tick",
        "is_stopping",
        "number",
        "reaches_end",
        "scale",
        "segment",
        "start_tick",
        "thread",
        "waypoint",
    )

    def __init__(
        self, number: int, segment: Segment, start_tick: int, scale: TimeScale, thread: str, waypoint: Six
    ) -> None:
        self.number = number
        self.segment = segment
        self.start_tick = start_tick
        self.scale = scale
        self.thread = thread
        self.waypoint = waypoint
        self.is_stopping = False
        self.reaches_end = True
        """Whether the path's end is where the arm comes to rest."""
        self.end_tick = self._arrival_tick()

    def _arrival_tick(self) -> int:
        arrival_s = self.scale.time_of(self.segment.duration_s)
        # A move takes at least the tick in which it is commanded (assumed), so that a loop of empty moves waits.
        return NEVER if isinf(arrival_s) else max(ticks_for(arrival_s), self.start_tick + 1)

    def set_rate(self, tick: int, rate: float, ramp_s: float) -> None:
        """Let path time run at `rate` from now on, reached after a ramp."""
        self.scale = self.scale.with_target(tick * PERIOD_S, rate, ramp_s)
        self.end_tick = self._arrival_tick()

    def stop(self, tick: int, ramp_s: float) -> None:
        """Come to rest on the path within `ramp_s`, or at its end if that is nearer."""
        self.set_rate(tick, 0.0, ramp_s)
        self.is_stopping = True
        standstill_tick = max(ticks_for(tick * PERIOD_S + ramp_s), self.start_tick + 1)
        self.reaches_end = self.end_tick <= standstill_tick
        self.end_tick = min(self.end_tick, standstill_tick)

    def hold(self) -> None:
        """Do not begin: the arm stays where the move starts until a rate is set."""
        self.scale = TimeScale.start(self.start_tick * PERIOD_S, 0.0)
        self.end_tick = NEVER

    def path_time_s(self, tick: float) -> float:
        """How far along the segment the arm is, as time at full speed."""
        return min(self.scale.path_time(tick * PERIOD_S), self.segment.duration_s)

    @property
    def q_rest(self) -> Six:
        """Where the arm rests when the move is over."""
        return self.segment.q_end if self.reaches_end else self.segment.sample(self.path_time_s(self.end_tick))


class MotionControl:
    """The arm's position, now and for as long as nobody asks for something else.

    Args:
        arm: geometry.
        limits: joint and tool limits.
        home: joint positions at power-on.
        stop_joint_deceleration: rad/s^2, for a program that is stopped.
        on_event: receives motion events and warnings.
        on_end: called with number and completeness of a move when the arm has come to rest.
    """

    __slots__ = (
        "_arm",
        "_count",
        "_is_paused",
        "_limits",
        "_move",
        "_next",
        "_noted",
        "_on_end",
        "_on_event",
        "_q_rest",
        "_sampled",
        "_sampled_tick",
        "_speed_scale",
        "_stop_joint_deceleration",
        "waypoint",
    )

    def __init__(
        self,
        arm: Arm,
        limits: MotionLimits,
        home: Six,
        stop_joint_deceleration: float,
        on_event: Callable[[Event], None],
        on_end: Callable[[int, bool], None],
    ) -> None:
        self._arm = arm
        self._limits = limits
        self._q_rest = home
        self._stop_joint_deceleration = stop_joint_deceleration
        self._on_event = on_event
        self._on_end = on_end
        self._move: Move | None = None
        self._next: Move | None = None
        self._count = 0
        self._speed_scale = 1.0
        self._is_paused = False
        self._sampled_tick = -1
        self._sampled = Setpoint(home, ZERO_SIX)
        self._noted: set[tuple[int, str]] = set()
        self.waypoint: Six | None = None

    def begin_program(self) -> None:
        """Say again, once for each line, what has been said to the program before."""
        self._noted.clear()

    @property
    def is_moving(self) -> bool:
        """Whether a move is under way (paused or braking included)."""
        return self._move is not None

    @property
    def speed_scale(self) -> float:
        """Speed percentage as a fraction."""
        return self._speed_scale

    @property
    def next_tick(self) -> int | None:
        """Tick at which the present move ends by itself; None while none will."""
        move = self._move
        return None if move is None or move.end_tick >= NEVER else move.end_tick

    def setpoint(self, tick: int) -> Setpoint:
        """Target joints at the time of a tick, from the present one on: rad, rad/s."""
        if tick != self._sampled_tick:
            self._sampled = self._sample(tick)
            self._sampled_tick = tick
        return self._sampled

    def acceleration(self, tick: int) -> Six:
        """Target acceleration with which the joints go on from a tick, rad/s^2.

        Where it jumps, this is the value of the time that follows. It is a difference of the speeds of this instant and
        the next, because path, profile and speed percentage all contribute; it asks for nothing before the tick, so it
        does not depend on which ticks were run.
        """
        speeds = zip(self.setpoint(tick).qd, self._sample(tick + _INSTANT_S / PERIOD_S).qd, strict=True)
        return _six((later - now) / _INSTANT_S for now, later in speeds)

    def _sample(self, tick: float) -> Setpoint:
        move = self._move_at(tick)
        if move is None:
            return Setpoint(self._q_rest, ZERO_SIX)
        if tick >= move.end_tick:
            return Setpoint(move.q_rest, ZERO_SIX)
        q, qd = move.segment.setpoint(move.path_time_s(tick))
        rate = move.scale.rate(tick * PERIOD_S)
        if rate != 1.0:
            a, b, c, d, e, f = qd
            qd = (a * rate, b * rate, c * rate, d * rate, e * rate, f * rate)
        return Setpoint(q, qd)

    def request(self, request: MotionRequest, tick: int, T_flange_tcp: Transform, line: int, thread: str) -> int:
        """Begin a move or a stop; return the number of the move whose end is the end of it.

        Raises:
            MotionError: refused; nothing has changed.
        """
        if isinstance(request, StopJ | StopL):
            return self._brake(request, tick)
        move = self._move
        if move is not None and (self._next is not None or not move.is_stopping):
            other = (self._next or move).thread
            raise MotionError(
                f"the arm is moving already, for the thread {other!r}; one motion at a time",
                code="R114",
                hint="let one thread do all moves, or wait for the other with join_thread",
            )
        start_tick = tick if move is None else move.end_tick
        q_start = self._q_rest if move is None else move.q_rest
        plan = self._plan(request, q_start, T_flange_tcp)
        self._count += 1
        scale = TimeScale.start(start_tick * PERIOD_S, 0.0 if self._is_paused else self._speed_scale)
        waypoint = self._pose_of(request.q_target, T_flange_tcp) if isinstance(request, MoveJ) else request.p_target
        accepted = Move(self._count, plan.segment, start_tick, scale, thread, waypoint)
        if move is None:
            self._move = accepted
            self._sampled_tick = -1
        else:
            self._next = accepted
        self.waypoint = waypoint
        self._on_event(MotionStarted(tick, request, line, thread, plan.segment.duration_s))
        for note in plan.notes:
            self._warn_once(line, note.kind, Warned(tick, note.text, thread, line))
        if request.r > 0.0:
            text = f"blends are not simulated yet: the arm stops at each waypoint (here r = {request.r:g} m)"
            self._warn_once(0, "blend", Warned(tick, text, thread, line))
        return accepted.number

    def is_done(self, number: int) -> bool:
        """Whether that move is over."""
        return all(move is None or move.number != number for move in (self._move, self._next))

    def cancel(self, number: int, tick: int) -> None:
        """Brake that move, if it is under way or about to be."""
        if self._next is not None and self._next.number == number:
            self._end(self._next, tick, is_complete=False)
            self._next = None
        elif self._move is not None and self._move.number == number:
            self.stop(tick)

    def stop(self, tick: int) -> None:
        """Brake whatever is under way with the program-stop deceleration."""
        if self._next is not None:
            self._end(self._next, tick, is_complete=False)
            self._next = None
        move = self._move
        if move is not None and not move.is_stopping:
            move.stop(tick, self._program_stop_ramp_s(move, tick))

    def set_speed_scale(self, fraction: float, tick: int) -> None:
        """New speed percentage, taken on in a ramp."""
        self._speed_scale = fraction
        if not self._is_paused:
            self._set_rates(fraction, tick, SPEED_RAMP_S)

    def pause(self, tick: int) -> None:
        """Brake on the path, to go on later."""
        self._is_paused = True
        move = self._move
        if move is not None and not move.is_stopping:
            move.set_rate(tick, 0.0, self._program_stop_ramp_s(move, tick))
        if self._next is not None:
            self._next.hold()

    def resume(self, tick: int) -> None:
        """Go on after a pause, with the speed percentage of now."""
        self._is_paused = False
        self._set_rates(self._speed_scale, tick, SPEED_RAMP_S)

    def settle(self, tick: int) -> None:
        """Note what has ended by `tick`; call it before scripts run in that tick."""
        while self._move is not None and self._move.end_tick <= tick:
            move = self._move
            self._q_rest = move.q_rest
            self._sampled_tick = -1
            self._move, self._next = self._next, None
            self._end(move, move.end_tick, is_complete=move.reaches_end)

    def _warn_once(self, line: int, kind: str, warning: Warned) -> None:
        if (line, kind) not in self._noted:
            self._noted.add((line, kind))
            self._on_event(warning)

    def _end(self, move: Move, tick: int, *, is_complete: bool) -> None:
        self._on_event(MotionEnded(tick, is_complete))
        self._on_end(move.number, is_complete)

    def _set_rates(self, rate: float, tick: int, ramp_s: float) -> None:
        for move in (self._move, self._next):
            if move is not None and not move.is_stopping:
                move.set_rate(max(tick, move.start_tick), rate, ramp_s)

    def _brake(self, request: StopJ | StopL, tick: int) -> int:
        move = self._move
        if move is None:
            return 0
        if self._next is not None:
            self._end(self._next, tick, is_complete=False)
            self._next = None
        if not move.is_stopping:
            path_time_s, rate = move.path_time_s(tick), move.scale.rate(tick * PERIOD_S)
            ramp = stop_ramp if isinstance(request, StopJ) else stop_ramp_tool
            move.stop(tick, max(ramp(move.segment, path_time_s, rate, request.a), PERIOD_S))
        return move.number

    def _program_stop_ramp_s(self, move: Move, tick: int) -> float:
        rate = move.scale.rate(tick * PERIOD_S)
        return max(stop_ramp(move.segment, move.path_time_s(tick), rate, self._stop_joint_deceleration), PERIOD_S)

    def _plan(self, request: MoveRequest, q_start: Six, T_flange_tcp: Transform) -> Plan:
        if isinstance(request, MoveJ):
            return plan_movej(self._arm, self._limits, q_start, request, T_flange_tcp)
        if isinstance(request, MoveL):
            return plan_movel(self._arm, self._limits, q_start, T_flange_tcp, request)
        return plan_movec(self._arm, self._limits, q_start, T_flange_tcp, request)

    def _pose_of(self, q: Six, T_flange_tcp: Transform) -> Six:
        return pose_from_transform(self._arm.forward_tcp(q, T_flange_tcp))

    def _move_at(self, tick: float) -> Move | None:
        """The move that a tick belongs to; looks past the end of the present one."""
        move = self._move
        if move is not None and tick >= move.end_tick and self._next is not None:
            return self._next
        return move


def motion_limits(model: RobotModel) -> MotionLimits:
    """The limits of a model in the form that the planner takes."""
    joints = model.joints
    return MotionLimits(
        q_min=_six(joint.q_min for joint in joints),
        q_max=_six(joint.q_max for joint in joints),
        qd_max=_six(joint.qd_max for joint in joints),
        qdd_max=_six(joint.qdd_max for joint in joints),
        tool_speed_max=model.max_tool_speed,
        tool_acceleration_max=model.max_tool_acceleration,
        equivalent_radius_m=model.equivalent_radius_m,
    )


def _six(values: Iterable[float]) -> Six:
    a, b, c, d, e, f = values
    return (a, b, c, d, e, f)
