"""Tests targets against the safety limits (manual 2.14 chapter 3.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from elitescript.commands.definition.quantities import POSE, Bool, Choice, OptionalJoints, Optionally, Vector
from elitescript.commands.definition.registry import command
from elitescript.commands.kinematics import flange_target, nearest_solution
from elitescript.errors import ArgumentCountError
from elitescript.messages.motion import Six

if TYPE_CHECKING:
    from elitescript.commands.definition.context import Robot


@command(family="motion", since="2.14", manual="2.14: 3.1.35")
def is_within_safety_limits(
    robot: Robot,
    p: Annotated[Six | None, Optionally(POSE)] = None,
    qNear: OptionalJoints = None,
    ciPair: Annotated[tuple[int, ...] | None, Optionally(Vector(Choice(0, 1), 4))] = None,
    q: OptionalJoints = None,
) -> Bool:
    """Return whether a pose or joint positions respect joint limits, safety planes and tool limits and can be reached.

    The limits of the present mode count: in reduced mode the reduced ones. A plane without a pair of inputs is always
    tested; that a pair switches its planes on while both of its inputs are high is *assumed*.

    Args:
        p: pose of the TCP to test.
        qNear: joint positions near which the inverse solution of `p` is looked for; without them the present ones.
        ciPair: for each pair of configurable inputs (0 and 1, 2 and 3, 4 and 5, 6 and 7) 1 to test the safety planes
            that it switches, 0 to leave them out; without it the present levels decide.
        q: joint positions to test instead of a pose; passed by name.

    Returns:
        True inside all limits.

    Raises:
        ArgumentCountError: neither a pose nor joint positions are given, or both.
    """
    if (p is None) == (q is None):
        raise ArgumentCountError("needs a pose p or joint positions q=..., one of them")
    machine = robot.machine
    pairs = None if ciPair is None else tuple(map(bool, ciPair))
    if p is None:
        assert q is not None
        return machine.is_within_safety_limits(q, pairs)
    solution, _ = nearest_solution(machine, flange_target(machine, p), qNear)
    return solution is not None and machine.is_within_safety_limits(solution.q, pairs)
