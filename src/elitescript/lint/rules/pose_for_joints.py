"""Joint positions where a pose belongs, or a pose where joint positions belong.

Both are lists of six numbers, and the controller cannot tell them apart. What commands return is followed through
assignments; a list counts as joint positions too where two of x, y and z would be quarters of a turn.

    def job():
      movej(get_actual_tcp_pose())                # W237: get_inverse_kin turns it into joint positions
      home = get_actual_joint_positions()
      movel(home)                                 # W237
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.doubts import findings
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W237", since="0.2")
def pose_for_joints(program: AnalysedProgram) -> Iterator[Finding]:
    """Report lists that come from a command of the other kind."""
    return findings(program, "W237")
