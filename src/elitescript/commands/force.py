"""Force control (manual 2.14 chapter 4)."""

from __future__ import annotations

from typing import Annotated, Final

from elitescript.commands.quantities import Bool, Choice, Integer, Number, Pose, Vector
from elitescript.commands.registry import command
from elitescript.errors import NotSimulatedError
from elitescript.messages.motion import Six

_NOT_YET: Final = "force control is not simulated yet"

_Wrench = Annotated[Six, Vector(Number(), 6, "N, Nm", "[Fx, Fy, Fz, Mx, My, Mz]")]


@command(
    family="force",
    since="2.14",
    manual="2.14: 4.1",
    spellings={"speedLimits": "speed_limits"},
    works_in_sec=False,
    is_simulated=False,
)
def force_mode(
    reference_frame: Pose,
    selection_vector: Annotated[tuple[int, ...], Vector(Choice(0, 1), 6)],
    target_wrench: _Wrench,
    mode: Annotated[int, Integer(0, 3)],
    speed_limits: Annotated[Six, Vector(Number("", 0.0), 6, "m/s, rad/s")],
) -> None:
    """Let the selected axes of a frame yield until the arm presses with a given wrench.

    Axes that are not selected keep their programmed motion. Wait at least 0.02 s (`sleep`) between a hard brake and
    this command.

    Args:
        reference_frame: force frame in the base frame, roll-pitch-yaw.
        selection_vector: 1 for an axis under force control, 0 for one under position control.
        target_wrench: wrench that the arm exerts; elements of axes that are not selected do not count.
        mode: how the force frame follows: 0 stays at `reference_frame`; 1 its y axis points from the TCP to the
            origin of `reference_frame`; 2 its x axis is the direction of travel, projected on the xy plane of
            `reference_frame`; 3 it is the TCP frame.
        speed_limits: greatest TCP speed along and about the selected axes.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="force", since="2.14", manual="2.14: 4.7", works_in_sec=False, is_simulated=False)
def end_force_mode() -> None:
    """End force control; the end of the program does the same."""
    raise NotSimulatedError(_NOT_YET)


@command(family="force", since="2.14", manual="2.14: 4.2", is_simulated=False)
def force_mode_set_gain_scaling(scaling: Annotated[float, Number("", 0.0, 2.0)]) -> None:
    """Set how quickly force control answers; read when force mode begins, kept until set again.

    Args:
        scaling: factor, 0.2 at first. Smaller is slower with less overshoot; above 1 hard contacts oscillate.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="force", since="2.14", manual="2.14: 4.3", is_simulated=False)
def force_mode_set_damping(damping: Annotated[float, Number("", 0.0, 1.0)]) -> None:
    """Set the damping of force control; read when force mode begins, kept until set again.

    Args:
        damping: 0 (at first) keeps the present speed without an external force, 1 stops quickly.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="force", since="2.14", manual="2.14: 4.4", is_simulated=False)
def zero_ftsensor() -> None:
    """Take the present compensated wrench as zero; later readings are relative to it."""
    raise NotSimulatedError(_NOT_YET)


@command(family="force", since="2.14", manual="2.14: 4.5", is_simulated=False)
def force() -> Annotated[float, Number("N")]:
    """Size of the external force at the TCP.

    Returns:
        Euclidean norm of the first three elements of `get_tcp_force(True)`.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="force", since="2.14", manual="2.14: 4.6", is_simulated=False)
def get_tcp_force(enable_compensation: Bool) -> _Wrench:
    """External wrench at the TCP.

    Args:
        enable_compensation: True without the weight of the payload and relative to the last `zero_ftsensor`, False as
            the sensor measures it.

    Returns:
        [Fx, Fy, Fz, TRx, TRy, TRz] in the TCP frame.
    """
    raise NotSimulatedError(_NOT_YET)
