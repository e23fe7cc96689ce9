"""Force control (manual 2.14 chapter 4)."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import Bool, Integer, Number, Pose, Vector
from elitescript.commands.definition.registry import command
from elitescript.commands.definition.results import MEASURED
from elitescript.messages.machine import SetForceDamping, SetForceGain, ZeroForceSensor
from elitescript.messages.motion import Six
from elitescript.messages.yielding import EndForceMode, ForceMode

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot

_Wrench = Annotated[Six, Vector(Number(), 6, "N, Nm", "[Fx, Fy, Fz, Mx, My, Mz]")]


@command(
    family="force",
    since="2.14",
    manual="2.14: 4.1",
    spellings={"speedLimits": "speed_limits"},
    works_in_sec=False,
)
def force_mode(
    robot: Robot,
    reference_frame: Pose,
    selection_vector: Annotated[Six, Vector(Number(), 6)],
    target_wrench: _Wrench,
    mode: Annotated[int, Integer(0, 3)],
    speed_limits: Annotated[Six, Vector(Number(), 6, "m/s, rad/s")],
) -> None:
    """Let the selected axes of a frame yield until the arm presses with a given wrench.

    The call returns at once. Axes that are not selected keep their programmed motion. Calling it again changes the
    values. Wait at least 0.02 s (`sleep`) between a hard brake and this command. A surface is pressed stably up to a
    stiffness of 1e5 N/m divided by the gain scaling (*assumed*). Where a joint comes to the end of its range, or the
    arm to a singularity, it does not yield further and warns (*assumed*).

    Args:
        reference_frame: force frame in the base frame, roll-pitch-yaw.
        selection_vector: 1 for an axis under force control, 0 for one under position control. Any other number counts
            as 0, with a warning (*assumed*): an example of the vendor sends 1 to 6 and then has the wrist followed.
        target_wrench: wrench that the arm exerts; elements of axes that are not selected do not count.
        mode: how the force frame follows: 0 stays at `reference_frame`; 1 its y axis points from the TCP to the
            origin of `reference_frame`; 2 its x axis is the direction of travel, projected on the xy plane of
            `reference_frame`; 3 it is the TCP frame.
        speed_limits: greatest TCP speed along and about the selected axes; the sign does not count (*assumed*).

    Raises:
        MotionError: the arm is guided by hand.
        ScriptStateError: the arm is not ready.
    """
    if any(value not in (0.0, 1.0) for value in selection_vector):
        robot.warn_once("force_mode selection", "force_mode: selection_vector counts every number but 1 as 0")
    if any(value < 0.0 for value in speed_limits):
        robot.warn_once("force_mode limits", "force_mode: speed_limits are taken without their sign")
    selection = tuple([value == 1.0 for value in selection_vector])
    a, b, c, d, e, f = map(abs, speed_limits)
    robot.move(ForceMode(reference_frame, selection, target_wrench, mode, (a, b, c, d, e, f)))


@command(family="force", since="2.14", manual="2.14: 4.7", works_in_sec=False, waits=True)
def end_force_mode(robot: Robot) -> None:
    """End force control; the end of the program does the same.

    The call waits until the arm has come to rest along the axes that yielded (*assumed*).
    """
    robot.stop_motion(EndForceMode())


@command(family="force", since="2.14", manual="2.14: 4.2")
def force_mode_set_gain_scaling(robot: Robot, scaling: Annotated[float, Number("", 0.0, 2.0)]) -> None:
    """Set how quickly force control answers; read when force mode begins, kept until set again.

    Args:
        scaling: factor, 0.2 at first. Smaller is slower with less overshoot; above 1 hard contacts oscillate.
    """
    robot.request(SetForceGain(scaling))


@command(family="force", since="2.14", manual="2.14: 4.3")
def force_mode_set_damping(robot: Robot, damping: Annotated[float, Number("", 0.0, 1.0)]) -> None:
    """Set the damping of force control; read when force mode begins, kept until set again.

    Args:
        damping: 0 (at first) keeps the present speed without an external force, 1 stops quickly.
    """
    robot.request(SetForceDamping(damping))


@command(family="force", since="2.14", manual="2.14: 4.4")
def zero_ftsensor(robot: Robot) -> None:
    """Take the present compensated wrench as zero; later readings are relative to it, force control too.

    The zero outlasts the program; a restart of the controller removes it.
    """
    robot.request(ZeroForceSensor())


@command(family="force", since="2.14", manual="2.14: 4.5")
def force(robot: Robot) -> Annotated[float, Number("N", 0.0), MEASURED]:
    """Return the size of the external force at the TCP.

    Returns:
        Euclidean norm of the first three elements of `get_tcp_force(True)`.
    """
    return hypot(*robot.machine.tcp_wrench(True)[:3])


@command(family="force", since="2.14", manual="2.14: 4.6")
def get_tcp_force(robot: Robot, enable_compensation: Bool) -> Annotated[_Wrench, MEASURED]:
    """Return the external wrench at the TCP: what the surroundings exert on the arm (*assumed*).

    An arm that presses against a surface with `force_mode` reads the negative of its target.

    Args:
        enable_compensation: True without the payload's weight and inertia and relative to the last `zero_ftsensor`,
            False as the sensor measures it.

    Returns:
        [Fx, Fy, Fz, TRx, TRy, TRz] in the TCP frame.
    """
    return robot.machine.tcp_wrench(enable_compensation)
