"""Computes torques, currents and temperatures of the joints at the present tick."""

from __future__ import annotations

from elitescript.controller.arm.dynamics import ArmDynamics
from elitescript.controller.arm.state import ArmState
from elitescript.controller.arm.thermal_model import ThermalModel
from elitescript.controller.tool_setup import Setup
from elitescript.messages.motion import Six
from elitescript.messages.plant import PlantConfig
from elitescript.models.model import RobotModel


class JointLoads:
    """Computes joint loads when they are read; only temperatures sample the joints, every ten seconds.

    Args:
        model: the arm.
        plant: friction of the joints.
        arm_state: its joints.
        setup: its payload.
    """

    __slots__ = ("_arm_state", "_dynamics", "_setup", "_thermal")

    def __init__(self, model: RobotModel, plant: PlantConfig, arm_state: ArmState, setup: Setup) -> None:
        self._arm_state = arm_state
        self._setup = setup
        self._dynamics = ArmDynamics(model, plant)
        self._thermal = ThermalModel(model, self._dynamics)

    def remaining_torques(self, tick: int) -> Six:
        """Return the torques of this tick less those that the arm alone needs, N m."""
        joints, qdd = self._arm_state.joints(tick), self._arm_state.actual_acceleration(tick)
        setup = self._setup
        return self._dynamics.remaining_torques(joints.q_actual, joints.qd_actual, qdd, setup.gravity, setup.payload)

    def measured(self, tick: int) -> tuple[Six, Six]:
        """Return the torques of all joints, N m, and the currents of their motors, A (*assumed*)."""
        joints, qdd = self._arm_state.joints(tick), self._arm_state.actual_acceleration(tick)
        setup = self._setup
        torques = self._dynamics.measured_torques(joints.q_actual, joints.qd_actual, qdd, setup.gravity, setup.payload)
        return torques, self._dynamics.currents(torques)

    def temperatures(self, tick: int) -> tuple[Six, float]:
        """Return temperatures of the joints and of the control box, degC; see `thermal_model`."""
        return self._thermal.temperatures(tick)

    @property
    def known_until(self) -> int:
        """Return the last tick to which `leap` samples nothing."""
        return self._thermal.next_look

    def leap(self, tick: int) -> None:
        """Sample the joints up to a tick that is not later than the next one due."""
        if self._thermal.next_look < tick:
            self._thermal.go_on(self._arm_state, self._setup, tick)
