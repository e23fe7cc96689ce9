"""A length that looks like millimetres: all lengths are in metres.

A coordinate of a pose counts from 6 m on, of a TCP from 3 m, a blend radius from 2 m, and the centre of gravity of a
payload where it lies farther away than the arm reaches (1.8 m if the arm is not known).

    def job():
      movel([400, 0, 300, 3.14, 0, 0])            # W231: 400 mm are 0.4 m
      set_tcp([0, 0, 150, 0, 0, 0])               # W231
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W231", since="0.2", needs_values=True)
def length_in_millimetres(program: AnalysedProgram) -> Iterator[Finding]:
    """Report positions, tools, radii and centres of gravity beyond what any arm reaches."""
    return doubt_findings(program, "W231")
