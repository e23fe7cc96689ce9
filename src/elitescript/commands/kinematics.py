"""Converts joint positions to poses and back (manual 2.10 sections 2.2.1 to 2.2.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Final

from elitescript.commands.definition.quantities import (
    Bool,
    JointPositions,
    Number,
    OptionalJoints,
    OptionalTcp,
    Pose,
    Vector,
)
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import COMPUTED, COMPUTED_IN_BASE
from elitescript.errors import MotionError
from elitescript.kinematics.inverse import Solution, nearest, reason_unreachable, solutions
from elitescript.kinematics.transforms import Transform, compose, inverse, pose_from_transform, transform_from_pose
from elitescript.messages.motion import Six
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Machine, Robot
_ARGUMENTS: Final = {
    "p": "pose of the TCP in the base frame.",
    "qnear": "joint positions to stay near; without them the present ones.",
    "tcp": "transform from the flange to the TCP; without it the active one.",
}
"""Texts of arguments that several commands share."""


def flange_target(machine: Machine, p: Six, tcp: Six | None = None) -> Transform:
    """Return `T_base_flange` that brings the TCP to `p`; without `tcp` the active one."""
    offset = machine.tcp_offset if tcp is None else tcp
    return compose(transform_from_pose(p), inverse(transform_from_pose(offset)))


def nearest_solution(
    machine: Machine, T_base_flange: Transform, qnear: Six | None = None
) -> tuple[Solution | None, tuple[Solution, ...]]:
    """Return the solution nearest to `qnear`, or to the present joint positions, and all solutions."""
    q_near = machine.joints().q_actual if qnear is None else qnear
    candidates = solutions(machine.arm, T_base_flange, q_near[5])
    return nearest(candidates, q_near, machine.joint_ranges), candidates


@command(family="math", manual="2.2.1", arguments=_ARGUMENTS)
def get_inverse_kin(
    robot: Robot, p: Pose, qnear: OptionalJoints = None, tcp: OptionalTcp = None
) -> Annotated[JointPositions, COMPUTED]:
    """Return joint positions that bring the TCP to a pose.

    Of all solutions and their full turns inside the joint limits it is the one with the least sum of squared joint
    differences to `qnear` (*assumed*: the manual says nearest).

    Raises:
        MotionError: the pose is out of reach or outside the joint limits; `get_inverse_kin_has_solution` tests that.
    """
    machine = robot.machine
    T_base_flange = flange_target(machine, p, tcp)
    solution, candidates = nearest_solution(machine, T_base_flange, qnear)
    if solution is not None:
        return solution.q
    reason = reason_unreachable(machine.arm, T_base_flange)
    if candidates:
        reason = said("each of the {count} solutions has a joint outside its limits", count=len(candidates))
    shown_pose = ", ".join(f"{number:.6g}" for number in p)
    raise MotionError(
        said("no joint position reaches the pose [{shown_pose}]: {reason}", shown_pose=shown_pose, reason=reason),
        code="R110" if candidates else "R111",
        argument="p",
        value=list(p),
        unit="m, rad",
        hint="ask get_inverse_kin_has_solution first",
    )


@command(family="math", manual="2.2.2", arguments=_ARGUMENTS)
def get_inverse_kin_has_solution(
    robot: Robot, p: Pose, qnear: OptionalJoints = None, tcp: OptionalTcp = None
) -> Annotated[Bool, COMPUTED]:
    """Return whether `get_inverse_kin` would find joint positions.

    Returns:
        True if it would.
    """
    solution, _ = nearest_solution(robot.machine, flange_target(robot.machine, p, tcp), qnear)
    return solution is not None


@command(family="math", since="2.14", manual="2.14: 3.2.3", arguments=_ARGUMENTS)
def get_all_inverse_kin(
    robot: Robot, p: Pose, tcp: OptionalTcp = None
) -> Annotated[tuple[Six, ...], Vector(Vector(Number(), 6, "rad"), None, "rad"), COMPUTED]:
    """Return all joint positions that bring the TCP to a pose, without full turns; joint limits do not count.

    Returns:
        One list of six angles in [-pi, pi] for each solution, empty when there is none: shoulder on the near side
        first, inside that wrist 2 positive first, inside that the elbow positive first.
    """
    return tuple(solution.q for solution in solutions(robot.machine.arm, flange_target(robot.machine, p, tcp)))


@command(family="math", manual="2.2.3", arguments=_ARGUMENTS)
def get_forward_kin(
    robot: Robot, q: OptionalJoints = None, tcp: OptionalTcp = None
) -> Annotated[Pose, COMPUTED_IN_BASE]:
    """Return the pose of the TCP that joint positions give.

    Args:
        q: joint positions; without them the present ones.

    Returns:
        [x, y, z, Rx, Ry, Rz] in the base frame, roll-pitch-yaw.
    """
    machine = robot.machine
    offset = machine.tcp_offset if tcp is None else tcp
    joints = machine.joints().q_actual if q is None else q
    return pose_from_transform(machine.arm.forward_tcp(joints, transform_from_pose(offset)))
