"""Hand guiding (manual 2.14 chapter 3.1)."""

from __future__ import annotations

from typing import Annotated, Any

from elitescript.commands.quantities import POSE, Choice, Either, Vector
from elitescript.commands.registry import command
from elitescript.errors import NotSimulatedError


@command(family="motion", since="2.14", manual="2.14: 3.1.41", works_in_sec=False, is_simulated=False)
def freedrive_mode(
    freeAxes: Annotated[tuple[int, ...], Vector(Choice(0, 1), 6)] = (1, 1, 1, 1, 1, 1),
    frame: Annotated[Any, Either(POSE, Choice("base", "tool"))] = (0, 0, 0, 0, 0, 0),
) -> None:
    """Let a person guide the arm by hand, until `end_freedrive_mode` or the end of the program.

    Args:
        freeAxes: 1 for a free axis, 0 for a locked one: x, y, z, Rx, Ry, Rz of `frame`.
        frame: frame of the axes: a pose in the base frame, `"base"`, or `"tool"` for the moving TCP frame.
    """
    raise NotSimulatedError("hand guiding is not simulated yet")


@command(family="motion", since="2.14", manual="2.14: 3.1.42", works_in_sec=False, is_simulated=False)
def end_freedrive_mode() -> None:
    """End hand guiding; the end of the program does the same."""
    raise NotSimulatedError("hand guiding is not simulated yet")
