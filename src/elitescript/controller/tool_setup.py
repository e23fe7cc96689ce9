"""Holds tool, payload and mounting as programs declare them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.errors import ArgumentRangeError
from elitescript.kinematics.transforms import IDENTITY, Transform, transform_from_pose
from elitescript.messages.machine import SetGravity, SetOption, SetPayload, SetTcp
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value
from elitescript.messages.state import ZERO_SIX, Payload
from elitescript.models.model import RobotModel
from elitescript.said import said


class Setup:
    """Tool, payload, gravity and options of one robot.

    Args:
        model: the arm, with its rated payload.
    """

    __slots__ = ("T_flange_tcp", "_model", "gravity", "options", "payload", "tcp_offset")

    def __init__(self, model: RobotModel) -> None:
        self._model = model
        self.tcp_offset: Six = ZERO_SIX
        self.T_flange_tcp: Transform = IDENTITY
        self.payload = Payload()
        self.gravity = model.gravity
        self.options: dict[str, Value] = {}

    def set_tcp(self, request: SetTcp) -> None:
        """Set the active TCP."""
        self.tcp_offset = request.offset
        self.T_flange_tcp = transform_from_pose(request.offset)

    def set_payload(self, request: SetPayload) -> None:
        """Set the payload at the flange.

        Raises:
            ArgumentRangeError: heavier than the model carries.
        """
        if not 0.0 <= request.mass_kg <= self._model.payload_max_kg:
            raise ArgumentRangeError(
                said(
                    "the {model} carries 0 to {payload_max_kg:g} kg, not {mass_kg:g} kg",
                    model=self._model.name,
                    payload_max_kg=self._model.payload_max_kg,
                    mass_kg=request.mass_kg,
                ),
                value=request.mass_kg,
                limit=f"[0, {self._model.payload_max_kg:g}]",
                unit="kg",
            )
        self.payload = Payload(request.mass_kg, request.cog, request.inertia)

    def set_gravity(self, request: SetGravity) -> None:
        """Set the acceleration of gravity in the base frame."""
        self.gravity = request.vector

    def set_option(self, request: SetOption) -> None:
        """Keep a setting that has no effect on the simulation."""
        self.options[request.name] = request.value


SETUP_HANDLERS: Final[dict[type, Callable[[Setup, Any], None]]] = {
    SetTcp: Setup.set_tcp,
    SetPayload: Setup.set_payload,
    SetGravity: Setup.set_gravity,
    SetOption: Setup.set_option,
}
"""Handlers of the requests that only declare something."""
