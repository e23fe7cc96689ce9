"""Moves to a target and stops (manual 2.10 chapter 2.1).

A move is requested on the script's own line: limits, reach and the passage of singularities are checked there, before
anything moves. How the arm gets to its target is part of the motion package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from elitescript.commands.definition.quantities import (
    BlendRadius,
    JointAcceleration,
    JointDeceleration,
    JointPositions,
    JointSpeed,
    Pose,
    Seconds,
    ToolAcceleration,
    ToolDeceleration,
    ToolSpeed,
    Whole,
)
from elitescript.commands.definition.registry import command
from elitescript.messages.motion import MoveC, MoveJ, MoveL, StopJ, StopL
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


def blend_radius(robot: Robot, r: float) -> float:
    """Return the radius for an argument r, m: 0 for one below 0, with one warning."""
    if r < 0.0:
        robot.warn_once("negative radius", negative_radius_text(r), code="W250", hint=NEGATIVE_RADIUS_HINT)
        return 0.0
    return r


def negative_radius_text(r: float) -> str:
    """Return the message about a blend radius below 0, before and during the run."""
    return said("r = {r:g} m is taken for 0: the arm stops at the waypoint", r=r)


NEGATIVE_RADIUS_HINT = "write r=0 to stop there"


@command(family="motion", manual="2.1.1", waits=True, works_in_sec=False)
def movej(
    robot: Robot,
    q: JointPositions,
    a: JointAcceleration = 1.396263,
    v: JointSpeed = 1.047197,
    t: Seconds = 0,
    r: BlendRadius = 0,
) -> None:
    """Move straight in joint space to `q`; return when the move ends or its blend begins.

    All joints start and end together; the joint with the longest way sets the pace. Speeds follow the speed
    percentage. Six numbers are always joint positions here; turn a pose into joints with `get_inverse_kin`.

    Args:
        q: target joint positions.
        a: acceleration of the leading joint; 0 takes the machine's default (*assumed*). What exceeds the model's
            limit is lowered to it.
        v: speed of the leading joint; 0 takes the machine's default (*assumed*). What exceeds the model's limit
            is lowered to it.
        t: duration of the whole move; `a` and `v` do not count then. 0 plans from `a` and `v`.
        r: blend radius; 0 stops at the target. How fast the arm passes a waypoint follows from `r`, `a` and the length
            of the move: see "Which radius for which speed" in docs/explanation/motion.md. Down to -0.001 it counts as
            0 (*observed*: generators write that for no rounding).

    Raises:
        MotionError: the target is outside the joint limits.
        ScriptStateError: the arm is not ready, or another thread moves it.
    """
    default_a, default_v, _, _ = robot.machine.default_motion
    robot.move(MoveJ(q, a or default_a, v or default_v, t, blend_radius(robot, r)))


@command(family="motion", manual="2.1.3", waits=True, works_in_sec=False)
def movel(
    robot: Robot,
    p: Pose,
    a: ToolAcceleration = 1.2,
    v: ToolSpeed = 0.25,
    t: Seconds = 0,
    r: BlendRadius = 0,
) -> None:
    """Move the TCP on a straight line to the pose `p`; return when the move ends or its blend begins.

    The orientation turns about one fixed axis, in step with the path. For a turn on the spot `a` and `v` count as
    rad/s^2 and rad/s (*assumed*). Speeds follow the speed percentage; where a joint would have to turn faster than
    it can, the whole path goes slower.

    Args:
        p: target pose of the TCP in the base frame, roll-pitch-yaw.
        a: tool acceleration; 0 takes the machine's default (*assumed*).
        v: tool speed; 0 takes the machine's default (*assumed*).
        t: duration of the whole move; `a` and `v` do not count then. 0 plans from `a` and `v`.
        r: blend radius; 0 stops at the target. The speed `v` is kept up to the blend where `r` is at least
            v^2 / (1.6 a), and at most half of the move: see "Which radius for which speed" in
            docs/explanation/motion.md. Down to -0.001 it counts as 0 (*observed*: generators write that for no
            rounding).

    Raises:
        MotionError: a point of the line is out of reach, outside the joint limits or too near a singularity.
        ScriptStateError: the arm is not ready, or another thread moves it.
    """
    _, _, default_a, default_v = robot.machine.default_motion
    robot.move(MoveL(p, a or default_a, v or default_v, t, blend_radius(robot, r)))


@command(family="motion", manual="2.1.2", waits=True, works_in_sec=False)
def movec(
    robot: Robot,
    pose_via: Pose,
    pose_to: Pose,
    a: ToolAcceleration = 1.2,
    v: ToolSpeed = 0.25,
    r: BlendRadius = 0,
    mode: Whole = 0,
) -> None:
    """Move the TCP on the circular arc from where it is through `pose_via` to `pose_to`.

    Both points are poses, never joint positions. Of `pose_via` only the position counts (*assumed*).

    Args:
        pose_via: pose on the arc, in the base frame.
        pose_to: pose at the end of the arc, in the base frame.
        a: tool acceleration; 0 takes the machine's default (*assumed*).
        v: tool speed; 0 takes the machine's default (*assumed*).
        r: blend radius; 0 stops at the end of the arc. Which one is needed for which speed is as in `movel`. Down to
            -0.001 it counts as 0 (*observed*).
        mode: 0 keeps the orientation as it is relative to the tangent of the arc, and that of `pose_to` does not
            count, with a warning where the two differ by more than a degree; any other number turns it evenly from
            start to end (*assumed*: the manual says fixed and unconstrained).

    Raises:
        MotionError: start, via and end lie on one line or coincide, or a point of the arc is out of reach.
        ScriptStateError: the arm is not ready, or another thread moves it.
    """
    _, _, default_a, default_v = robot.machine.default_motion
    robot.move(MoveC(pose_via, pose_to, a or default_a, v or default_v, blend_radius(robot, r), mode == 0))


@command(family="motion", manual="2.1.27", waits=True, works_in_sec=False)
def stopj(robot: Robot, a: JointDeceleration) -> None:
    """Brake all joints to standstill; return when the arm stands.

    Does nothing when the arm stands already.

    Args:
        a: joint deceleration.
    """
    robot.stop_motion(StopJ(a))


@command(family="motion", manual="2.1.28", waits=True, works_in_sec=False)
def stopl(robot: Robot, a: ToolDeceleration) -> None:
    """Brake the tool along its path to standstill; return when the arm stands.

    Does nothing when the arm stands already.

    Args:
        a: tool deceleration.
    """
    robot.stop_motion(StopL(a))
