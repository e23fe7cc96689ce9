"""Joint positions where a pose belongs, or a pose where joint positions belong.

Both are lists of six numbers, and the controller cannot tell them apart. What commands return is followed through
assignments; a list counts as joint positions too where two of x, y and z would be quarters of a turn. One list that
goes to some commands as joint positions and to others as a pose is wrong at one of them.

    def job():
      movej(get_actual_tcp_pose())                # W237: get_inverse_kin turns it into joint positions
      home = get_actual_joint_positions()
      movel(home)                                 # W237
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.commands.definition.plausibility import mistaken
from elitescript.lint.list_uses import ListUses
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W237", since="0.2")
def pose_for_joints(program: AnalysedProgram) -> Iterator[Finding]:
    """Report lists that come from a command of the other kind, or go to one."""
    yield from doubt_findings(program, "W237")
    told = {doubted.node for doubted in program.doubts if doubted.doubt.code == "W237"}
    for use, other in program.derived(ListUses).as_both():
        doubt = mistaken(use.param.quantity.meaning, other.param.quantity.meaning)
        if doubt is not None and use.node not in told:
            where = f"in line {program.span(other.node).line} the same list goes to {other.command.name}"
            yield Finding(use.node, f"{use.command.name}: {use.param.name}{doubt.text}: {where}", doubt.hint)
