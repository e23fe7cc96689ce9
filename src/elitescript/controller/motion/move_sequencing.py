"""Places planned moves behind the present motion: at once, with a blend, in a chain, or after standstill."""

from __future__ import annotations

from collections.abc import Callable, Collection
from enum import Enum
from functools import partial
from math import hypot
from typing import Final

from elitescript.controller.motion.joint_drive import busy_error
from elitescript.controller.motion.sources import NEVER, MotionCall, MotionSource, Move, MovePChain
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import Transform, pose_from_transform
from elitescript.messages.motion import BLEND_SHARE, MoveC, MoveJ, MoveL, MoveML, MoveP, MoveRequest, Six
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.blending import blended
from elitescript.motion.limits import MotionLimits
from elitescript.motion.paths.track import JointTrack
from elitescript.motion.planner import Plan, plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import BlendedSegment
from elitescript.motion.timing.timescale import TimeScale
from elitescript.records import NamedTuple, replace
from elitescript.said import Said, said

NOTEWORTHY: Final = 1e-3
"""Share by which a waypoint may be passed more slowly than requested without a warning."""

LOOKS: Final = 8
"""Parts of a blend after which the speed of the tool is sampled, for a warning."""

SLOW_BLEND: Final = "slow blend"

SLOW_BLENDS_MAX: Final = 10
"""Lines of a program that are warned of for a slow blend: a chain of short moves has hundreds."""

PROGRAM: Final = 0
"""Line of warnings that are emitted once in a program."""


class CurrentMoveAction(Enum):
    """What a new move does to the present motion."""

    NOW = "now"
    """There was none."""
    BLENDED = "blended"
    """It blends into the new move."""
    EXTENDED = "extended"
    """The new move is appended to it."""
    NEXT = "next"
    """It comes to rest first."""


class MoveWarning(NamedTuple):
    """A warning and its line."""

    key_line: int
    """Emitted once for this line, or once in a program."""
    kind: str
    text: str
    line: int
    code: str = ""
    hint: str = ""


class AcceptedMove(NamedTuple):
    """A planned move in its place."""

    move: Move
    order: CurrentMoveAction
    cautions: tuple[MoveWarning, ...]


