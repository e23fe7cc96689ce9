"""What the joints of a model have to apply: the arm alone, and with what it carries."""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.messages.motion import Six
from elitescript.messages.state import Payload
from elitescript.models.model import RobotModel

if TYPE_CHECKING:
    from elitescript.kinematics.dynamics import Body


class ArmDynamics:
    """Torques of one model, N m, positive about the joint; see `kinematics.dynamics`.

    Few programs ask for torques; the others pay neither for the import nor for the links.

    Args:
        model: geometry and links.
    """

    __slots__ = ("_links", "_model")

    def __init__(self, model: RobotModel) -> None:
        self._model = model
        self._links: tuple[Body, ...] = ()

    def own_torques(self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float]) -> Six:
        """Return what the arm needs to carry and to move itself."""
        return self._torques(q, qd, qdd, gravity, Payload())

    def measured_torques(self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float], payload: Payload) -> Six:
        """Return what the joints apply altogether.

        What is declared as payload is what hangs on the flange (*assumed*), and nothing else touches the arm.
        """
        return self._torques(q, qd, qdd, gravity, payload)

    def remaining_torques(
        self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float], payload: Payload
    ) -> Six:
        """Return the measured torques less those that the arm needs itself; exactly zero without a payload."""
        m1, m2, m3, m4, m5, m6 = self.measured_torques(q, qd, qdd, gravity, payload)
        o1, o2, o3, o4, o5, o6 = self.own_torques(q, qd, qdd, gravity)
        return m1 - o1, m2 - o2, m3 - o3, m4 - o4, m5 - o5, m6 - o6

    def _torques(self, q: Six, qd: Six, qdd: Six, gravity: tuple[float, float, float], payload: Payload) -> Six:
        from elitescript.kinematics.dynamics import Body, joint_torques

        if not self._links:
            self._links = tuple([Body(link.mass, link.com, link.inertia) for link in self._model.links])
        carried = Body(payload.mass_kg, payload.cog, payload.inertia)
        return joint_torques(self._model.arm, self._links, q, qd, qdd, gravity, carried)
