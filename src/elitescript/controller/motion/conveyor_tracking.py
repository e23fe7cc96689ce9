"""Conveyor tracking: moves the nominal motion along with a belt or a turntable.

Moves are commanded as if the conveyor had stood still since the call of `track_conveyor_...`: its way is zero there
(*assumed*). The way of the arm begins with the present speed of the tool, catches up the lag of the start with
`tracking_acceleration` and at most `tracking_speed` above the conveyor's (*assumed*, settings of the model), and then
equals that of the conveyor (`motion.timing.pursuit`). The speed percentage does not count (*assumed*: a belt does not
slow down). A pause brings the arm to rest; afterwards it catches up again (*assumed*).

A joint at the end of its range, a singularity, the end of reach, and a joint that would have to be quicker than it
can, end the tracking with a protective stop, as an obstacle of `speedl` does (*assumed*). At the end the nominal motion
takes over the state of the joints and brakes them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from elitescript.controller.motion.conveyor_encoders import ENCODERS, CountLine, Encoder
from elitescript.errors import MotionError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import joint_speeds, singularity, tcp_twist
from elitescript.kinematics.transforms import IDENTITY, Transform, compose, inverse
from elitescript.messages.events import Event, TrackingEnded, TrackingStarted
from elitescript.messages.motion import Six, StopTracking, TrackCircular, TrackLinear, TrackRequest
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.models.model import RobotModel
from elitescript.motion.corrections.conveyor import Conveyor, StraightConveyor, Turntable
from elitescript.motion.corrections.reachability import Passage
from elitescript.motion.limits import MotionLimits, unwrapped
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, SpeedProfile, halted
from elitescript.motion.streaming.twist import ToolMotion, singular_obstacle
from elitescript.motion.timing.pursuit import CatchUp, Coast, caught_up

if TYPE_CHECKING:
    from elitescript.messages.observations import Observation
from elitescript.records import NamedTuple
from elitescript.said import said

GENTLE_S: Final = 0.2
"""Small lags are caught up no sooner (*assumed*), so that whole counts that a program sets do not shake the arm."""

WHAT: Final = "conveyor tracking"

_SAME_COUNT: Final = 1e-6
"""Counts, or counts per second, that make no difference."""


STILL_TICKS: Final = TICKS_PER_S // 2
"""Shortest time of tracking of which it is observed that the encoder has not counted (*assumed*)."""


class Following(NamedTuple):
    """A way that is that of the conveyor less the lag."""

    line: CountLine
    catch_up: CatchUp


class TrackingStep(NamedTuple):
    """Result of one tick."""

    setpoint: Setpoint
    way: float
    speed: float
    obstacle: Obstacle | None = None
    braking: SpeedProfile | None = None
    """Profile to rest in front of the obstacle, from the tick before on."""


class Tracking:
    """A `controller.arm.state.Correction`.

    Args:
        model: the arm, with its limits of catching up and braking.
        limits: joint and tool limits.
        take_over: brings the nominal motion to rest by a profile from a tick on, for a thread; returns the number of
            the call that ends then.
        on_event: receives beginnings, ends and warnings.
    """

    __slots__ = (
        "_T_flange_tcp",
        "_T_tcp_flange",
        "_arm",
        "_begin_tick",
        "_catch_up",
        "_conveyor",
        "_deceleration",
        "_encoder",
        "_is_paused",
        "_last_call",
        "_law",
        "_law_tick",
        "_limits",
        "_line",
        "_on_event",
        "_passage",
        "_placed",
        "_placed_q",
        "_placed_tcp",
        "_reference",
        "_relaid",
        "_speed",
        "_step",
        "_step_of",
        "_take_over",
        "_thread",
        "_tick",
        "_way",
        "encoders",
        "observe",
        "on_obstacle",
        "setpoint",
    )

    def __init__(
        self,
        model: RobotModel,
        limits: MotionLimits,
        take_over: Callable[[SpeedProfile, int, str], int],
        on_event: Callable[[Event], None],
    ) -> None:
        self.encoders = tuple(Encoder(index) for index in range(ENCODERS))
        self._arm: Arm = model.arm
        self._limits = limits
        self._deceleration = model.stop_joint_deceleration
        self._catch_up = (model.tracking_acceleration, model.tracking_speed)
        self._take_over = take_over
        self._on_event = on_event
        self.on_obstacle: Callable[[int, Obstacle, str, int], None] = lambda tick, obstacle, thread, line: None
        self._conveyor: Conveyor | None = None
        self._encoder: Encoder = self.encoders[0]
        self._begin_tick = 0
        self.observe: Callable[[Observation], None] | None = None
        """Takes what observers of a run may see."""
        self._T_flange_tcp = self._T_tcp_flange = IDENTITY
        self._placed: tuple[Transform, int]
        """Place of the TCP, and branch of the arm, of the nominal joints `_placed_q`."""
        self._placed_q: Six | None = None
        self._placed_tcp: Transform = IDENTITY
        tool = ToolMotion(self._arm, limits, IDENTITY, self._deceleration)
        self._passage = Passage(tool, WHAT, "on the conveyor")
        self._reference = 0.0
        self.setpoint = Setpoint(ZERO_SIX, ZERO_SIX)
        self._way = self._speed = 0.0
        self._tick = self._law_tick = 0
        self._law: Following | Coast = Coast(0.0, 0.0, 0.0)
        self._relaid: Following | None = None
        self._is_paused = False
        self._line, self._thread = 0, ""
        self._last_call = 0
        self._step: TrackingStep | None = None
        self._step_of: tuple[Setpoint, JointState, Following | Coast] | None = None

    # ---------------------------------------------------------------- requests

    @property
    def is_active(self) -> bool:
        """Whether a conveyor is tracked."""
        return self._conveyor is not None

    @property
    def caller(self) -> tuple[int, str] | None:
        """Line and thread that have begun the tracking; None if no conveyor is tracked."""
        return None if self._conveyor is None else (self._line, self._thread)

    def request(
        self, request: TrackRequest, tick: int, now: Setpoint, T_flange_tcp: Transform, line: int, thread: str
    ) -> int:
        """Begin or end at a tick; return the number of the call that ends with standstill, 0 of a beginning.

        Args:
            request: begin or end.
            tick: the present one.
            now: nominal joints at that tick.
            T_flange_tcp: active TCP; it is the point that goes along with a turntable (*assumed*: also when another
                one is set meanwhile).
            line: of the call.
            thread: of the call.

        Raises:
            MotionError: a conveyor is tracked already, or the arm is too near to a singularity.
        """
        if isinstance(request, StopTracking):
            return self._end(tick, self._halted(), thread)
        if self._conveyor is not None:
            raise MotionError(
                said("the arm tracks a conveyor already, since line {line}; one at a time", line=self._line),
                code="R114",
                hint="end it with stop_conveyor_tracking first",
            )
        blocked = singularity(self._arm, now.q).blocked
        if blocked:
            raise singular_obstacle(self._arm, now.q, blocked, WHAT).error()
        self._conveyor = _conveyor_of(request)
        self._encoder = self.encoders[request.encoder]
        self._begin_tick = tick
        self._T_flange_tcp, self._T_tcp_flange = T_flange_tcp, inverse(T_flange_tcp)
        self._passage = Passage(self._passage.tool._replace(T_flange_tcp=T_flange_tcp), WHAT, "on the conveyor")
        self.setpoint = now
        self._way = self._speed = 0.0
        self._tick = tick
        self._is_paused = False
        self._line, self._thread = line, thread
        self._follow(tick, self._encoder.line(tick).at(tick))
        self._on_event(TrackingStarted(tick, request, line, thread))
        return 0

    def pause(self, tick: int) -> None:
        """Come to rest until `resume`."""
        if self._conveyor is not None and not self._is_paused:
            self._lay(tick, Coast(self._way, self._speed, self._ramp_s()))
            self._is_paused = True

    def resume(self, tick: int) -> None:
        """Go on after a pause."""
        if self._conveyor is not None and self._is_paused:
            self._follow(tick, self._reference)
            self._is_paused = False

    def abandon(self, tick: int) -> None:
        """End without braking: another part brings the arm to rest."""
        if self._conveyor is not None:
            self._conveyor = None
            self._on_event(TrackingEnded(tick))

    def stop(self, tick: int) -> None:
        """Come to rest and end."""
        self._end(tick, self._halted(), self._thread)

    def _end(self, tick: int, braking: SpeedProfile, thread: str) -> int:
        if self._conveyor is not None:
            if tick - self._begin_tick >= STILL_TICKS and self._encoder.line(tick).at(tick) == 0.0:
                self._tell_still(tick)
            self.abandon(tick)
            self._last_call = self._take_over(braking, tick, thread)
        return self._last_call

    def _tell_still(self, tick: int) -> None:
        """Let observers see that the encoder has never counted."""
        from elitescript.messages.observations import EncoderStill

        if self.observe is not None:
            number, duration = self.encoders.index(self._encoder), tick - self._begin_tick
            counting = tuple(index for index, one in enumerate(self.encoders) if one.line(tick).at(tick) != 0.0)
            self.observe(EncoderStill(tick, self._line, self._thread, number, duration, counting))

    def _halted(self) -> SpeedProfile:
        return halted(self.setpoint, None, self._deceleration, self._limits)

    # ---------------------------------------------------------------- from tick to tick

    def peek(self, tick: int, nominal: Setpoint, now: JointState) -> Setpoint:
        """Return the target of a tick, one after the present one; changes nothing."""
        return self._next(tick, nominal, now).setpoint

    def commit(self, tick: int, nominal: Setpoint, now: JointState, is_resting: bool) -> None:
        """Advance to that tick."""
        step = self._next(tick, nominal, now)
        if self._relaid is not None:
            self._law, self._law_tick, self._relaid = self._relaid, tick - 1, None
        self._step = self._step_of = None
        self._tick, self.setpoint, self._way, self._speed = tick, step.setpoint, step.way, step.speed
        if step.obstacle is not None and step.braking is not None:
            self.on_obstacle(tick, step.obstacle, self._thread, self._line)
            self._end(tick - 1, step.braking, self._thread)

    def _next(self, tick: int, nominal: Setpoint, now: JointState) -> TrackingStep:
        law = self._present_law()
        known = self._step_of
        if self._step is None or known is None or known[0] is not nominal or known[1] is not now or known[2] is not law:
            self._step_of = (nominal, now, law)
            self._step = self._work_out(tick, nominal, law)
        return self._step

    def _work_out(self, tick: int, nominal: Setpoint, law: Following | Coast) -> TrackingStep:
        law_tick = self._law_tick if law is self._law else self._tick
        way, speed = self._on(law, tick, (tick - law_tick) * PERIOD_S)
        # Its own state: a later correction may have moved the target away from it.
        before = self.setpoint
        target = self._carried(nominal, before.q, way, speed)
        if isinstance(target, Setpoint):
            obstacle = None if target is nominal else self._passage.obstacle(before, target)
            if obstacle is None:
                return TrackingStep(target, way, speed)
        else:
            obstacle = target
        braking = halted(before, obstacle, self._deceleration, self._limits)
        return TrackingStep(braking.at(PERIOD_S), way, speed, obstacle, braking)

    def _carried(self, nominal: Setpoint, q_near: Six, way: float, speed: float) -> Setpoint | Obstacle:
        """Return the target for a nominal setpoint on a conveyor with a way and a speed."""
        if way == 0.0 and speed == 0.0:
            return nominal
        arm, conveyor = self._arm, self._conveyor
        assert conveyor is not None
        if nominal.q is not self._placed_q or self._T_flange_tcp is not self._placed_tcp:
            # Anew only for other joints or another TCP: without a move on the belt they rest.
            self._placed_q, self._placed_tcp = nominal.q, self._T_flange_tcp
            self._placed = arm.forward_tcp(nominal.q, self._T_flange_tcp), branch_of(arm, nominal.q)
        T_nominal, branch = self._placed
        T_base_tcp = conveyor.carried(T_nominal, way)
        T_base_flange = compose(T_base_tcp, self._T_tcp_flange)
        q = solve_branch(arm, T_base_flange, branch, q_near[5])
        if q is None:
            reason = reason_unreachable(arm, T_base_flange) or "the arm would have to change its configuration"
            return Obstacle(
                "R111", said("{what} takes the tool out of reach: {reason}", what=WHAT, reason=reason), way, "", ""
            )
        q = unwrapped(q, q_near)
        twist = ZERO_SIX
        if nominal.qd != ZERO_SIX:
            twist = tcp_twist(arm, nominal.q, nominal.qd, self._T_flange_tcp)
        twist = conveyor.carried_twist(twist, T_base_tcp, way, speed)
        qd = joint_speeds(arm, q, twist, self._T_flange_tcp)
        if qd is None:
            return singular_obstacle(arm, q_near, singularity(arm, q).blocked or "wrist", WHAT)
        return Setpoint(q, qd)

    # ---------------------------------------------------------------- laws of the way

    def _on(self, law: Following | Coast, tick: int, elapsed_s: float) -> tuple[float, float]:
        """Return the way and speed of the arm on a law."""
        if isinstance(law, Coast):
            return law.at(elapsed_s)
        assert self._conveyor is not None
        lag, rate = law.catch_up.at(elapsed_s)
        per_count = self._conveyor.way_per_count
        return (law.line.at(tick) - self._reference) * per_count - lag, law.line.rate * per_count - rate

    def _present_law(self) -> Following | Coast:
        """Return the law from the present tick on, a new one if the motion of the conveyor has changed."""
        law = self._law
        if isinstance(law, Coast):
            return law
        line = self._encoder.line(self._tick)
        if _is_same_course(line, law.line, self._tick):
            self._relaid = None
            return law
        if self._relaid is None or self._relaid.line != line:
            self._relaid = self._following(line)
        return self._relaid

    def _following(self, line: CountLine) -> Following:
        conveyor = self._conveyor
        assert conveyor is not None
        a, v = self._catch_up
        T_base_tcp = self._arm.forward_tcp(self.setpoint.q, self._T_flange_tcp)
        lever = conveyor.lever(T_base_tcp, self._limits.equivalent_radius_m)
        per_count = conveyor.way_per_count
        lag = (line.at(self._tick) - self._reference) * per_count - self._way
        return Following(line, caught_up(lag, line.rate * per_count - self._speed, a / lever, v / lever, GENTLE_S))

    def _follow(self, tick: int, reference: float) -> None:
        self._reference = reference
        self._lay(tick, self._following(self._encoder.line(tick)))

    def _lay(self, tick: int, law: Following | Coast) -> None:
        self._law, self._law_tick, self._relaid = law, tick, None

    def _ramp_s(self) -> float:
        """Return the time to brake the joint speeds that the conveyor adds."""
        conveyor = self._conveyor
        if self._speed == 0.0 or conveyor is None:
            return 0.0
        T_base_tcp = self._arm.forward_tcp(self.setpoint.q, self._T_flange_tcp)
        twist = conveyor.carried_twist(ZERO_SIX, T_base_tcp, self._way, self._speed)
        qd = joint_speeds(self._arm, self.setpoint.q, twist, self._T_flange_tcp)
        fastest = max(map(abs, qd)) / self._deceleration if qd else 0.0
        lever = conveyor.lever(T_base_tcp, self._limits.equivalent_radius_m)
        return max(fastest, abs(self._speed) * lever / self._limits.tool_acceleration_max, PERIOD_S)


def _is_same_course(line: CountLine, other: CountLine, tick: int) -> bool:
    """Return whether two lines, one of them new at a tick, are equal within rounding."""
    if line == other:
        return True
    return abs(line.at(tick) - other.at(tick)) < _SAME_COUNT and abs(line.rate - other.rate) < _SAME_COUNT


def _conveyor_of(request: TrackLinear | TrackCircular) -> Conveyor:
    if isinstance(request, TrackLinear):
        return StraightConveyor(request.direction, request.counts_per_m)
    return Turntable(request.center, request.counts_per_turn, request.turns_tool)
