"""Base of force control and hand guiding: corrections that let a part of the tool's motion yield.

In every period the twist of the nominal motion is split along and about the axes of a frame. The bound part is kept
exactly, as a change from one period to the next, so that the arm keeps the distance from the nominal pose by which it
has yielded. The free part follows a law. When the law ends, the arm takes up the nominal speed along the free axes too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from math import hypot
from typing import Final

from elitescript.controller.force.wrench_sensor import WrenchSensor
from elitescript.controller.motion.notices import Notices
from elitescript.controller.tool_setup import Setup
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.rotations import IDENTITY_ROTATION, Rotation
from elitescript.kinematics.transforms import Transform
from elitescript.messages.events import Event, Warned
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.corrections.admittance import selected
from elitescript.motion.corrections.compliance import Compliance, Yielded, way_between
from elitescript.motion.limits import MotionLimits
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle
from elitescript.motion.streaming.twist import ToolMotion
from elitescript.records import NamedTuple
from elitescript.said import said

NONE_FREE: Final = (False,) * 6

SLOWING_M_S2: Final = 4.0
"""Deceleration of the free part to a new speed limit (*assumed*)."""

_BELOW_LIMIT: Final = 0.99
"""Share of a speed limit that is used; the limit holds for the joints, at the end of each period."""

_ROUNDING: Final = 1e-12
"""Speed within rounding, m/s and rad/s."""

_HARDER: Final = (1.0, 1.5, 2.0, 3.0)
"""Decelerations in front of an obstacle, in that of a stop; the smallest possible one is taken. More than 1 is needed
where a singularity makes the joints faster while the tool brakes."""


class ArmAccess(NamedTuple):
    """Parts of the arm that a yielding correction uses."""

    arm: Arm
    limits: MotionLimits
    deceleration: float
    """Of joints that come to rest, rad/s^2."""
    setup: Setup
    sensor: WrenchSensor


class Caller(NamedTuple):
    """Line and thread of a request, for messages."""

    line: int
    thread: str


class _Question(NamedTuple):
    """Everything from outside that a period depends on."""

    nominal: Setpoint
    now: JointState
    external_wrench: Six
    zero: Six
    T_flange_tcp: Transform


class _Step(NamedTuple):
    """Result of one period."""

    yielded: Yielded
    velocity: Six
    """Of the TCP, m/s and rad/s, base frame."""
    axes: Rotation
    is_level: bool
    """Whether the arm has taken up the nominal speed, after the end or in a pause."""
    obstacle: Obstacle | None


class YieldingCorrection(ABC):
    """See `arm_state.Correction`.

    Args:
        body: the arm.
        on_event: receives warnings.
        on_end: called when the arm does not yield any more.
    """

    __slots__ = (
        "_answer",
        "_axes",
        "_body",
        "_caller",
        "_is_paused",
        "_nominal",
        "_notices",
        "_on_end",
        "_selection",
        "_speed_limit",
        "_tcp",
        "_velocity",
        "is_on",
    )

    name: str

    def __init__(self, body: ArmAccess, on_event: Callable[[Event], None], on_end: Callable[[], None]) -> None:
        self._body = body
        self._on_end = on_end
        self._caller = Caller(0, "")
        self._selection: tuple[bool, ...] = NONE_FREE
        self._axes: Rotation = IDENTITY_ROTATION
        self._velocity: Six = ZERO_SIX
        self._tcp: Transform | None = None
        self._nominal: Setpoint | None = None
        self._is_paused = False
        self._answer: tuple[_Question, _Step] | None = None
        self._notices = Notices(on_event)
        self._speed_limit: float | None = None
        self.is_on = False

    @property
    def caller(self) -> Caller:
        """Line and thread that have begun it last."""
        return self._caller

    @property
    @abstractmethod
    def is_active(self) -> bool:
        """Whether the arm yields, or comes to rest."""

    @property
    def is_yielding(self) -> bool:
        """Whether a part of the motion follows the law, or still comes to rest."""
        return self._selection != NONE_FREE

    @abstractmethod
    def _frame(self, T_base_tcp: Transform, nominal_twist: Six) -> Rotation:
        """Return axes of the frame in the base frame."""

    @abstractmethod
    def _wanted(self, axes: Rotation, free: Six, T_base_tcp: Transform, now: JointState) -> Six:
        """Return the velocity that the free part is to have in the next period, base frame."""

    @abstractmethod
    def _settled(self, step: Yielded, nominal: Setpoint, is_resting: bool) -> None:
        """Update the state at the end of a period."""

    def limit_speed(self, speed: float | None) -> None:
        """Limit the speed at which the TCP yields, m/s; None lifts the limit."""
        self._speed_limit = speed
        self._answer = None

    def forget_warnings(self) -> None:
        """Forget which warnings were emitted."""
        self._notices.said.clear()

    def peek(self, tick: int, nominal: Setpoint, now: JointState) -> Setpoint:
        """See `arm_state.Correction.peek`."""
        return self._next(nominal, now).yielded.setpoint

    def commit(self, tick: int, nominal: Setpoint, now: JointState, is_resting: bool) -> None:
        """See `arm_state.Correction.commit`."""
        step = self._next(nominal, now)
        self._answer = None
        self._axes, self._velocity, self._nominal = step.axes, step.velocity, nominal
        self._tcp = self._body.setup.T_flange_tcp
        if step.obstacle is not None:
            self._warn(
                tick, step.obstacle.code, said("{text}; the arm does not yield further", text=step.obstacle.text)
            )
        elif not step.yielded.is_bound_kept:
            text = said("{name}: the joints cannot follow so fast; the arm leaves its path", name=self.name)
            self._warn(tick, "fast", text)
        if step.is_level and not self.is_on:
            self._selection = NONE_FREE
        self._settled(step.yielded, nominal, is_resting)
        if not self.is_active:
            self._nominal = None
        if step.is_level and not self.is_on:
            self._on_end()

    def pause(self, tick: int) -> None:
        """Come to rest until `resume`."""
        self._is_paused = True
        self._answer = None

    def resume(self, tick: int) -> None:
        """Go on after a pause."""
        self._is_paused = False
        self._answer = None

    def stop(self, tick: int) -> None:
        """Come to rest and end."""
        self.is_on = False
        self._is_paused = False
        self._answer = None

    def _begin(self, selection: tuple[bool, ...], caller: Caller) -> None:
        if not self.is_active:
            self._nominal = None
            self._tcp = None
        self._answer = None
        self._selection = selection
        self._caller = caller
        self.is_on = True

    def _next(self, nominal: Setpoint, now: JointState) -> _Step:
        """Return the next period, computed once for equal conditions."""
        sensor = self._body.sensor
        question = _Question(nominal, now, sensor.external_wrench, sensor.zero, self._body.setup.T_flange_tcp)
        if self._answer is None or self._answer[0] != question:
            self._answer = (question, self._worked_out(nominal, now))
        return self._answer[1]

    def _worked_out(self, nominal: Setpoint, now: JointState) -> _Step:
        body = self._body
        arm, T_flange_tcp = body.arm, body.setup.T_flange_tcp
        target = Setpoint(now.q_target, now.qd_target)
        T_base_tcp = arm.forward_tcp(target.q, T_flange_tcp)
        twist = self._twist(nominal)
        before = self._nominal or target
        way = ZERO_SIX
        if before.q != nominal.q:
            way = way_between(arm.forward_tcp(before.q, T_flange_tcp), arm.forward_tcp(nominal.q, T_flange_tcp))
        axes, selection = self._frame(T_base_tcp, twist), self._selection
        compliance = Compliance(ToolMotion(arm, body.limits, T_flange_tcp, body.deceleration), self.name)
        # About another TCP the same motion has another velocity.
        velocity = self._velocity if T_flange_tcp is self._tcp else self._twist(target)
        free, level = selected(axes, selection, velocity), selected(axes, selection, twist)
        bound, bound_way = _difference(twist, level), _difference(way, selected(axes, selection, way))
        left = self._left_over(axes, _difference(velocity, self._twist(before)))
        is_over = self._is_paused or not self.is_on
        wanted = level
        if not is_over:
            wanted = self._slowed(self._wanted(axes, free, T_base_tcp, now), free)
            if left != ZERO_SIX:
                wanted = _sum(wanted, compliance.nearer(target.q, left, ZERO_SIX, body.deceleration))
        free = _sum(free, left)
        found = compliance.next(
            target, bound, bound_way, free, wanted, deceleration=body.deceleration if is_over else None
        )
        obstacle = found if isinstance(found, Obstacle) else None
        for factor in _HARDER:
            if isinstance(found, Obstacle):
                d = factor * body.deceleration
                found = compliance.next(target, bound, bound_way, free, level, deceleration=d)
        if isinstance(found, Obstacle):
            found = compliance.next(target, bound, bound_way, free, level, is_last_resort=True)
        if isinstance(found, Obstacle):
            halted = compliance.halted(target)
            found = Yielded(halted, _difference(self._twist(halted), bound), True)
        is_level = is_over and (found.free == level or found.setpoint.qd == ZERO_SIX)
        return _Step(found, _sum(bound, found.free), axes, is_level, obstacle)

    def _slowed(self, wanted: Six, free: Six) -> Six:
        if self._speed_limit is None:
            return wanted
        x, y, z, *turn = wanted
        speed = hypot(x, y, z)
        top = max(_BELOW_LIMIT * self._speed_limit, hypot(*free[:3]) - SLOWING_M_S2 * PERIOD_S)
        if speed <= top:
            return wanted
        k = top / speed
        a, b, c = turn
        return (k * x, k * y, k * z, a, b, c)

    def _left_over(self, axes: Rotation, deviation: Six) -> Six:
        """Return the remaining motion beside the nominal one along axes that are no longer free."""
        left = _difference(deviation, selected(axes, self._selection, deviation))
        return ZERO_SIX if max(map(abs, left)) < _ROUNDING else left

    def _twist(self, setpoint: Setpoint) -> Six:
        if setpoint.qd == ZERO_SIX:
            return ZERO_SIX
        return tcp_twist(self._body.arm, *setpoint, self._body.setup.T_flange_tcp)

    def _warn(self, tick: int, kind: str, text: str) -> None:
        line, thread = self._caller
        self._notices.once(line, kind, Warned(tick, text, thread, line))


def _difference(one: Six, other: Six) -> Six:
    a, b, c, d, e, f = [x - y for x, y in zip(one, other, strict=True)]
    return (a, b, c, d, e, f)


def _sum(one: Six, other: Six) -> Six:
    a, b, c, d, e, f = [x + y for x, y in zip(one, other, strict=True)]
    return (a, b, c, d, e, f)
