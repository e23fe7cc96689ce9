"""An angle that looks like degrees: all angles are in radians.

An angle counts from 10 rad on, and from a full turn on, 6.283 rad, if it is a round number. In between it may be a sum
of turns in a pose; for joint positions W236 reports it, because no joint turns further than that.

    def job():
      movej([0, -90, 90, 0, 90, 0])               # W230: d2r(-90) is -1.5708
      movel([0.4, 0, 0.3, 180, 0, 0])             # W230
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W230", since="0.2", needs_values=True)
def angle_in_degrees(program: AnalysedProgram) -> Iterator[Finding]:
    """Report joint positions and orientations that are degrees."""
    return doubt_findings(program, "W230")
