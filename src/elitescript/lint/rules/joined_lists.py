"""Lists joined or repeated where numbers were meant.

`+` puts one list behind the other, `*` repeats a list: a pose and an offset are twelve numbers then.

    def job():
      p = get_actual_tcp_pose()
      movel(p + [0, 0, 0.05, 0, 0, 0])            # W243: pose_trans or pose_add
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule, shown_source
from elitescript.said import said


@rule(code="W243", since="0.3", needs_values=True)
def joined_lists(program: AnalysedProgram) -> Iterator[Finding]:
    """Report sums and products of poses and joint positions."""
    for node, joined in program.joined_lists.items():
        text = said("{expression} joins lists: {words}", expression=shown_source(program, node), words=joined.words)
        yield Finding(node, text, joined.hint)
