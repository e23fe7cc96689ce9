"""Path offsets: a program shifts its moves while they run, as a seam tracker does.

While they are enabled, the TCP is beside its nominal pose by the offset that was set last, in the axes of the base, of
the TCP or of the path. The offset passes a first-order filter in every control period; the arm is where the filtered
offset says, as long as the joints can follow it. Where it changes faster, half of the joints' speed and acceleration
is used to make up for the lag. A pause and the end of the program bring the deviation to rest and keep it; after the
end, the place where the arm has come to rest counts as its nominal one. Nothing of this depends on the speed
percentage. (All *assumed*, see `motion.corrections.offset`.)

A joint at the end of its range, the end of reach, a singularity and a joint that would have to be quicker than it can
end in a protective stop, as in conveyor tracking.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import hypot
from typing import Final

from elitescript.controller.motion.notices import Notices
from elitescript.controller.tool_setup import Setup
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import branch_of, reason_unreachable, solve_branch
from elitescript.kinematics.jacobian import joint_speeds, singularity, tcp_twist
from elitescript.kinematics.rotations import IDENTITY_ROTATION, Rotation, multiply, rotate, transpose
from elitescript.kinematics.transforms import (
    IDENTITY,
    Transform,
    compose,
    inverse,
    pose_from_transform,
    position_of,
    rotation_of,
    transform_from_pose,
)
from elitescript.messages.events import Event, Warned
from elitescript.messages.motion import Six
from elitescript.messages.path_offset import (
    EnablePathOffset,
    FilterPathOffset,
    LimitPathOffset,
    OffsetFrame,
    PathOffsetRequest,
)
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.corrections.compliance import after_way, way_between
from elitescript.motion.corrections.offset import (
    along_axes,
    axes_of,
    bounded,
    change_share,
    closing_rate,
    in_base,
    pace,
    smoothed,
    travel_axes,
)
from elitescript.motion.corrections.reachability import TOO_QUICK, Passage
from elitescript.motion.limits import MotionLimits, unwrapped
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, SpeedProfile, halted
from elitescript.motion.streaming.twist import ToolMotion, singular_obstacle
from elitescript.records import NamedTuple
from elitescript.said import said

TRANSLATION_MAX_M: Final = 0.1
ROTATION_MAX_RAD: Final = 0.52
"""Default limits of an offset: those of URScript (*assumed*)."""

UNFILTERED: Final = 1.0

NOTEWORTHY_M: Final = 5e-4
"""Lag behind the offset from which on a warning is emitted."""

WHAT: Final = "the path offset"

_SHARES: Final = (1.0, 0.5, 0.25, 0.125, 0.0)
"""Shares of the wanted change of speed; the greatest that the joints can follow is taken."""

_ROUNDING: Final = 1e-12
"""Lag within rounding, m and rad."""


class Deviation(NamedTuple):
    """Offset of the TCP from its nominal pose, and its rate: base frame."""

    place: Transform
    velocity: Six
    """m/s; angular velocity, rad/s."""


NONE: Final = Deviation(IDENTITY, ZERO_SIX)


class OffsetStep(NamedTuple):
    """Result of one period."""

    setpoint: Setpoint
    deviation: Deviation
    filtered: Transform
    wanted: Transform
    axes: Rotation
    lag_m: float
    obstacle: Obstacle | None = None
    braking: SpeedProfile | None = None
    """Profile to rest in front of the obstacle, from the period before on."""


class _Nominal(NamedTuple):
    """The motion to be shifted, at the next tick."""

    setpoint: Setpoint
    T_base_tcp: Transform
    twist: Six


class PathOffset:
    """A `controller.arm.state.Correction`.

    Args:
        arm: geometry.
        limits: joint and tool limits.
        deceleration: of joints that come to rest, rad/s^2.
        setup: the active TCP.
        nominal: gives the setpoint to be shifted, at the present tick.
        take_over: brings all motion to rest by a profile from a tick on, for a thread.
        on_event: receives warnings.

    Attributes:
        is_active: whether the arm is, or is to be, away from its nominal place.
    """

    __slots__ = (
        "_alpha",
        "_arm",
        "_deceleration",
        "_deviation",
        "_filtered",
        "_frame",
        "_input",
        "_is_enabled",
        "_is_ending",
        "_is_paused",
        "_limits",
        "_line",
        "_max",
        "_nominal",
        "_nominal_now",
        "_notices",
        "_offset",
        "_setpoint",
        "_setup",
        "_step",
        "_step_of",
        "_take_over",
        "_target",
        "_tcp",
        "_thread",
        "_travel",
        "_wanted",
        "is_active",
        "on_obstacle",
    )

    def __init__(
        self,
        arm: Arm,
        limits: MotionLimits,
        deceleration: float,
        setup: Setup,
        nominal: Callable[[], Setpoint],
        take_over: Callable[[SpeedProfile, int, str], None],
        on_event: Callable[[Event], None],
    ) -> None:
        self._arm = arm
        self._limits = limits
        self._deceleration = deceleration
        self._setup = setup
        self._nominal_now = nominal
        self._take_over = take_over
        self._notices = Notices(on_event)
        self.on_obstacle: Callable[[int, Obstacle, str, int], None] = lambda tick, obstacle, thread, line: None
        self._line, self._thread = 0, ""
        self._alpha = UNFILTERED
        self._max = (TRANSLATION_MAX_M, ROTATION_MAX_RAD)
        self._is_enabled = False
        self._rest()

    def _rest(self) -> None:
        """Reset: the arm is at its nominal place, and the offset is zero."""
        self.is_active = False
        self._is_ending = self._is_paused = False
        self._frame = OffsetFrame.BASE
        self._offset: Six = ZERO_SIX
        self._target = self._filtered = IDENTITY
        self._wanted: Transform | None = None
        self._deviation = NONE
        self._travel: Rotation | None = None
        self._nominal = self._setpoint = Setpoint(ZERO_SIX, ZERO_SIX)
        self._tcp = IDENTITY
        self._forget_step()

    def _forget_step(self) -> None:
        self._step: OffsetStep | None = None
        self._step_of: tuple[Setpoint, Transform] | None = None

    # ---------------------------------------------------------------- requests

    def begin_program(self, tick: int) -> None:
        """Reset the settings for a new program; an offset of the last one comes to rest."""
        if self.is_active:
            self._end(tick, halted(self._setpoint, None, self._deceleration, self._limits))
        self._is_enabled = False
        self._alpha = UNFILTERED
        self._max = (TRANSLATION_MAX_M, ROTATION_MAX_RAD)
        self._notices.said.clear()

    def request(self, request: PathOffsetRequest, tick: int, line: int, thread: str) -> None:
        """Carry out a request of a program, from a tick on."""
        self._forget_step()
        if isinstance(request, EnablePathOffset):
            self._is_enabled = True
            self._line, self._thread = line, thread
        elif isinstance(request, FilterPathOffset):
            self._alpha = request.alpha
        elif isinstance(request, LimitPathOffset):
            self._max = (request.translation_m, request.rotation_rad)
            self._set(tick, self._offset, self._frame)
        elif not self._is_enabled:
            text = "path_offset_set has no effect: call path_offset_enable first"
            self._notices.once(line, "off", Warned(tick, text, thread, line))
        else:
            self._line, self._thread = line, thread
            self._set(tick, request.offset, request.frame)

    def _set(self, tick: int, offset: Six, frame: OffsetFrame) -> None:
        self._offset = offset
        kept, excess = bounded(offset, *self._max)
        if excess is not None:
            text = said(
                "the path offset is limited: {excess} = {excess_2:.4g} {unit} is above {limit:.4g} "
                "{unit} (path_offset_set_max_offset)",
                excess=excess.name,
                excess_2=excess.value,
                unit=excess.unit,
                limit=excess.limit,
            )
            self._notices.once(self._line, "limited", Warned(tick, text, self._thread, self._line))
        target = IDENTITY if kept == ZERO_SIX else transform_from_pose(kept)
        if not self.is_active:
            if target == IDENTITY:
                return
            self.is_active = True
            self._nominal = self._setpoint = self._nominal_now()
            self._tcp = self._setup.T_flange_tcp
            self._frame = frame
        elif frame is not self._frame:
            self._filtered = along_axes(self._axes(frame), in_base(self._axes(self._frame), self._filtered))
            self._frame = frame
        self._target = target

    def offset(self, frame: OffsetFrame) -> Six:
        """Return the offset that the arm has at the present tick, along and about the axes of a frame."""
        if not self.is_active:
            return ZERO_SIX
        # A sum with zero, so that no zero has a sign.
        return _sum(pose_from_transform(along_axes(self._axes(frame), self._deviation.place)), ZERO_SIX)

    def without(self, target: Setpoint) -> Setpoint:
        """Return the setpoint of the present tick without an offset."""
        return self._nominal if self.is_active else target

    def _axes(self, frame: OffsetFrame) -> Rotation:
        """Return the axes of a frame at the present tick."""
        nominal = self._at(self._nominal)
        travel = travel_axes(nominal.twist[:3], nominal.T_base_tcp, self._travel)
        return axes_of(frame, nominal.T_base_tcp, travel)

    def pause(self, tick: int) -> None:
        """Come to rest until `resume`."""
        self._is_paused = True
        self._forget_step()

    def resume(self, tick: int) -> None:
        """Go on after a pause."""
        self._is_paused = False
        self._wanted = None
        self._forget_step()

    def stop(self, tick: int) -> None:
        """Come to rest beside the nominal motion, and stay there when that has come to rest too."""
        self._is_enabled = self._is_paused = False
        self._is_ending = self.is_active
        self._forget_step()

    def _end(self, tick: int, braking: SpeedProfile) -> None:
        self._is_enabled = False
        self._rest()
        self._take_over(braking, tick, self._thread)

    # ---------------------------------------------------------------- from tick to tick

    def peek(self, tick: int, nominal: Setpoint, now: JointState) -> Setpoint:
        """Return the target of a tick, one after the present one; changes nothing."""
        return self._next(nominal).setpoint

    def commit(self, tick: int, nominal: Setpoint, now: JointState, is_resting: bool) -> None:
        """Advance to that tick."""
        step = self._next(nominal)
        self._forget_step()
        if step.obstacle is not None and step.braking is not None:
            self.on_obstacle(tick, step.obstacle, self._thread, self._line)
            self._end(tick - 1, step.braking)
            return
        self._nominal, self._setpoint = nominal, step.setpoint
        self._deviation, self._filtered, self._wanted = step.deviation, step.filtered, step.wanted
        self._travel, self._tcp = step.axes, self._setup.T_flange_tcp
        if step.lag_m > NOTEWORTHY_M:
            text = said(
                "the path offset changes faster than the arm can follow; it is {lag_m:.1f} mm behind "
                "(smaller steps, or path_offset_set_alpha_filter)",
                lag_m=1000.0 * step.lag_m,
            )
            self._notices.once(self._line, "lag", Warned(tick, text, self._thread, self._line))
        if self._is_ending:
            if is_resting and step.deviation.velocity == ZERO_SIX:
                self._rest()
        elif step.deviation == NONE and self._target == step.filtered == IDENTITY:
            travel, frame, is_paused = self._travel, self._frame, self._is_paused
            self._rest()
            self._travel, self._frame, self._is_paused = travel, frame, is_paused

    def _next(self, nominal: Setpoint) -> OffsetStep:
        T_flange_tcp = self._setup.T_flange_tcp
        known = self._step_of
        if self._step is None or known is None or known[0] is not nominal or known[1] is not T_flange_tcp:
            self._step_of = (nominal, T_flange_tcp)
            self._step = self._work_out(self._at(nominal))
        return self._step

    def _at(self, setpoint: Setpoint) -> _Nominal:
        T_flange_tcp = self._setup.T_flange_tcp
        twist = ZERO_SIX if setpoint.qd == ZERO_SIX else tcp_twist(self._arm, *setpoint, T_flange_tcp)
        return _Nominal(setpoint, self._arm.forward_tcp(setpoint.q, T_flange_tcp), twist)

    def _work_out(self, nominal: _Nominal) -> OffsetStep:
        travel = travel_axes(nominal.twist[:3], nominal.T_base_tcp, self._travel)
        before = self._present_deviation()
        is_held = self._is_paused or self._is_ending
        filtered, wanted = self._filtered, before.place
        if not is_held:
            filtered = smoothed(filtered, self._target, self._alpha)
            wanted = in_base(axes_of(self._frame, nominal.T_base_tcp, travel), filtered)
        tool = ToolMotion(self._arm, self._limits, self._setup.T_flange_tcp, self._deceleration)
        # The deviation has one speed for each period, so positions and the mean of the speeds differ a little.
        passage = Passage(tool, WHAT, "with the path offset", 0.5 + 0.25)
        obstacle: Obstacle | None = None
        for deviation in self._candidates(before, wanted, is_held=is_held):
            target = self._shifted(nominal, deviation)
            obstacle = target if isinstance(target, Obstacle) else passage.obstacle(self._setpoint, target)
            if obstacle is None:
                assert isinstance(target, Setpoint)
                lag = way_between(deviation.place, wanted)
                lag_m = 0.0 if is_held else max(hypot(*lag[:3]), hypot(*lag[3:]) * self._limits.equivalent_radius_m)
                return OffsetStep(target, deviation, filtered, wanted, travel, lag_m)
            if obstacle.code != TOO_QUICK and not is_held:
                break
        braking = halted(self._setpoint, obstacle, self._deceleration, self._limits)
        return OffsetStep(braking.at(PERIOD_S), before, filtered, wanted, travel, 0.0, obstacle, braking)

    def _present_deviation(self) -> Deviation:
        """Return the deviation at the present tick, of the active TCP."""
        T_flange_tcp = self._setup.T_flange_tcp
        if T_flange_tcp == self._tcp:
            return self._deviation
        arm = self._arm
        nominal, shifted = self._at(self._nominal), self._at(self._setpoint)
        R = multiply(rotation_of(shifted.T_base_tcp), transpose(rotation_of(nominal.T_base_tcp)))
        (x, y, z), (x0, y0, z0) = position_of(shifted.T_base_tcp), position_of(nominal.T_base_tcp)
        twist = tcp_twist(arm, *self._setpoint, T_flange_tcp)
        carried = _carried(nominal.twist, R)
        return Deviation((*R, x - x0, y - y0, z - z0), _difference(twist, carried))

    def _candidates(self, before: Deviation, wanted: Transform, *, is_held: bool) -> Iterator[Deviation]:
        """Yield possible deviations of the next period, the best first."""
        if is_held:
            yield self._braked(before)
            yield _moved(before, before.velocity)
            return
        velocity, arrives = self._wanted_velocity(before, wanted)
        for share in _SHARES:
            if arrives and share == 1.0:
                yield Deviation(wanted, velocity)
            else:
                yield _moved(before, _sum(before.velocity, _difference(velocity, before.velocity), share))
        yield self._braked(before)

    def _wanted_velocity(self, before: Deviation, wanted: Transform) -> tuple[Six, bool]:
        """Return the velocity of the next period, and whether it leads exactly to the wanted deviation."""
        limits, present = self._limits, self._wanted or wanted
        exact = _scaled(way_between(before.place, wanted), 1.0 / PERIOD_S)
        lag = way_between(before.place, present)
        velocity, arrives = exact, True
        if max(map(abs, lag)) > _ROUNDING:
            lag_qd = self._joint_way(lag)
            rate = None if lag_qd is None else closing_rate(pace(lag_qd, limits.qd_max, limits.qdd_max))
            if rate is not None:
                going = _scaled(way_between(present, wanted), 1.0 / PERIOD_S)
                velocity, arrives = _sum(going, lag, rate), False
        change = _difference(velocity, before.velocity)
        change_qd = self._joint_way(change)
        share = 1.0 if change_qd is None else change_share(change_qd, limits.qdd_max)
        return (velocity, arrives) if share == 1.0 else (_sum(before.velocity, change, share), False)

    def _braked(self, before: Deviation) -> Deviation:
        """Return the deviation as it comes to rest with the deceleration of a stop."""
        qd = self._joint_way(before.velocity)
        top = 0.0 if qd is None else max(map(abs, qd))
        step = self._deceleration * PERIOD_S
        return _moved(before, ZERO_SIX if top <= step else _scaled(before.velocity, 1.0 - step / top))

    def _joint_way(self, way: Six) -> Six | None:
        """Return the joint motion for a way or a velocity of the TCP, at the present place."""
        return ZERO_SIX if way == ZERO_SIX else joint_speeds(self._arm, self._setpoint.q, way, self._setup.T_flange_tcp)

    def _shifted(self, nominal: _Nominal, deviation: Deviation) -> Setpoint | Obstacle:
        """Return the target beside a nominal motion."""
        if deviation == NONE:
            return nominal.setpoint
        arm, T_flange_tcp, q_near = self._arm, self._setup.T_flange_tcp, self._setpoint.q
        R, (dx, dy, dz) = rotation_of(deviation.place), position_of(deviation.place)
        x, y, z = position_of(nominal.T_base_tcp)
        T_base_tcp = (*multiply(R, rotation_of(nominal.T_base_tcp)), x + dx, y + dy, z + dz)
        T_base_flange = compose(T_base_tcp, inverse(T_flange_tcp))
        q = solve_branch(arm, T_base_flange, branch_of(arm, nominal.setpoint.q), q_near[5])
        if q is None:
            reason = reason_unreachable(arm, T_base_flange) or "the arm would have to change its configuration"
            return Obstacle(
                "R111",
                said("{what} takes the tool out of reach: {reason}", what=WHAT, reason=reason),
                hypot(dx, dy, dz),
                "",
                "m",
            )
        q = unwrapped(q, q_near)
        twist = _sum(_carried(nominal.twist, R), deviation.velocity)
        qd = ZERO_SIX if twist == ZERO_SIX else joint_speeds(arm, q, twist, T_flange_tcp)
        if qd is None:
            return singular_obstacle(arm, q_near, singularity(arm, q).blocked or "wrist", WHAT)
        return Setpoint(q, qd)


def _carried(twist: Six, R: Rotation) -> Six:
    """Return the twist of a pose that moves beside another one with `twist`, turned away from it by R."""
    return twist if R == IDENTITY_ROTATION else (*twist[:3], *rotate(R, twist[3:]))


def _moved(deviation: Deviation, velocity: Six) -> Deviation:
    return Deviation(after_way(deviation.place, _scaled(velocity, PERIOD_S)), velocity)


def _sum(one: Six, other: Six, factor: float = 1.0) -> Six:
    a, b, c, d, e, f = [x + factor * y for x, y in zip(one, other, strict=True)]
    return (a, b, c, d, e, f)


def _difference(one: Six, other: Six) -> Six:
    return _sum(one, other, -1.0)


def _scaled(six: Six, factor: float) -> Six:
    a, b, c, d, e, f = six
    return a * factor, b * factor, c * factor, d * factor, e * factor, f * factor