class MoveSequencing:
    """Plans moves and places them behind others.

    Args:
        arm: geometry.
        limits: joint and tool limits.
    """

    __slots__ = ("_arm", "_limits")

    def __init__(self, arm: Arm, limits: MotionLimits) -> None:
        self._arm = arm
        self._limits = limits

    def accept(
        self,
        request: MoveRequest,
        call: MotionCall,
        source: MotionSource | None,
        waiting: Move | None,
        q_rest: Six,
        rate: float,
        noted: Collection[tuple[int, str]],
    ) -> AcceptedMove:
        """Return the move that a request becomes.

        Args:
            request: the move.
            call: of the request.
            source: present motion.
            waiting: move that follows it already.
            q_rest: joints of an arm at rest, rad.
            rate: speed percentage of an arm that starts from rest, as a fraction.
            noted: line and kind of warnings that the program has caused before.

        Raises:
            MotionError: refused; nothing has changed.
        """
        is_link = isinstance(request, MoveP) and waiting is None
        if is_link and isinstance(source, MovePChain) and source.can_grow(call.T_flange_tcp):
            return self._extended(request, call, source)
        if source is None:
            plan = self.plan(request, q_rest, call.T_flange_tcp)
            scale = TimeScale.start(call.tick * PERIOD_S, rate)
            return self._placed(request, call, plan, call.tick, scale, CurrentMoveAction.NOW)
        is_arriving = isinstance(source, Move) and source.is_returned
        if waiting is not None or not (is_arriving or (source.is_stopping and source.end_tick < NEVER)):
            raise busy_error(source, (waiting or source).thread)
        cautions: tuple[MoveWarning, ...] = ()
        if isinstance(source, Move) and source.can_blend(call.tick):
            plan = self.plan(request, source.segment.q_end, call.T_flange_tcp, is_entered=True)
            accepted = self._blended(request, call, source, plan, noted)
            if accepted is not None:
                return accepted
            if plan.segment.path.length > 0.0:
                cautions = (_stopping(source, request, call),)
        if isinstance(source, Move) and not source.is_stopping:
            plan = self.plan(request, source.segment.q_end, call.T_flange_tcp)
            accepted = self._placed(
                request, call, plan, call.tick, TimeScale.start(call.tick * PERIOD_S, 0.0), CurrentMoveAction.NEXT
            )
            lay_behind(source, accepted.move)
        else:
            plan = self.plan(request, source.q_rest, call.T_flange_tcp)
            scale = TimeScale.start(source.end_tick * PERIOD_S, rate)
            accepted = self._placed(request, call, plan, source.end_tick, scale, CurrentMoveAction.NEXT)
        return accepted._replace(cautions=accepted.cautions + cautions)

    def plan(self, request: MoveRequest, q_start: Six, T_flange_tcp: Transform, *, is_entered: bool = False) -> Plan:
        """Return the move from standstill to standstill.

        Raises:
            MotionError: refused.
        """
        if isinstance(request, MoveJ):
            return plan_movej(self._arm, self._limits, q_start, request, T_flange_tcp)
        if isinstance(request, MoveC):
            return plan_movec(self._arm, self._limits, q_start, T_flange_tcp, request, is_entered=is_entered)
        if isinstance(request, MoveML):
            from elitescript.motion.microline import plan_moveml

            return plan_moveml(self._arm, self._limits, q_start, T_flange_tcp, request)
        if isinstance(request, MoveP):
            request = MoveL(request.p_target, request.a, request.v)
        return plan_movel(self._arm, self._limits, q_start, T_flange_tcp, request, is_entered=is_entered)

    def _placed(
        self, request: MoveRequest, call: MotionCall, plan: Plan, tick: int, scale: TimeScale, order: CurrentMoveAction
    ) -> AcceptedMove:
        waypoint = _waypoint(request, plan)
        move: Move
        if isinstance(request, MoveP) and plan.segment.path.length > 0.0:
            move = MovePChain(call, plan, request.r, tick, scale, waypoint, order is CurrentMoveAction.NOW)
        else:
            move = Move(call, plan, tick, scale, waypoint)
        return AcceptedMove(move, order, _noted(plan, call))

    def _extended(self, request: MoveRequest, call: MotionCall, chain: MovePChain) -> AcceptedMove:
        plan = self.plan(request, chain.segment.q_end, call.T_flange_tcp, is_entered=True)
        waypoint = _waypoint(request, plan)
        chain.extend(call, plan, request.r, waypoint, self._limits)
        return AcceptedMove(chain, CurrentMoveAction.EXTENDED, _noted(plan, call))

    def _blended(
        self, request: MoveRequest, call: MotionCall, source: Move, plan: Plan, noted: Collection[tuple[int, str]]
    ) -> AcceptedMove | None:
        if isinstance(request, MoveP) or source.T_flange_tcp != call.T_flange_tcp:
            return None
        t_s = source.path_time_s(call.tick)
        _, speed = source.segment.profile.at(source.segment.profile_time(t_s))
        segment = blended(self._arm, self._limits, source.plan, t_s, plan, call.T_flange_tcp)
        if segment is None:
            return None
        scale = source.scale.rebased(call.tick * PERIOD_S)
        accepted = self._placed(
            request, call, replace(plan, segment=segment), call.tick, scale, CurrentMoveAction.BLENDED
        )
        slow = _slow(source, speed, partial(self._least_speed, segment, call.T_flange_tcp), request, noted)
        return accepted if slow is None else accepted._replace(cautions=(*accepted.cautions, slow))

    def _least_speed(self, segment: BlendedSegment, T_flange_tcp: Transform) -> float:
        """Return the lowest speed of the TCP in a blend, m/s."""
        speeds = []
        for look in range(LOOKS + 1):
            q, qd = segment.setpoint(segment.approach_s + segment.corner.length * look / LOOKS)
            speeds.append(hypot(*tcp_twist(self._arm, q, qd, T_flange_tcp)[:3]))
        return min(speeds)


