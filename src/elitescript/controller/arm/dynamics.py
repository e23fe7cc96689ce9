"""Computes joint torques and motor currents of an arm and its payload."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Final

from elitescript.controller.arm.plant import friction_torques
from elitescript.messages.motion import Six
from elitescript.messages.plant import PlantConfig
from elitescript.messages.state import Payload
from elitescript.models.model import RobotModel

_NO_PAYLOAD: Final = Payload()


class ArmDynamics:
    """Torques of one model, N m, positive about the joint; see `kinematics.dynamics`.

    The rigid-body code is imported on first use: few programs ask for torques.

    Args:
        model: geometry and links.
        plant: friction of the joints.
    """

    __slots__ = ("_effort_max", "_has_friction", "_model", "_of_payloads", "_plant", "_qd_max", "_torque_constants")

    def __init__(self, model: RobotModel, plant: PlantConfig | None = None) -> None:
        self._model = model
        self._plant = PlantConfig() if plant is None else plant
        self._has_friction = self._plant.coulomb_friction > 0.0 or self._plant.viscous_friction > 0.0
        self._qd_max = tuple([joint.qd_max for joint in model.joints])
        self._effort_max = tuple([joint.effort_max for joint in model.joints])
        self._torque_constants = tuple([joint.torque_constant for joint in model.joints])
        self._of_payloads: tuple[tuple[Payload, Callable[..., Six]], ...] = ()
        """Torques of masses and inertias for the payloads that were used last."""

    def measured_torques(self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float], payload: Payload) -> Six:
        """Return the torques of all joints, friction included.

        The declared payload is the load at the flange (*assumed*), and nothing else touches the arm.
        """
        return self._with_friction(self.rigid_torques(q, qd, qdd, gravity, payload), qd)

    def remaining_torques(
        self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float], payload: Payload
    ) -> Six:
        """Return the torques less those that the arm alone needs; exactly zero without a payload."""
        m1, m2, m3, m4, m5, m6 = self.rigid_torques(q, qd, qdd, gravity, payload)
        o1, o2, o3, o4, o5, o6 = self.rigid_torques(q, qd, qdd, gravity, _NO_PAYLOAD)
        return m1 - o1, m2 - o2, m3 - o3, m4 - o4, m5 - o5, m6 - o6

    def currents(self, torques: Six) -> Six:
        """Return the motor currents for joint torques, A; the torque constants are *assumed*."""
        a, b, c, d, e, f = torques
        g, h, i, j, k, m = self._torque_constants
        return (a / g, b / h, c / i, d / j, e / k, f / m)

    def _with_friction(self, torques: Six, qd: Six) -> Six:
        if not self._has_friction:
            return torques
        a, b, c, d, e, f = torques
        g, h, i, j, k, m = friction_torques(self._plant, qd, self._qd_max, self._effort_max)
        return (a + g, b + h, c + i, d + j, e + k, f + m)

    def rigid_torques(self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float], payload: Payload) -> Six:
        """Return the torques of masses and inertias, without friction."""
        for of, torques in self._of_payloads:
            if of is payload:
                return torques(q, qd, qdd, gravity)
        from elitescript.kinematics.dynamics import RigidBody, mass_chain, torques_of

        links = [RigidBody(link.mass, link.com, link.inertia) for link in self._model.links]
        carried = RigidBody(payload.mass_kg, payload.cog, payload.inertia)
        torques = partial(torques_of, mass_chain(self._model.arm, links, carried))
        # The payload that is set, and none.
        self._of_payloads = ((payload, torques), *self._of_payloads[:1])
        return torques(q, qd, qdd, gravity)
