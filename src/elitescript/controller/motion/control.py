"""Accepts motion requests, holds the active source of motion, and gives the nominal joints at any tick.

A move that is accepted at tick N begins at the time of tick N. The setpoint of tick K is the state at the time of tick
K: scripts read it during tick K, and the plant reached it after the motion phase of tick K-1. Speed percentage, pause,
resume and stop change only how path time of a planned move runs against time (`motion.timing.timescale`), so its
position never jumps; a motion that takes over begins with the present position and speed.

A planned move begins at standstill, or with a blend (`move_sequencing`). Motions at a speed and streams (drives) begin
in any state, and end the motion before.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Hashable, Iterable
from math import dist
from typing import TYPE_CHECKING, Final

from elitescript.controller.motion.joint_drive import Drive, JointDrive
from elitescript.controller.motion.move_sequencing import (
    CurrentMoveAction,
    MoveSequencing,
    lay_behind,
)
from elitescript.controller.motion.notices import Notices
from elitescript.controller.motion.sources import NEVER, Braking, MotionCall, Move
from elitescript.controller.motion.stepped_drives import ServoDrive, ToolDrive
from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.rotations import Vector3
from elitescript.kinematics.transforms import Transform
from elitescript.messages.events import Event, MotionEnded, MotionStarted, Warned
from elitescript.messages.motion import (
    DriveRequest,
    MotionRequest,
    ServoJ,
    Six,
    SpeedJ,
    SpeedL,
    StopJ,
    StopL,
)
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S, ticks_for
from elitescript.models.model import RobotModel
from elitescript.motion.limits import MotionLimits, joint_outside, joint_range_error
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, SpeedProfile, braked, halted
from elitescript.motion.streaming.twist import ToolMotion
from elitescript.motion.timing.timescale import stop_ramp, stop_ramp_tool
from elitescript.records import replace
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.messages.observations import MotionLeft, Observation

AnyDrive = JointDrive | ToolDrive | ServoDrive
AnySource = Move | Braking | AnyDrive


LEFT_MIN: Final = 1e-3
"""Way of a joint to its target, rad, or speed, rad/s, below which the arm is there, or stands."""

SHORT_M: Final = 0.005
"""Way of a short move, m (*assumed*)."""
SHORT_STOPS: Final = 30
"""Stops at the ends of short moves in a row from which on they are observed (*assumed*)."""


class MotionControl:
    """Gives the nominal joints of the arm, now and until the next request.

    Args:
        arm: geometry.
        limits: joint and tool limits.
        home: joint positions at power-on.
        stop_joint_deceleration: rad/s^2, for a program that is stopped.
        speed_ramp_s: time in which a planned move takes on a new speed percentage.
        on_event: receives motion events and warnings.
        on_end: called with number and completeness of a move when the arm has come to rest.

    Attributes:
        speed_scale: speed percentage as a fraction; changed by `set_speed_scale`.
        refused: tick, line and request of the last motion that was refused; None if none was.
    """

    __slots__ = (
        "_arm",
        "_cancelled_tick",
        "_count",
        "_next",
        "_notices",
        "_on_end",
        "_on_event",
        "_q_rest",
        "_rest_tick",
        "_sampled",
        "_sampled_tick",
        "_servo_tick",
        "_short_stops",
        "_source",
        "_started",
        "_starved",
        "_stop_joint_deceleration",
        "_succession",
        "flying",
        "is_paused",
        "limits",
        "observe",
        "on_obstacle",
        "refused",
        "speed_ramp_s",
        "speed_scale",
        "waypoint",
    )

    def __init__(
        self,
        arm: Arm,
        limits: MotionLimits,
        home: Six,
        stop_joint_deceleration: float,
        speed_ramp_s: float,
        on_event: Callable[[Event], None],
        on_end: Callable[[int, bool], None],
    ) -> None:
        self._arm = arm
        self._cancelled_tick = -1
        """When a move was braked because its thread has ended: a stop of the same tick says how it brakes."""
        self.limits = limits
        self._succession = MoveSequencing(arm, limits)
        self._q_rest = home
        self._stop_joint_deceleration = stop_joint_deceleration
        self.speed_ramp_s = speed_ramp_s
        self._on_event = on_event
        self._on_end = on_end
        self._source: AnySource | None = None
        self._next: Move | None = None
        self._started: MotionStarted | None = None
        self._count = 0
        self.speed_scale = 1.0
        self.is_paused = False
        self._sampled_tick = -1
        self._sampled = Setpoint(home, ZERO_SIX)
        self._notices = Notices(on_event)
        self.waypoint: Six | None = None
        self.refused: tuple[int, int, MotionRequest] | None = None
        self.on_obstacle: Callable[[int, Obstacle, str, int], None] = self._warn_of_obstacle
        self.observe: Callable[[Observation], None] | None = None
        """Takes what observers of a run may see."""
        self.flying: Move | None = None
        """The last move whose call has returned before its end; it may be over."""
        self._servo_tick = 0
        """Of the last target of `servoj`."""
        self._starved = -1
        """Number of the last call, if that was a target of `servoj` at which the arm has come to rest."""
        self._rest_tick = -1
        """When the last move has ended."""
        self._short_stops = 0
        """Short moves in a row, each of which has begun at the end of the one before, at rest."""

    def begin_program(self) -> None:
        """Forget which warnings were emitted: a program begins."""
        self._notices.said.clear()
        self._short_stops = 0
        self._starved = -1

    @property
    def is_moving(self) -> bool:
        """Whether a motion is under way (paused or braking included)."""
        return self._source is not None

    def rate(self, tick: int) -> float:
        """Return the rate of path time, 0 to 1; the speed percentage while no planned move runs."""
        source = self._source
        return source.scale.rate(tick * PERIOD_S) if isinstance(source, Move) else self.speed_scale

    @property
    def source(self) -> AnySource | None:
        """Present motion; None at standstill."""
        return self._source

    @property
    def next_move(self) -> Move | None:
        """The move that waits until the present motion has come to rest; there is at most one."""
        return self._next

    @property
    def next_tick(self) -> int | None:
        """Tick at which the present motion changes by itself; None if it does not."""
        source = self._source
        return None if source is None or source.due_tick >= NEVER else source.due_tick

    def setpoint(self, tick: int) -> Setpoint:
        """Return the target joints at a tick, from the present one up to the next that is due: rad, rad/s."""
        if tick != self._sampled_tick:
            self._sampled = self.sample(tick)
            self._sampled_tick = tick
        return self._sampled

    def rests_at(self, tick: int) -> bool:
        """Return whether the arm stands still from a tick on, which is not after the next one that is due."""
        return self._next is None and (self._source is None or self._source.end_tick <= tick)

    def rebase(self, q: Six) -> None:
        """Take other joints (rad) as those of the resting arm: a correction has ended there."""
        self._q_rest = q
        self._sampled_tick = -1

    def tool_way(self, begin: int, end: int) -> tuple[float, float, Vector3] | None:
        """Return way and turn of the tool between two ticks, as `turned`, and the TCP; see `Move.tool_way`."""
        source = self._source
        return source.tool_way(begin, end) if isinstance(source, Move) and end <= source.end_tick else None

    def turned(self, begin: int, end: int) -> Six | None:
        """Return how far each joint turns between two ticks, from the present one to the next that is due, rad.

        Back and forth are added up, and it may be a little more; None if it is not known without sampling.
        """
        source = self._source
        if source is None:
            return ZERO_SIX
        return source.turned(begin, end) if isinstance(source, Move) and end <= source.end_tick else None

    def course(self, begin: int, end: int) -> Hashable | None:
        """Return what the target joints between two ticks follow from, as `turned`; see `Move.course`."""
        source = self._source
        return source.course(begin, end) if isinstance(source, Move) and end <= source.end_tick else None

    @property
    def is_stepped(self) -> bool:
        """Whether the present motion is known for the next tick only, not in between."""
        return self._source is not None and self._source.is_stepped

    def sample(self, tick: float) -> Setpoint:
        """Return the target joints at any time, in ticks, from the present up to the next that is due: rad, rad/s."""
        source = self._source
        if source is None:
            return Setpoint(self._q_rest, ZERO_SIX)
        if self._next is not None and tick >= source.end_tick:
            source = self._next
        return source.setpoint(tick)

    def setpoints(self, ticks: range) -> list[tuple[Six, Six]]:
        """Return what `setpoint` returns, for many ticks in rising order."""
        source = self._source
        end = bisect_left(ticks, source.end_tick) if isinstance(source, Move) else 0
        found = source.setpoints(ticks[:end]) if isinstance(source, Move) and end else []
        return [*found, *map(self.sample, ticks[end:])]

    def request(self, request: MotionRequest, tick: int, T_flange_tcp: Transform, line: int, thread: str) -> int:
        """Begin a motion or a stop; return the number of the call whose end is the end of it.

        Raises:
            MotionError: refused; nothing has changed.
        """
        try:
            return self._begin(request, tick, T_flange_tcp, line, thread)
        except MotionError:
            self.refused = (tick, line, request)
            raise

    def _begin(self, request: MotionRequest, tick: int, T_flange_tcp: Transform, line: int, thread: str) -> int:
        self._advance(tick)
        if isinstance(request, StopJ | StopL):
            return self._brake(request, tick, T_flange_tcp)
        call = MotionCall(self._count + 1, tick, line, thread, T_flange_tcp)
        if isinstance(request, SpeedJ | SpeedL | ServoJ):
            return self._drive(request, call)
        rate = 0.0 if self.is_paused else self.speed_scale
        move, order, cautions = self._succession.accept(
            request, call, self._source, self._next, self._q_rest, rate, self._notices.said
        )
        self._count += 1
        if order is CurrentMoveAction.NEXT:
            self._next = move
        elif order is not CurrentMoveAction.EXTENDED:
            self._source = move
        self._sampled_tick = -1
        if order is CurrentMoveAction.BLENDED:
            self._on_event(MotionEnded(tick, True))
        elif tick <= self._rest_tick + 1 and self.waypoint is not None:
            self._count_stop(call, dist(self.waypoint[:3], move.waypoint[:3]))
        else:
            self._short_stops = 0
        self.waypoint = move.waypoint
        started = MotionStarted(tick, request, line, thread, move.segment.duration_s)
        if order is CurrentMoveAction.NEXT:
            self._started = started
        else:
            self._on_event(started)
        for caution in cautions:
            warned = Warned(tick, caution.text, thread, caution.line, caution.code, caution.hint)
            self._notices.once(caution.key_line, caution.kind, warned)
        return call.number

    def _count_stop(self, call: MotionCall, way_m: float) -> None:
        """Count a move that begins where the one before has just ended, and let observers see many short ones."""
        self._short_stops = self._short_stops + 1 if way_m < SHORT_M else 0
        if self._short_stops >= SHORT_STOPS and self.observe is not None:
            from elitescript.messages.observations import StoppedAgain

            self.observe(StoppedAgain(call.tick, call.line, call.thread, self._short_stops, way_m))

    def is_done(self, number: int) -> bool:
        """Return whether the call of that number is over."""
        source, after = self._source, self._next
        if source is not None and source.is_awaited(number):
            return False
        return after is None or not after.is_awaited(number)

    def cancel(self, number: int, tick: int) -> None:
        """Brake the motion of that call, if it is under way or waits."""
        if self._next is not None and self._next.number == number:
            self._drop_next()
        elif (source := self._source) is not None and source.is_awaited(number):
            if isinstance(source, Move) and not source.is_stopping:
                self._cancelled_tick = tick
            self.stop(tick)

    def stop(self, tick: int) -> None:
        """Brake the present motion with the program-stop deceleration."""
        self._drop_next()
        self._advance(tick)
        source = self._source
        if isinstance(source, Move):
            if not source.is_stopping:
                source.stop(tick, source.stop_ramp_s(tick, self._stop_joint_deceleration))
                self._sampled_tick = -1
        elif source is not None:
            qd = self.setpoint(tick).qd
            self._brake_joints(source.number, tick, max(map(abs, qd)) / self._stop_joint_deceleration)

    def finish(self, tick: int) -> None:
        """Let a move whose call has returned arrive, and brake other motions: the program has finished."""
        source = self._source
        if not (isinstance(source, Move) and source.is_returned and self._next is None):
            self.stop(tick)

    def left(self, tick: int) -> MotionLeft | None:
        """Return the stream or the speed that is under way though its program has finished; None if there is none."""
        source = self._source
        if not isinstance(source, Drive) or source.is_stopping:
            return None
        # Imported late: few programs end so.
        from elitescript.messages.observations import MotionLeft

        q, qd = self.setpoint(tick)
        left = max(abs(a - b) for a, b in zip(source.q_rest, q, strict=True)) if source.has_target else 0.0
        speed = max(map(abs, qd))
        if left < LEFT_MIN and (source.has_target or speed < LEFT_MIN):
            return None
        return MotionLeft(tick, source.command, source.line, source.thread, left, speed)

    def take_over(self, profile: SpeedProfile, tick: int, thread: str) -> int:
        """Come to rest by a profile that begins in the present state; return the number of the call that ends then."""
        self._drop_next()
        number = 0 if self._source is None else self._source.number
        if not number or self.is_done(number):
            number = self._count = self._count + 1
        self._source = Braking(number, thread, profile, tick)
        self._sampled_tick = -1
        return number

    def set_speed_scale(self, fraction: float, tick: int) -> None:
        """Set the speed percentage, reached in a ramp."""
        self.speed_scale = fraction
        if not self.is_paused:
            self._set_rates(fraction, tick)

    def path_rate(self, rate: float, tick: int) -> None:
        """Let the present move reach a rate at the next tick; the joints must be able to follow."""
        source = self._source
        if isinstance(source, Move):
            source.set_rate(tick, rate, PERIOD_S)
            if self._next is not None:
                lay_behind(source, self._next)
            self._changed(tick)

    def pause(self, tick: int) -> None:
        """Brake until `resume`."""
        self.is_paused = True
        self._advance(tick)
        source = self._source
        if isinstance(source, Move) and not source.is_stopping:
            source.pause(tick, source.stop_ramp_s(tick, self._stop_joint_deceleration))
        elif isinstance(source, Drive) and not source.is_stopping:
            source.pause(tick)
        self._changed(tick)
        if source is not None and self._next is not None:
            # A move that is nearly over still reaches its end.
            self._next.hold(min(source.end_tick, self._next.start_tick))

    def resume(self, tick: int) -> None:
        """Go on after a pause, with the present speed percentage."""
        self.is_paused = False
        self._advance(tick)
        source = self._source
        if isinstance(source, Drive) and not source.is_stopping:
            source.resume(tick, self.speed_scale)
            self._changed(tick)
        else:
            self._set_rates(self.speed_scale, tick)

    def settle(self, tick: int) -> None:
        """Emit what has ended by `tick`; called before scripts run in that tick."""
        self._advance(tick)
        while (source := self._source) is not None and source.end_tick <= tick:
            self._q_rest = source.q_rest
            self._sampled_tick = -1
            end_tick = source.end_tick
            if isinstance(source, ServoDrive):
                self._starved = self._count
            self._rest_tick = end_tick
            self._source, self._next = self._next, None
            self._on_event(MotionEnded(end_tick, source.reaches_end))
            if isinstance(source, Move) and source.reaches_end and source.plan.obstacle is not None:
                self.on_obstacle(end_tick, source.plan.obstacle, source.thread, source.line)
            if self._source is not None and self._started is not None:
                self._on_event(replace(self._started, tick=end_tick))
            self._started = None
            self._on_end(source.number if source.is_awaited(source.number) else 0, source.reaches_end)
        if isinstance(source, Drive | Move) and source.return_tick <= tick:
            source.note_return(tick)
            if isinstance(source, Move):
                self.flying = source
            self._on_end(source.number, True)

    def _drop_next(self) -> None:
        """Forget the move that was to begin at standstill."""
        move, self._next = self._next, None
        self._started = None
        if move is not None:
            self._on_end(move.number, False)

    def _set_rates(self, rate: float, tick: int) -> None:
        self._advance(tick)
        source, waiting = self._source, self._next
        if isinstance(source, Drive):
            source.set_fraction(tick, rate)
        elif isinstance(source, Move) and not source.is_stopping:
            source.change_rate(tick, rate, self.speed_ramp_s, self.limits.qdd_max)
            if waiting is not None:
                lay_behind(source, waiting)
                waiting = None
        if waiting is not None:
            waiting.change_rate(tick, rate, self.speed_ramp_s, self.limits.qdd_max)
        self._changed(tick)

    # ---------------------------------------------------------------- drives and brakes

    def _drive(self, request: DriveRequest, call: MotionCall) -> int:
        source = self._source
        number, tick = call.number, call.tick
        if isinstance(request, ServoJ):
            joint = joint_outside(self.limits, request.q_target)
            if joint is not None:
                raise joint_range_error(self.limits, joint, request.q_target[joint], "at the target of servoj")
            step_ticks, self._servo_tick = tick - self._servo_tick, tick
            if isinstance(source, ServoDrive):
                self._count = number
                if not source.is_returned:
                    self._on_end(source.number, False)
                source.take(call, request)
                self._changed(tick)
                return number
            if source is None and self._starved == self._count and step_ticks <= TICKS_PER_S:
                self._tell_starved(request, call, step_ticks)
        drive = self._new_drive(request, call)
        obstacle = drive.obstacle(tick)
        if obstacle is not None and drive.leads_into(obstacle, self.setpoint(tick).q):
            raise obstacle.error()
        self._count = number
        self._drop_next()
        if self.is_paused:
            drive.pause(tick)
        self._source = drive
        self._report_take_over(source, request, call)
        if drive.is_lowered:
            name = type(request).__name__.lower()
            text = said(
                "{name} asks for more than the arm can do; it goes as fast as it can, in the same direction", name=name
            )
            self._notices.once(call.line, "speed", Warned(tick, text, call.thread, call.line))
        self._changed(tick)
        return number

    def _tell_starved(self, request: ServoJ, call: MotionCall, step_ticks: int) -> None:
        """Let observers see that a stream of targets goes on from rest."""
        t_s = request.t_s or 0.0
        is_way = max(abs(a - b) for a, b in zip(request.q_target, self._q_rest, strict=True)) > LEFT_MIN
        if is_way and step_ticks > ticks_for(t_s) + 1 and self.observe is not None:
            from elitescript.messages.observations import ServoStarved

            self.observe(ServoStarved(call.tick, call.line, call.thread, step_ticks, t_s))

    def _new_drive(self, request: DriveRequest, call: MotionCall) -> AnyDrive:
        start, deceleration = self.setpoint(call.tick), self._stop_joint_deceleration
        if isinstance(request, SpeedJ):
            return JointDrive(call, request, start, self.speed_scale, self.limits, deceleration)
        if isinstance(request, SpeedL):
            motion = ToolMotion(self._arm, self.limits, call.T_flange_tcp, deceleration)
            return ToolDrive(call, request, start, self.speed_scale, motion)
        return ServoDrive(call, request, start, self.limits, deceleration)

    def _report_take_over(self, before: AnySource | None, request: DriveRequest, call: MotionCall) -> None:
        """Emit the events of a motion that takes over; a stream of the same request is one motion."""
        if isinstance(before, Move | Braking):
            self._on_event(MotionEnded(call.tick, False))
        if before is not None and before.is_awaited(before.number):
            self._on_end(before.number, False)
        if not isinstance(before, Drive) or before.request != request:
            source = self._source
            duration_s = source.profile.duration_s if isinstance(source, JointDrive) else 0.0
            self._on_event(MotionStarted(call.tick, request, call.line, call.thread, duration_s))

    def _advance(self, tick: int) -> None:
        """Advance a drive to a tick, and brake it in front of an obstacle."""
        if isinstance(self._source, Drive) and self._source.advance(tick):
            self._guard(tick)

    def _changed(self, tick: int) -> None:
        self._sampled_tick = -1
        self._guard(tick)

    def _guard(self, tick: int) -> None:
        source = self._source
        if not isinstance(source, JointDrive | ToolDrive | ServoDrive):
            return
        obstacle = source.obstacle(tick)
        if obstacle is None:
            if isinstance(source, ServoDrive) and source.is_lowered:
                text = "servoj: the targets come faster than the joints can turn; the arm falls behind"
                self._notices.once(0, "servoj", Warned(tick, text, source.thread, source.line))
            return
        profile = halted(source.setpoint(tick), obstacle, self._stop_joint_deceleration, self.limits)
        self.take_over(profile, tick, source.thread)
        if isinstance(source, ServoDrive):
            # The target is inside the range: the stream can go on from where the arm has braked.
            self._warn_of_obstacle(tick, obstacle, source.thread, source.line)
        else:
            self.on_obstacle(tick, obstacle, source.thread, source.line)

    def _warn_of_obstacle(self, tick: int, obstacle: Obstacle, thread: str, line: int) -> None:
        self._notices.once(
            line, "obstacle", Warned(tick, said("{text}; the arm brakes", text=obstacle.text), thread, line)
        )

    def _brake(self, request: StopJ | StopL, tick: int, T_flange_tcp: Transform) -> int:
        source = self._source
        if source is None:
            return 0
        self._drop_next()
        if isinstance(source, Move):
            if not source.is_stopping or self._cancelled_tick == tick:
                path_time_s, rate = source.path_time_s(tick), source.scale.rate(tick * PERIOD_S)
                ramp = stop_ramp if isinstance(request, StopJ) else stop_ramp_tool
                source.stop(tick, max(ramp(source.segment, path_time_s, rate, request.a), PERIOD_S))
                self._sampled_tick = -1
            return source.number
        if isinstance(source, ToolDrive) and isinstance(request, StopL):
            if not source.is_stopping:
                if source.is_awaited(source.number):
                    self._on_end(source.number, False)
                self._count += 1
                source.stop(self._count, request.a)
                self._changed(tick)
            return source.number if self._source is None else self._source.number
        start = self.setpoint(tick)
        if isinstance(request, StopJ):
            return self._brake_joints(source.number, tick, max(map(abs, start.qd)) / request.a)
        vx, vy, vz, wx, wy, wz = tcp_twist(self._arm, start.q, start.qd, T_flange_tcp)
        ramp_s = max((vx * vx + vy * vy + vz * vz) ** 0.5, (wx * wx + wy * wy + wz * wz) ** 0.5) / request.a
        return self._brake_joints(source.number, tick, ramp_s)

    def _brake_joints(self, number: int, tick: int, ramp_s: float) -> int:
        """Bring the joints to rest; a braking under way is replaced if that is sooner."""
        source = self._source
        assert source is not None
        braking = Braking(number, source.thread, braked(self.setpoint(tick), ramp_s, self.limits), tick)
        if not isinstance(source, Braking) or braking.end_tick < source.end_tick:
            self._source = braking
            self._sampled_tick = -1
        return number


def motion_limits(model: RobotModel) -> MotionLimits:
    """Return the limits of a model in the form that the planner takes."""
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
