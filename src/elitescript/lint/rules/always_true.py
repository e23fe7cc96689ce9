"""A condition that is always true, or that means something else than it says.

`str_find` returns a position: 0, which is false, for a text that begins with what is looked for, and -1, which is
true, where nothing was found. A reading of several numbers is a list with at least one element, which is true.
`x == 1 or 2` is true whatever `x` is, and `1 < x & x < 9` compares with the number `x & x`.

    def job():
      if str_find(socket_read_string(), "OK"):    # W241: >= 0 if it was found
        halt()
      end
      if socket_read_ascii_float(3):              # W241: [0] is how many came
        halt()
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W241", since="0.3", needs_values=True)
def always_true(program: AnalysedProgram) -> Iterator[Finding]:
    """Report conditions that are no question."""
    kinds = (ast.If, ast.While, ast.IfExp, ast.BoolOp, ast.Compare)
    if any(program.nodes(kind) for kind in kinds):
        from elitescript.lint.comparisons import always_true

        yield from always_true(program)
