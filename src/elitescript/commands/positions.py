"""Positions, speeds, temperatures and torques of the arm (manual 2.10 chapter 2.1).

*Target* is what the controller commands in this tick, *actual* what the encoders measure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import JointPositions, JointSpeeds, Number, Pose, TcpSpeed, Vector
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMMANDED, COMMANDED_IN_BASE, MEASURED, MEASURED_IN_BASE
from elitescript.messages.motion import Six

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="motion", manual="2.1.4")
def get_actual_joint_positions(robot: Robot) -> Annotated[JointPositions, MEASURED]:
    """Return the measured joint positions.

    They are the target positions, unless the plant of the simulated robot has a lag or noise; then they are behind the
    target while the arm moves, as those of a real arm.
    """
    return robot.machine.joints().q_actual


@command(family="motion", manual="2.1.5")
def get_actual_joint_speeds(robot: Robot) -> Annotated[JointSpeeds, MEASURED]:
    """Return the measured joint speeds."""
    return robot.machine.joints().qd_actual


@command(family="motion", manual="2.1.6")
def get_actual_tcp_pose(robot: Robot) -> Annotated[Pose, MEASURED_IN_BASE]:
    """Return the pose of the TCP in the base frame, from the measured joint positions and the active TCP offset.

    Returns:
        [x, y, z, Rx, Ry, Rz], roll-pitch-yaw.
    """
    return robot.machine.poses().actual


@command(family="motion", manual="2.1.7")
def get_actual_tcp_speed(robot: Robot) -> Annotated[TcpSpeed, MEASURED]:
    """Return the measured velocity of the TCP.

    Returns:
        [Vx, Vy, Vz, RVx, RVy, RVz]: linear velocity, then the angular velocity vector, both in the base frame
        (*assumed* for the linear part). The angular part is not the rate of Rx, Ry, Rz.
    """
    return robot.machine.tcp_speeds().actual


@command(family="motion", manual="2.1.8")
def get_controller_temperature(robot: Robot) -> Annotated[float, Number("degC"), MEASURED]:
    """Return the temperature of the mainboard in the control box; it rises with the load of the joints (*assumed*).

    Returns:
        The temperature.
    """
    return robot.machine.controller_temperature


@command(family="motion", manual="2.1.9")
def get_joint_temperatures(robot: Robot) -> Annotated[Six, Vector(Number(), 6, "degC"), MEASURED]:
    """Return the temperatures of the joints; they rise with torque and speed over some 20 minutes (*assumed*).

    Returns:
        [base, shoulder, elbow, wrist1, wrist2, wrist3].
    """
    return robot.machine.joint_temperatures


@command(family="motion", manual="2.1.10")
def get_joint_torques(robot: Robot) -> Annotated[Six, Vector(Number(), 6, "Nm"), MEASURED]:
    """Return the torques of the joints, without what the arm needs to carry and move itself.

    The payload is not part of the arm (*assumed*; the manual speaks of the robot itself): what remains is the torque
    that carries and moves the payload set by `set_payload`, and it is zero while none is set. Friction, if the plant
    has any, is corrected for.

    Returns:
        [base, shoulder, elbow, wrist1, wrist2, wrist3], as the joints apply them, positive in the direction in which
        the joint counts (*assumed*).
    """
    return robot.machine.joint_torques()


@command(family="motion", manual="2.1.11")
def get_target_joint_positions(robot: Robot) -> Annotated[JointPositions, COMMANDED]:
    """Return the commanded joint positions."""
    return robot.machine.joints().q_target


@command(family="motion", manual="2.1.12")
def get_target_joint_speeds(robot: Robot) -> Annotated[JointSpeeds, COMMANDED]:
    """Return the commanded joint speeds."""
    return robot.machine.joints().qd_target


@command(family="motion", manual="2.1.13")
def get_target_tcp_pose(robot: Robot) -> Annotated[Pose, COMMANDED_IN_BASE]:
    """Return the pose of the TCP in the base frame, from the commanded joint positions and the active TCP offset.

    Returns:
        [x, y, z, Rx, Ry, Rz], roll-pitch-yaw.
    """
    return robot.machine.poses().target


@command(family="motion", manual="2.1.14")
def get_target_tcp_speed(robot: Robot) -> Annotated[TcpSpeed, COMMANDED]:
    """Return the commanded velocity of the TCP.

    Returns:
        [Vx, Vy, Vz, RVx, RVy, RVz], as `get_actual_tcp_speed`.
    """
    return robot.machine.tcp_speeds().target


@command(family="motion", manual="2.1.31")
def get_actual_tool_flange_pose(robot: Robot) -> Annotated[Pose, MEASURED_IN_BASE]:
    """Return the measured pose of the flange in the base frame; the TCP offset does not count.

    Returns:
        [x, y, z, Rx, Ry, Rz], roll-pitch-yaw.
    """
    return robot.machine.poses().flange


@command(family="motion", manual="2.1.32")
def get_target_waypoint(robot: Robot) -> Annotated[Pose, COMMANDED_IN_BASE]:
    """Return the pose of the waypoint that the arm moves to.

    Returns:
        [x, y, z, Rx, Ry, Rz] in the base frame; at standstill the last waypoint, before the first move the target
        pose of the TCP (*assumed*).
    """
    return robot.machine.target_waypoint
