"""Hand guiding (manual 2.14 chapter 3.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from elitescript.commands.definition.quantities import POSE, Choice, Either, Vector
from elitescript.commands.definition.registry import command
from elitescript.messages.state import ZERO_SIX
from elitescript.messages.yielding import EndFreedrive, Freedrive

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="motion", since="2.14", manual="2.14: 3.1.41", works_in_sec=False)
def freedrive_mode(
    robot: Robot,
    freeAxes: Annotated[tuple[int, ...], Vector(Choice(0, 1), 6)] = (1, 1, 1, 1, 1, 1),
    frame: Annotated[Any, Either(POSE, Choice("base", "tool"))] = (0, 0, 0, 0, 0, 0),
) -> None:
    """Let a person guide the arm by hand, until `end_freedrive_mode` or the end of the program.

    The call returns at once. The hand is the signal `external_wrench`; the arm answers like a mass in a thick fluid,
    turns about the TCP, and does not yield over the ends of the joint ranges (*assumed*). Moves are refused until hand
    guiding has ended; `stopj` and `stopl` end it (*assumed*).

    Args:
        freeAxes: 1 for a free axis, 0 for a locked one: x, y, z, Rx, Ry, Rz of `frame`.
        frame: frame of the axes: a pose in the base frame, `"base"`, or `"tool"` for the moving TCP frame.

    Raises:
        MotionError: the arm moves, or is in force mode.
        ScriptStateError: the arm is not ready.
    """
    pose = None if frame == "tool" else ZERO_SIX if frame == "base" else frame
    robot.move(Freedrive(tuple([axis == 1 for axis in freeAxes]), pose))


@command(family="motion", since="2.14", manual="2.14: 3.1.42", works_in_sec=False, waits=True)
def end_freedrive_mode(robot: Robot) -> None:
    """End hand guiding; the end of the program does the same.

    The call waits until the arm has come to rest (*assumed*).
    """
    robot.stop_motion(EndFreedrive())
