"""A number of another quantity than belongs there: how many values came for one of them, a length for an angle.

A reading of numbers is a list whose first element says how many arrived; the first of them is `[1]`.

    def job():
      socket_open("192.168.1.20", 5000)
      r = socket_read_ascii_float(2)
      if r[0] == 2:
        movel([r[0], r[1], 0.3, 3.14, 0, 0])      # W239: r[1] and r[2]
        movel([r[1], r[2], 0.3, 3.14, 0, 0])      # fine
      end
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W239", since="0.3", needs_values=True)
def other_quantity(program: AnalysedProgram) -> Iterator[Finding]:
    """Report counts, lengths and angles in each other's place."""
    return doubt_findings(program, "W239")
