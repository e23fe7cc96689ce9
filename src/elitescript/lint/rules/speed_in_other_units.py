"""A speed or an acceleration that looks like degrees or millimetres per second.

Joint speeds are in rad/s (10 and less), tool speeds in m/s (5 and less), accelerations in rad/s^2 and m/s^2 (50 and
less). What is above the limits of the arm is lowered to them, so that the arm moves as fast as it can.

    def job():
      movej(HOME, v=90)                           # W232: 1.5708 rad/s
      movel(PART, a=1200, v=250)                  # W232: 1.2 m/s^2, 0.25 m/s
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W232", since="0.2", needs_values=True)
def speed_in_other_units(program: AnalysedProgram) -> Iterator[Finding]:
    """Report speeds and accelerations that no arm has."""
    return doubt_findings(program, "W232")
