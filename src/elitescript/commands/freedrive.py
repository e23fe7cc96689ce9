"""Hand guiding and the safety limits (manual 2.14 chapter 3.1)."""

from __future__ import annotations

from typing import Annotated, Any

from elitescript.commands.quantities import (
    POSE,
    Bool,
    Choice,
    Either,
    OptionalJoints,
    Optionally,
    Vector,
)
from elitescript.commands.registry import command
from elitescript.errors import ArgumentCountError, NotSimulatedError
from elitescript.messages.motion import Six


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


@command(family="motion", since="2.14", manual="2.14: 3.1.35", spellings={"qnear": "qNear"}, is_simulated=False)
def is_within_safety_limits(
    p: Annotated[Six | None, Optionally(POSE)] = None,
    qNear: OptionalJoints = None,
    ciPair: Annotated[tuple[int, ...] | None, Optionally(Vector(Choice(0, 1), 4))] = None,
    q: OptionalJoints = None,
) -> Bool:
    """Whether a pose or joint positions respect joint limits, safety planes and tool limits and can be reached.

    Args:
        p: pose of the TCP to test.
        qNear: joint positions near which the inverse solution of `p` is looked for; without them the present ones.
        ciPair: for each pair of configurable inputs (0 and 1, 2 and 3, 4 and 5, 6 and 7) 1 to test the safety planes
            that it switches, 0 to leave them out; without it the present levels decide.
        q: joint positions to test instead of a pose; passed by name.

    Returns:
        True inside all limits.

    Raises:
        ArgumentCountError: neither a pose nor joint positions are given.
    """
    if p is None and q is None:
        raise ArgumentCountError("needs a pose p or joint positions q=...")
    raise NotSimulatedError("safety limits are not simulated yet")
