"""Compares the arm of a robot at a tick with its safety limits."""

from __future__ import annotations

from collections.abc import Sequence

from elitescript.controller.arm.state import ArmState
from elitescript.controller.safety.force_watch import ForceWatch
from elitescript.controller.safety.limits import SafetyLimits, switched_pairs
from elitescript.controller.safety.monitor import Breach, SafetyMonitor
from elitescript.controller.signals.image import SignalImage
from elitescript.controller.tool_setup import Setup
from elitescript.messages.enums import SafetyMode
from elitescript.messages.motion import Six
from elitescript.messages.state import JointState
from elitescript.motion.limits import MotionLimits, joint_outside


class ArmWatch:
    """Compares one arm, its TCP and the inputs that switch planes on, with the limits.

    Args:
        monitor: the limits.
        motion_limits: limits of the model.
        arm_state: target and actual joints.
        setup: the active TCP.
        signals: inputs of the safety system.
        force: compares the force at the TCP.

    Attributes:
        arm_state: see above.
        force: see above.
    """

    __slots__ = ("_monitor", "_motion_limits", "_setup", "_signals", "arm_state", "force")

    def __init__(
        self,
        monitor: SafetyMonitor,
        motion_limits: MotionLimits,
        arm_state: ArmState,
        setup: Setup,
        signals: SignalImage,
        force: ForceWatch,
    ) -> None:
        self._monitor = monitor
        self._motion_limits = motion_limits
        self._setup = setup
        self._signals = signals
        self.arm_state = arm_state
        self.force = force

    @property
    def limits(self) -> SafetyLimits:
        """The configuration."""
        return self._monitor.limits

    def is_needed(self, mode: SafetyMode) -> bool:
        """Return whether anything can be exceeded in a mode, so that every tick of a motion is checked."""
        return self._monitor.is_watching(mode) or self.force.is_watching

    def is_within(self, q: Six, mode: SafetyMode, pairs: Sequence[bool] | None = None) -> bool:
        """Return whether joints (rad) respect the ranges of the model and the limits of position of a mode.

        Args:
            q: the joints.
            mode: normal or reduced.
            pairs: for each pair of configurable inputs, whether its planes count; by the levels of the inputs if None.
        """
        if joint_outside(self._motion_limits, q) is not None:
            return False
        switched = self._pairs() if pairs is None else pairs
        return self._monitor.position_breach(q, self._setup.T_flange_tcp, mode, switched) is None

    def is_outside(self, tick: int, mode: SafetyMode) -> bool:
        """Return whether the actual joints exceed a limit of position of a mode."""
        q = self.arm_state.joints(tick).q_actual
        return self._monitor.position_breach(q, self._setup.T_flange_tcp, mode, self._pairs()) is not None

    def position_breach(self, joints: JointState, mode: SafetyMode) -> Breach | None:
        """Return the first limit of position that the actual joints exceed, or else the target joints."""
        T_flange_tcp, pairs = self._setup.T_flange_tcp, self._pairs()
        breach = self._monitor.position_breach(joints.q_actual, T_flange_tcp, mode, pairs)
        if breach is None and joints.q_target != joints.q_actual:
            breach = self._monitor.position_breach(joints.q_target, T_flange_tcp, mode, pairs)
        return breach

    def speed_breach(self, joints: JointState, mode: SafetyMode) -> Breach | None:
        """Return the first limit of speed that the actual joints exceed."""
        return self._monitor.speed_breach(joints.q_actual, joints.qd_actual, self._setup.T_flange_tcp, mode)

    def asks_for_reduced(self, joints: JointState) -> bool:
        """Return whether an input or the place of the TCP asks for reduced mode."""
        if self._signals.read("reduced_mode"):
            return True
        return self._monitor.asks_for_reduced(joints.q_actual, self._setup.T_flange_tcp, self._pairs())

    def _pairs(self) -> tuple[bool, ...]:
        return switched_pairs(self._signals.read)
