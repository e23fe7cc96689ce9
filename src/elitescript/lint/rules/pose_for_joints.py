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

from elitescript.commands.definition.plausibility import KINDS, mistaken
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule
from elitescript.said import said


@rule(code="W237", since="0.2", needs_values=True)
def pose_for_joints(program: AnalysedProgram) -> Iterator[Finding]:
    """Report lists that come from a command of the other kind, or go to one."""
    yield from doubt_findings(program, "W237")
    meanings = {param.quantity.meaning for arguments in program.arguments for param, _ in arguments.given}
    if not meanings.issuperset(KINDS):
        return
    told = {doubted.node for doubted in program.doubts if doubted.doubt.code == "W237"}
    for use, other in program.list_uses.as_both():
        doubt = mistaken(use.param.quantity.meaning, other.param.quantity.meaning)
        if doubt is not None and use.node not in told:
            text = said(
                "{command}: {parameter}{doubt}: in line {line} the same list goes to {other}",
                command=use.command.name,
                parameter=use.param.name,
                doubt=doubt.text,
                line=program.span(other.node).line,
                other=other.command.name,
            )
            yield Finding(use.node, text, doubt.hint)
