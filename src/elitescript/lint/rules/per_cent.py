"""A number of per cent where a fraction is meant: `interpolate_pose` takes 0 for the first pose and 1 for the second.

Beyond 1 the line goes on, so that 50 is a place fifty times as far away.

    def job():
      a = get_target_tcp_pose()
      b = pose_add(a, [0, 0, 0.1, 0, 0, 0])
      movel(interpolate_pose(a, b, 0.5))          # fine
      movel(interpolate_pose(a, b, 50))           # W267
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from typing import Final

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import INT, OUTSIDE

_LEAST: Final = 2.0


@rule(code="W267", since="0.3", needs_values=True)
def per_cent(program: AnalysedProgram) -> Iterator[Finding]:
    """Report fractions of 2 and more."""
    for found in program.derived(CalledCommands).all_of("interpolate_pose"):
        node = found.given.get("alpha")
        if node is None:
            continue
        number = program.least_number(node, found.scope)
        value = program.values.of(node)
        if value.kinds == INT and _LEAST <= value.high < inf and not value.may & OUTSIDE:
            # Whole numbers that go on: a loop over per cent.
            number = value.high
        if number is not None and number >= _LEAST:
            hint = said("{number:g} looks like per cent: that is {meant:g}", number=number, meant=number / 100)
            yield Finding(
                node, said("interpolate_pose: alpha is {number:g}; 1 is already the second pose", number=number), hint
            )
