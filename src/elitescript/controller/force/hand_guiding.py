"""`freedrive_mode`: a hand moves the arm like a mass in a thick fluid.

The hand is the signal `external_wrench`; contact planes act too. Mass, inertia and friction are
*assumed*. The arm does not yield over the ends of the joint ranges and into singularities.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.controller.force.yielding_correction import ArmAccess, Caller, YieldingCorrection
from elitescript.kinematics.rotations import Rotation
from elitescript.kinematics.transforms import Transform, position_of, rotation_of, transform_from_pose
from elitescript.messages.events import Event
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.messages.timing import PERIOD_S
from elitescript.messages.yielding import Freedrive
from elitescript.motion.corrections.admittance import along_axes, in_base, selected
from elitescript.motion.corrections.compliance import Yielded
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.twist import ToolMotion

MASS_KG: Final = 10.0
INERTIA_KG_M2: Final = 0.5
FRICTION_N_S_M: Final = 100.0
FRICTION_N_M_S: Final = 5.0
"""A hand that pushes with 25 N moves the TCP with 0.25 m/s; after it has let go the arm runs on for some 0.1 s."""

_MASS: Final = (MASS_KG,) * 3 + (INERTIA_KG_M2,) * 3
_FRICTION: Final = (FRICTION_N_S_M,) * 3 + (FRICTION_N_M_S,) * 3

STICKING_SPEED: Final = 1e-6
"""Speed below which an arm without a push stands, m/s and rad/s."""
STICKING_WRENCH: Final = 1e-3
"""Wrench below which there is no push, N and N m."""


class HandGuiding(YieldingCorrection):
    """Hand guiding; inactive while the arm stands without a push."""

    __slots__ = ("_R_frame", "_is_at_rest")

    name = "freedrive_mode"

    def __init__(self, body: ArmAccess, on_event: Callable[[Event], None], on_end: Callable[[], None]) -> None:
        super().__init__(body, on_event, on_end)
        self._R_frame: Rotation | None = None
        self._is_at_rest = True

    @property
    def is_active(self) -> bool:
        """Whether the arm moves, or is pushed."""
        if not self._is_at_rest:
            return True
        return self.is_on and not self._is_paused and self._body.sensor.external_wrench != ZERO_SIX

    def begin(self, request: Freedrive, caller: Caller) -> None:
        """Begin hand guiding, or go on with other axes."""
        self._begin(request.free_axes, caller)
        self._R_frame = None if request.frame is None else rotation_of(transform_from_pose(request.frame))
        self._is_at_rest = False

    def resume(self, tick: int) -> None:
        """Go on after a pause."""
        super().resume(tick)
        self._is_at_rest = self._is_at_rest and not self.is_on

    def stop(self, tick: int) -> None:
        """Come to rest and end."""
        if self.is_on:
            self._is_at_rest = False
        super().stop(tick)

    def _frame(self, T_base_tcp: Transform, nominal_twist: Six) -> Rotation:
        return rotation_of(T_base_tcp) if self._R_frame is None else self._R_frame

    def _wanted(self, axes: Rotation, free: Six, T_base_tcp: Transform, now: JointState) -> Six:
        v = along_axes(axes, free)
        f = along_axes(axes, self._push(T_base_tcp, free))
        rows = zip(v, f, _MASS, _FRICTION, strict=True)
        a, b, c, d, e, g = [speed + PERIOD_S / m * (push - k * speed) for speed, push, m, k in rows]
        body = self._body
        tool = ToolMotion(body.arm, body.limits, body.setup.T_flange_tcp, body.deceleration)
        wanted = tool.within_limits(selected(axes, self._selection, in_base(axes, (a, b, c, d, e, g))))
        is_sticking = max(map(abs, wanted)) < STICKING_SPEED and self._is_let_go(axes, T_base_tcp, free)
        return ZERO_SIX if is_sticking else wanted

    def _push(self, T_base_tcp: Transform, free: Six) -> Six:
        """Return the wrench of hand and contacts at the place after the period, which a stiff plane requires."""
        x, y, z = position_of(T_base_tcp)
        p = (x + PERIOD_S * free[0], y + PERIOD_S * free[1], z + PERIOD_S * free[2])
        sensor = self._body.sensor
        return sensor.contact.wrench(p, free[:3], sensor.external_wrench)

    def _is_let_go(self, axes: Rotation, T_base_tcp: Transform, free: Six) -> bool:
        push = selected(axes, self._selection, self._push(T_base_tcp, free))
        return max(map(abs, push)) < STICKING_WRENCH

    def _settled(self, step: Yielded, nominal: Setpoint, is_resting: bool) -> None:
        # The nominal place follows the arm only when this correction becomes inactive here, so a push that ends between
        # two ticks must not end it.
        is_still = step.setpoint.qd == ZERO_SIX
        is_alone = self._is_paused or self._body.sensor.external_wrench == ZERO_SIX
        is_done = not self.is_on and not self.is_yielding
        self._is_at_rest = is_resting and (is_done or (self.is_on and is_still and is_alone))
