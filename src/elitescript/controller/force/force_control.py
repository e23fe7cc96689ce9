"""`force_mode`: the selected axes yield until the arm presses with the target wrench.

The law is in `motion.corrections.admittance`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.controller.force.yielding_correction import ArmAccess, Caller, YieldingCorrection
from elitescript.kinematics.rotations import Rotation
from elitescript.kinematics.transforms import IDENTITY, Transform, transform_from_pose
from elitescript.messages.events import Event
from elitescript.messages.motion import Six
from elitescript.messages.state import ZERO_SIX, JointState
from elitescript.messages.yielding import ForceMode
from elitescript.motion.corrections.admittance import ForceFrame, ForceLaw, along_axes, in_base
from elitescript.motion.corrections.compliance import Yielded
from elitescript.motion.segment import Setpoint

GAIN_SCALING_START = 0.2
DAMPING_START = 0.0


MET_N: Final = 0.5
"""Force on the tool, N or N m, from which on it has met something (*assumed*)."""


class ForceControl(YieldingCorrection):
    """Force control; every tick is due while it is on.

    Gain scaling and damping are read when force mode begins and kept until they are set again, over the ends of
    programs.
    """

    __slots__ = ("_force_frame", "_is_held", "_law", "damping", "gain_scaling", "has_met")

    name = "force_mode"

    def __init__(self, body: ArmAccess, on_event: Callable[[Event], None], on_end: Callable[[], None]) -> None:
        super().__init__(body, on_event, on_end)
        self.gain_scaling = GAIN_SCALING_START
        self.damping = DAMPING_START
        self._force_frame = ForceFrame(0, IDENTITY)
        self._law = ForceLaw((False,) * 6, ZERO_SIX, ZERO_SIX, GAIN_SCALING_START, DAMPING_START)
        self._is_held = False
        self.has_met = False
        """Whether something has pressed against the tool since force mode began."""

    @property
    def target(self) -> Six:
        """What the free axes are to exert, N and N m; 0 along the others."""
        a, b, c, d, e, f = (
            wanted if is_free else 0.0 for wanted, is_free in zip(self._law.target, self._law.selection, strict=True)
        )
        return a, b, c, d, e, f

    @property
    def is_active(self) -> bool:
        """Whether force mode is on, comes to rest, or has left the arm beside a nominal motion that goes on."""
        return self.is_on or self._is_held

    def begin(self, request: ForceMode, caller: Caller) -> None:
        """Begin force mode, or go on with other values."""
        is_update = self.is_on
        if not is_update:
            self.has_met = False
        frame = ForceFrame(request.mode, transform_from_pose(request.reference_frame))
        self._begin(request.selection, caller)
        if not is_update or frame != self._force_frame:
            self._axes = frame.at_start()
        self._force_frame = frame
        # Scaling and damping of the entry hold until the mode is left.
        gain_scaling, damping = (
            (self._law.gain_scaling, self._law.damping) if is_update else (self.gain_scaling, self.damping)
        )
        self._law = ForceLaw(request.selection, request.target, request.speed_limits, gain_scaling, damping)
        self._is_held = True

    def _frame(self, T_base_tcp: Transform, nominal_twist: Six) -> Rotation:
        return self._force_frame.axes(T_base_tcp, nominal_twist[:3], self._axes)

    def _wanted(self, axes: Rotation, free: Six, T_base_tcp: Transform, now: JointState) -> Six:
        exerted = along_axes(axes, self._body.sensor.compensated_in_base(now.q_actual, now.qd_actual))
        if not self.has_met:
            self.has_met = max(map(abs, exerted)) > MET_N
        a, b, c, d, e, f = exerted
        return in_base(axes, self._law.speeds(along_axes(axes, free), (-a, -b, -c, -d, -e, -f)))

    def _settled(self, step: Yielded, nominal: Setpoint, is_resting: bool) -> None:
        # Beside the nominal place the joints may have to brake longer than those of the nominal motion.
        is_still = step.setpoint.qd == ZERO_SIX
        if is_resting and is_still and not self.is_on and not self.is_yielding:
            self._is_held = False
