"""Runs force control, hand guiding and the force sensor of one robot, one of them at a time."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, TypeGuard

from elitescript.controller.arm.state import ArmState
from elitescript.controller.force.contact import ContactConfig
from elitescript.controller.force.force_control import ForceControl
from elitescript.controller.force.hand_guiding import HandGuiding
from elitescript.controller.force.wrench_sensor import WrenchSensor
from elitescript.controller.force.yielding_correction import ArmAccess, Caller, YieldingCorrection
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tool_setup import Setup
from elitescript.errors import MotionError
from elitescript.messages.events import Event, Warned, YieldingChanged
from elitescript.messages.machine import SetClientSensor, SetForceDamping, SetForceGain, ZeroForceSensor
from elitescript.messages.motion import MotionRequest, Six, StopJ, StopL, StopTracking, TrackRequest
from elitescript.messages.state import JointState
from elitescript.messages.timing import TICKS_PER_S
from elitescript.messages.yielding import EndForceMode, EndFreedrive, ForceMode, Freedrive, YieldRequest
from elitescript.models.model import RobotModel
from elitescript.motion.limits import MotionLimits
from elitescript.said import Said, said

if TYPE_CHECKING:
    from elitescript.messages.observations import Observation

FORCE_CALL: Final = -1
GUIDING_CALL: Final = -2
"""Numbers of the calls that wait for the end; numbers of moves are positive."""

DONE_CALL: Final = 0
"""Number of a call that is over at once."""

FREE_TICKS: Final = TICKS_PER_S // 2
"""Shortest time in force mode of which it is observed that it has met nothing (*assumed*)."""


class ComplianceControl:
    """Carries out the requests about forces.

    Args:
        model: the arm.
        limits: of its motions.
        setup: TCP, payload and gravity.
        signals: for `external_wrench` and the inputs of hand guiding.
        contact: what the TCP can touch; None for nothing.
        on_event: receives events.
        on_end: called with the number of a call that waits for the end, and whether it was complete, when it is over.
    """

    __slots__ = (
        "_force",
        "_force_tick",
        "_guiding",
        "_is_asked_by_input",
        "_is_guided_by_input",
        "_on_event",
        "_signals",
        "observe",
        "sensor",
    )

    def __init__(
        self,
        model: RobotModel,
        limits: MotionLimits,
        setup: Setup,
        signals: SignalImage,
        contact: ContactConfig | None,
        on_event: Callable[[Event], None],
        on_end: Callable[[int, bool], None],
    ) -> None:
        self.sensor = WrenchSensor(model.arm, setup, signals, contact or ContactConfig())
        body = ArmAccess(model.arm, limits, model.stop_joint_deceleration, setup, self.sensor)
        self._force = ForceControl(body, on_event, lambda: on_end(FORCE_CALL, True))
        self._guiding = HandGuiding(body, on_event, lambda: on_end(GUIDING_CALL, True))
        self._on_event = on_event
        self._signals = signals
        self._force_tick = 0
        self.observe: Callable[[Observation], None] | None = None
        """Takes what observers of a run may see."""
        self._is_asked_by_input = False
        self._is_guided_by_input = False

    @property
    def corrections(self) -> tuple[YieldingCorrection, ...]:
        """Corrections for `ArmState`; at most one is active."""
        return self._force, self._guiding

    def limit_speed(self, speed: float | None) -> None:
        """Limit the speed at which the TCP yields, m/s; None lifts the limit."""
        for correction in self.corrections:
            correction.limit_speed(speed)

    def begin_program(self) -> None:
        """Forget which warnings were emitted: a program begins."""
        self._force.forget_warnings()
        self._guiding.forget_warnings()

    def request(self, request: YieldRequest | StopJ | StopL, tick: int, is_moving: bool, caller: Caller) -> int:
        """Begin or end force mode or hand guiding; return the number of the call.

        Args:
            request: begin or end.
            tick: the present one.
            is_moving: whether another motion is under way.
            caller: line and thread of the request.

        Raises:
            MotionError: two things at once; nothing has changed.
        """
        force = self._force
        if isinstance(request, ForceMode):
            self._require_no_guiding("force_mode")
            if not force.is_on:
                self._force_tick = tick
            force.begin(request, caller)
            self._report(tick, request, caller)
            return DONE_CALL
        if isinstance(request, EndForceMode):
            if force.is_on:
                if not force.has_met and tick - self._force_tick >= FREE_TICKS:
                    self._tell_free(tick)
                force.stop(tick)
                self._report(tick, request, caller)
            return FORCE_CALL if force.is_yielding else DONE_CALL
        if isinstance(request, EndFreedrive | StopJ | StopL):
            return self._end_guiding(tick, caller)
        if force.is_active or is_moving:
            raise MotionError(
                said(
                    "hand guiding cannot begin {when}",
                    when=Said("in force mode") if force.is_active else Said("while the arm moves"),
                ),
                code="R114",
                hint=said("call {command} first", command="end_force_mode" if force.is_active else "stopj"),
            )
        self._guide(request, tick, caller)
        self._is_guided_by_input = False
        return DONE_CALL

    def _tell_free(self, tick: int) -> None:
        """Let observers see that force mode ends and has met nothing, though it was to exert something."""
        force = self._force
        if any(force.target) and self.observe is not None:
            from elitescript.messages.observations import ForceMetNothing

            line, thread = force.caller
            self.observe(ForceMetNothing(tick, line, thread, force.target, tick - self._force_tick))

    def is_ended_by(self, request: MotionRequest | TrackRequest) -> TypeGuard[StopJ | StopL]:
        """Check that a motion may begin; return whether it is a stop that ends hand guiding.

        Raises:
            MotionError: the arm is guided by hand; or is in force mode, and a conveyor is to be tracked.
        """
        if isinstance(request, StopJ | StopL):
            return self.is_guiding
        if not isinstance(request, StopTracking):
            self._require_no_guiding(type(request).__name__.lower())
            if isinstance(request, TrackRequest) and self._force.is_active:
                raise MotionError(
                    "conveyor tracking cannot begin in force mode", code="R114", hint="begin it before force_mode"
                )
        return False

    def wrench(self, arm: ArmState, tick: int, is_compensated: bool) -> Six:
        """Return the wrench on the TCP at the present tick, TCP frame."""
        joints = arm.joints(tick)
        if is_compensated:
            return self.sensor.compensated(joints.q_actual, joints.qd_actual)
        return self.sensor.raw(joints.q_actual, joints.qd_actual, lambda: arm.actual_acceleration(tick))

    def wrenches(self, arm: ArmState, tick: int) -> tuple[Six, Six]:
        """Return the wrench on the TCP at the present tick, compensated and raw, TCP frame."""
        joints = arm.joints(tick)
        return self.sensor.readings(joints.q_actual, joints.qd_actual, lambda: arm.actual_acceleration(tick))

    def is_done(self, call: int) -> bool:
        """Return whether the call of that number is over."""
        if call == FORCE_CALL:
            return not self._force.is_yielding
        return call != GUIDING_CALL or not self._guiding.is_active

    def guide_by_input(self, why_not: str, arm: ArmState, tick: int) -> None:
        """Begin hand guiding when a bound input is high, and end it when none is.

        Args:
            why_not: why the arm may not move; empty if it may.
            arm: must stand at the beginning.
            tick: present tick.
        """
        point = self._signals.freedrive_point
        is_asked = point is not None
        if is_asked == self._is_asked_by_input:
            return
        self._is_asked_by_input = is_asked
        if not is_asked:
            if self._is_guided_by_input:
                self._end_guiding(tick, Caller(0, ""))
            return
        if arm.is_moving:
            why_not = why_not or "the arm moves already"
        if why_not:
            self._on_event(
                Warned(tick, said("{point} asks for hand guiding, but {why_not}", point=point, why_not=why_not))
            )
        elif not self._guiding.is_on:
            self._guide(Freedrive((True,) * 6), tick, Caller(0, ""))
            self._is_guided_by_input = True

    @property
    def force_caller(self) -> Caller | None:
        """Line and thread that have begun force mode; None if it is off."""
        return self._force.caller if self._force.is_on else None

    @property
    def is_guiding(self) -> bool:
        """Whether hand guiding is on, or the arm still comes to rest after it."""
        return self._guiding.is_on or self._guiding.is_active

    @property
    def is_guided_by_input(self) -> bool:
        """Whether an input has begun hand guiding."""
        return self._is_guided_by_input

    def _guide(self, request: Freedrive, tick: int, caller: Caller) -> None:
        self._guiding.begin(request, caller)
        self._report(tick, request, caller)

    def _end_guiding(self, tick: int, caller: Caller) -> int:
        self._is_guided_by_input = False
        if self._guiding.is_on:
            self._guiding.stop(tick)
            self._report(tick, EndFreedrive(), caller)
        return GUIDING_CALL if self._guiding.is_active else DONE_CALL

    def set_gain(self, request: SetForceGain, _joints: JointState) -> None:
        """Set the gain scaling of the next force mode."""
        self._force.gain_scaling = request.scaling

    def set_damping(self, request: SetForceDamping, _joints: JointState) -> None:
        """Set the damping of the next force mode."""
        self._force.damping = request.damping

    def set_client_sensor(self, request: SetClientSensor, _joints: JointState) -> None:
        """Read a client's sensor, or the arm's again."""
        self.sensor.client_offset = request.offset if request.is_enabled else None

    def zero_sensor(self, _request: ZeroForceSensor, joints: JointState) -> None:
        """Take the present wrench as zero."""
        self.sensor.tare(joints.q_actual, joints.qd_actual)

    def _report(self, tick: int, request: YieldRequest, caller: Caller) -> None:
        self._on_event(YieldingChanged(tick, request, caller.line, caller.thread))

    def _require_no_guiding(self, what: str) -> None:
        if self._guiding.is_on or self._guiding.is_active:
            raise MotionError(
                said("{what} is not possible while the arm is guided by hand", what=what),
                code="R114",
                hint="call end_freedrive_mode first",
            )


YIELD_SETTINGS: Final[dict[type, Callable[[ComplianceControl, Any, JointState], None]]] = {
    SetForceGain: ComplianceControl.set_gain,
    SetForceDamping: ComplianceControl.set_damping,
    ZeroForceSensor: ComplianceControl.zero_sensor,
    SetClientSensor: ComplianceControl.set_client_sensor,
}
"""Handlers of the requests that only set a parameter."""
