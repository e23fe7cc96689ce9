"""Measured values compared exactly.

A sensor never gives exactly the number that was planned. The simulated arm is exact unless its plant has a lag or
noise, so such a comparison works here, and waits for ever on an arm.

    def job():
      home = [0, -1.57, 1.57, -1.57, -1.57, 0]
      movej(home)
      while get_actual_joint_positions() != home: # W242: norm of the differences < 0.001
        sync()
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W242", since="0.3", needs_values=True)
def measured_exactly(program: AnalysedProgram) -> Iterator[Finding]:
    """Report `==` and `!=` with a measured value."""
    if program.nodes(ast.Compare):
        from elitescript.lint.comparisons import measured_exactly

        yield from measured_exactly(program)
