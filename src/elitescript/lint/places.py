"""Computes where the arm would be: the TCPs that a program sets, and its constant targets.

Nothing of kinematics is loaded before there is an arm and a target to judge.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Final

from elitescript.messages.motion import Six
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.commands.definition.plausibility import ArmFacts
    from elitescript.lint.program import AnalysedProgram, CommandCall

_AT_FLANGE: Final[Six] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_SETS_TCP: Final = "set_tcp"
_LOOKS: Final = 16
_FLOAT: Final = frozenset((float,))


def six(value: object) -> Six | None:
    """Return six certain numbers; None for anything else."""
    if not isinstance(value, (list, tuple)) or len(value) != 6:
        return None
    if _FLOAT.issuperset(map(type, value)):
        return tuple(value)
    if not all(isinstance(number, (int, float)) for number in value):
        return None
    a, b, c, d, e, f = map(float, value)
    return a, b, c, d, e, f


def _is_inside(angle: float, bounds: tuple[float, float]) -> bool:
    return bounds[0] <= angle <= bounds[1]


class TargetPlaces:
    """Evaluates the targets of one program."""

    def __init__(self, program: AnalysedProgram) -> None:
        self._program = program
        self._positions: dict[int, Six | None] = {}

    def argument(self, place: int, *names: str) -> Six | None:
        """Return the six numbers that the call of that index gives to the first of these parameters that it has."""
        called = self._program.command_calls[place]
        for param, node in self._program.arguments[place].given:
            if param.name in names:
                return six(self._program.constants.value(node, called.scope))
        return None

    @cached_property
    def tcps(self) -> tuple[Six, ...]:
        """The TCPs that may be active in moves; empty if one of them is not certain.

        Without one the TCP is the flange, as at the start of `run`.
        """
        program = self._program
        if any(use.name == _SETS_TCP and not use.is_call for use in program.outside):
            return ()
        found: dict[Six, None] = {}
        for place, called in enumerate(program.command_calls):
            if called.command.name == _SETS_TCP:
                tcp = self.argument(place, "pose")
                if tcp is None:
                    return ()
                found[tcp] = None
        return tuple(found) or (_AT_FLANGE,)

    def unreachable(self, arm: ArmFacts, p: Six) -> str:
        """Return why no TCP of the program reaches a pose; empty if one does, or if that is not certain."""
        from elitescript.kinematics.inverse import nearest, reason_unreachable, solutions, solve_branch
        from elitescript.kinematics.transforms import compose, inverse, transform_from_pose

        reason = ""
        for tcp in self.tcps:
            T_base_flange = transform_from_pose(p)
            if any(tcp):
                T_base_flange = compose(T_base_flange, inverse(transform_from_pose(tcp)))
            # Nearly all targets are reached in the first branch; the others are not computed then.
            q = solve_branch(arm.arm, T_base_flange, 0)
            if q is not None and all(map(_is_inside, q, arm.joint_ranges)):
                return ""
            candidates = solutions(arm.arm, T_base_flange)
            if nearest(candidates, _AT_FLANGE, arm.joint_ranges) is not None:
                return ""
            if candidates:
                reason = said("each of the {count} solutions has a joint outside its limits", count=len(candidates))
            else:
                reason = reason_unreachable(arm.arm, T_base_flange)
            if not any(tcp):
                reason = said("{reason} (the TCP is the flange)", reason=reason)
        return reason

    def position(self, called: CommandCall, place: int) -> Six | None:
        """Return the pose of the TCP at the end of a move; None if it is not certain."""
        if place not in self._positions:
            self._positions[place] = self._position(called, place)
        return self._positions[place]

    def _position(self, called: CommandCall, place: int) -> Six | None:
        name = called.command.alias_of or called.command.name
        if name == "movej":
            q = self.argument(place, "q")
            return None if q is None else self._forward(q)
        return self.argument(place, "p", "pose", "pose_to")

    def _forward(self, q: Six) -> Six | None:
        arm = self._program.arm
        if arm is None or len(self.tcps) != 1:
            return None
        from elitescript.kinematics.transforms import pose_from_transform, transform_from_pose

        return pose_from_transform(arm.arm.forward_tcp(q, transform_from_pose(self.tcps[0])))

    def farthest_m(self, q_from: Six, q_to: Six) -> float | None:
        """Return the greatest distance from the end of a joint move, m, over its second half."""
        end = self._forward(q_to)
        if end is None:
            return None
        from math import dist

        farthest = 0.0
        for look in range(_LOOKS + 1):
            share = 0.5 * look / _LOOKS
            q = six([b + (a - b) * share for a, b in zip(q_from, q_to, strict=True)])
            at = None if q is None else self._forward(q)
            if at is not None:
                farthest = max(farthest, dist(at[:3], end[:3]))
        return farthest
