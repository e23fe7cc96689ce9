"""Tool, payload and mounting of the arm (manual 2.10 chapter 2.1)."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import Number, TcpOffset, Vector
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMMANDED
from elitescript.messages.machine import SetGravity, SetPayload, SetTcp
from elitescript.messages.motion import Six
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

GRAVITY_RANGE: Final = (9.6, 10.0)
"""Range of `set_gravity` on earth, m/s^2; other values are accepted with a warning."""

CentreOfGravity = Annotated[
    tuple[float, float, float], Vector(Number(), 3, "m", "[CoGx, CoGy, CoGz]", meaning="centre of gravity")
]


@command(family="motion", manual="2.1.19")
def set_tcp(robot: Robot, pose: TcpOffset) -> None:
    """Set the active TCP.

    Cartesian moves, readings of the TCP and the kinematics commands use it from now on; the arm does not move.

    Args:
        pose: transform from the flange to the TCP.
    """
    robot.request(SetTcp(pose))


@command(family="motion", manual="2.1.33")
def get_tcp_offset(robot: Robot) -> Annotated[TcpOffset, COMMANDED]:
    """Return the active TCP.

    Returns:
        Transform from the flange to the TCP, [x, y, z, Rx, Ry, Rz].
    """
    return robot.machine.tcp_offset


@command(family="motion", manual="2.1.16")
def set_payload(
    robot: Robot,
    m: Annotated[float, Number("kg", 0.0, meaning="payload")],
    CoG: CentreOfGravity,
    inertia: Annotated[Six, Vector(Number(), 6, "kg*m^2", "[Ixx, Iyy, Izz, Ixy, Ixz, Iyz]")] = (0, 0, 0, 0, 0, 0),
) -> None:
    """Set the load on the flange; to be called whenever a part is gripped or put down.

    A centre of gravity farther away than the arm reaches, and an inertia that no body has, are taken as they are, with
    a warning: the manual sets a limit for the mass alone.

    Args:
        m: mass, at most the nominal load of the model.
        CoG: centre of gravity in the flange frame.
        inertia: moments and products of inertia about the centre of gravity.

    Raises:
        ArgumentRangeError: `m` is negative or above the nominal load of the model.
    """
    robot.request(SetPayload(m, CoG, inertia))
    if any(inertia):
        from elitescript.kinematics.inertia import is_inertia_of_a_body

        if not is_inertia_of_a_body(inertia):
            robot.warn_once(
                "set_payload inertia",
                said(
                    "set_payload: no body has the inertia {inertia} kg*m^2: a principal moment is negative "
                    "or larger than the sum of the other two; the order is [Ixx, Iyy, Izz, Ixy, Ixz, Iyz]",
                    inertia=list(inertia),
                ),
            )


@command(family="motion", manual="2.1.17")
def get_target_payload_cog(robot: Robot) -> Annotated[CentreOfGravity, COMMANDED]:
    """Return the centre of gravity of the payload that is set.

    Returns:
        [CoGx, CoGy, CoGz] in the flange frame.
    """
    return robot.machine.payload.cog


@command(family="motion", manual="2.1.18")
def get_target_payload_mass(robot: Robot) -> Annotated[float, Number("kg", 0.0), COMMANDED]:
    """Return the mass of the payload that is set.

    Returns:
        The mass.
    """
    return robot.machine.payload.mass_kg


@command(family="motion", manual="2.1.15")
def set_gravity(robot: Robot, d: Annotated[tuple[float, float, float], Vector(Number(), 3, "m/s^2")]) -> None:
    """Set how the arm is mounted, by the acceleration that its base feels.

    Any vector is taken; one that is not about 9.82 m/s^2 long draws a warning.

    Args:
        d: acceleration in the base frame; it points away from the earth, [0, 0, 9.82] for an arm on the floor.
    """
    robot.request(SetGravity(d))
    size, (low, high) = hypot(*d), GRAVITY_RANGE
    if not low <= size <= high:
        robot.warn_once(
            "set_gravity",
            said(
                "set_gravity: d is {size:g} m/s^2 long; on earth it is 9.82, and points away from the earth", size=size
            ),
        )
