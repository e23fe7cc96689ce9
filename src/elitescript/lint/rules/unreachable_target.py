"""A constant target that the arm cannot reach.

With `--robot` the limits of that arm count for joint positions and its reach for poses, with the TCP that the program
sets; without it joint positions beyond a full turn, which no arm reaches. A target in a `try` is left out: there the
program expects the refusal. Of an arc the end counts, if it takes on its orientation.

    def job():
      movej([0, -1.57, 6.6, 0, 0, 0])              # W236
      movel([1.2, 0, 0.3, 3.14, 0, 0])             # out of reach, with --robot CS66
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.plausibility import FULL_TURN
from elitescript.lint.places import TargetPlaces, six
from elitescript.lint.program import AnalysedProgram, element
from elitescript.lint.registry import Finding, rule
from elitescript.said import Said, said

_JOINT_MOVES: Final = ("movej", "servoj")
_POSE_MOVES: Final = ("movel", "movep", "movec")
_MOVES: Final = frozenset((*_JOINT_MOVES, *_POSE_MOVES))
_ARC_END: Final = "pose_to"
_JOINT_NAMES: Final = ("base", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")
_ANY_ARM: Final = ((-FULL_TURN, FULL_TURN),) * 6
_TARGETS: Final = ("W230", "W231", "W237")


_OF_JOINTS: Final = "get_forward_kin"
_OF_POSE: Final = "get_inverse_kin"


def _computed(name: str, node: ast.expr) -> tuple[str, ast.expr]:
    """Return a target that is computed from another in the call of a move: the move that this would be of, and it."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args:
        given = {keyword.arg for keyword in node.keywords}
        if name in _JOINT_MOVES and node.func.id == _OF_POSE and len(node.args) <= 2 and given <= {"qnear"}:
            return _POSE_MOVES[0], node.args[0]
        if name in _POSE_MOVES and node.func.id == _OF_JOINTS and len(node.args) == 1 and not given:
            return _JOINT_MOVES[0], node.args[0]
    return name, node


@rule(code="W236", since="0.2", needs_values=True)
def unreachable_target(program: AnalysedProgram) -> Iterator[Finding]:
    """Report targets outside the joint limits, or out of reach."""
    places = TargetPlaces(program)
    doubted = {doubted.node for doubted in program.doubts if doubted.doubt.code in _TARGETS}
    refused = {refusal.node for refusal in program.refusals}
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        name = called.command.alias_of or called.command.name
        if name not in _MOVES or not arguments.given or program.is_tried(called.call):
            continue
        param, node = arguments.given[0]
        if name == "movec":
            given = {param.name: (param, node) for param, node in arguments.given}
            mode = program.constants.value(given["mode"][1], called.scope) if "mode" in given else 0
            if _ARC_END not in given or mode != 0:
                continue
            param, node = given[_ARC_END]
        what = f"{called.command.name}: {param.name}"
        name, node = _computed(name, node)
        if node in refused:
            continue
        value = program.constants.value(node, called.scope)
        if doubted and any(element(node, index) in doubted for index in (None, *range(6))):
            continue
        if name in _JOINT_MOVES:
            ranges = _ANY_ARM if program.arm is None else program.arm.joint_ranges
            items = value if isinstance(value, (list, tuple)) and len(value) == 6 else ()
            for index, number in enumerate(items):
                low, high = ranges[index]
                if isinstance(number, (int, float)) and not low <= number <= high:
                    owner = (
                        Said("of every arm")
                        if program.arm is None
                        else said("of joint {joint}", joint=_JOINT_NAMES[index])
                    )
                    bounds = said("{low:.4g} to {high:.4g} rad", low=low, high=high)
                    text = said(
                        "{what}[{index}] is {number:.6g} rad, outside the range {owner}, {bounds}",
                        what=what,
                        index=index,
                        number=number,
                        owner=owner,
                        bounds=bounds,
                    )
                    hint = "choose a target inside the range; a full turn less is the same direction"
                    yield Finding(element(node, index), text, hint)
                    break
            continue
        p = six(value)
        reason = "" if p is None or program.arm is None else places.unreachable(program.arm, p)
        if reason:
            text = said("{what} is out of reach: {reason}", what=what, reason=reason)
            yield Finding(node, text, "keep the whole path inside the workspace")