def lay_behind(source: Move, waiting: Move) -> None:
    """Let a waiting move begin when the present one comes to rest."""
    if source.end_tick >= NEVER:
        waiting.hold(waiting.start_tick)
    else:
        waiting.begin_at(source.end_tick, source.scale.rebased(source.end_tick * PERIOD_S))


def _waypoint(request: MoveRequest, plan: Plan) -> Six:
    """Return the pose at the end of a move, as requested if it was given as a pose."""
    if isinstance(request, MoveJ | MoveML):
        return pose_from_transform(plan.segment.T_base_tcp_end)
    return request.p_target


def _noted(plan: Plan, call: MotionCall) -> tuple[MoveWarning, ...]:
    return tuple(MoveWarning(call.line, note.kind, note.text, call.line, note.code, note.hint) for note in plan.notes)


def _slow(
    source: Move,
    speed: float,
    least_speed: Callable[[], float],
    request: MoveRequest,
    noted: Collection[tuple[int, str]],
) -> MoveWarning | None:
    """Return the warning for a waypoint that is passed more slowly than requested.

    None also when the line has had it, or `SLOW_BLENDS_MAX` lines have: the speed at the waypoint takes as long to
    find as the blend.
    """
    law, zone, path = source.plan.law, source.plan.zone, source.plan.segment.path
    if zone is None or speed >= law.v * (1.0 - NOTEWORTHY):
        return None
    braking, unit = 0.5 * law.v * law.v / law.brake, path.unit
    if braking <= path.length - zone.begin or (source.line, SLOW_BLEND) in noted:
        return None
    count = sum(kind == SLOW_BLEND for _, kind in noted)
    if count >= SLOW_BLENDS_MAX:
        return None
    passes = ""
    if isinstance(path, JointTrack) and unit == "m":
        passes = said(" and passes the waypoint at {speed:.3g} m/s", speed=min(speed, least_speed()))
    is_too_short = braking > BLEND_SHARE * path.length
    if unit != "m":
        choice: str = Said("a larger a" if is_too_short else "a larger r or a")
    elif not is_too_short:
        choice = said("r = {braking:.3g} m or a larger a", braking=braking)
    elif isinstance(request, MoveL):
        choice = Said("a larger a, or movep, which looks ahead over moves as short as this one")
    else:
        choice = Said("a larger a, or a longer move before it")
    text = said(
        "the arm enters the blend at {speed:.3g} instead of {v:.4g} {unit}/s{passes}: it must be able to stop "
        "there, and r = {radius:.4g} m is less than its braking distance of {braking:.3g} {unit} at a = {a:.4g} "
        "{unit}/s^2; choose {choice}",
        speed=speed,
        v=law.v,
        unit=unit,
        passes=passes,
        radius=zone.radius,
        braking=braking,
        a=law.a,
        choice=choice,
    )
    if count == SLOW_BLENDS_MAX - 1:
        rest = "{text} (the {count}th line of this kind; further ones are not reported)"
        text = said(rest, text=text, count=SLOW_BLENDS_MAX)
    return MoveWarning(source.line, SLOW_BLEND, text, source.line)


def _stopping(source: Move, request: MoveRequest, call: MotionCall) -> MoveWarning:
    """Return the warning for a waypoint with a radius at which the arm stops."""
    if isinstance(request, MoveP):
        why = "a chain of movep begins at standstill"
    elif isinstance(request, MoveML):
        why = "moveml begins at standstill"
    elif source.T_flange_tcp != call.T_flange_tcp:
        why = "the TCP has changed there"
    else:
        why = "the limits of the arm allow no blend"
    return MoveWarning(
        PROGRAM,
        "no blend",
        said("the arm stops at the waypoint in spite of its blend radius: {why}", why=why),
        source.line,
    )
