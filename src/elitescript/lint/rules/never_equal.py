"""A comparison that can never, or always, be true, because both sides are of other kinds, lengths or ranges.

Inputs are True and False, registers are numbers, and what a peer sends is text: none of them equals a value of another
kind. A register of MODBUS is never below 0. Comparisons of constants with each other, and with None, are not counted:
programs switch parts on and off with them.

    def job():
      if get_standard_digital_in(0) == "True":    # W240: an input is True or False
        halt()
      end
      if socket_read_string() == 1:               # W240: to_num turns a text into a number
        halt()
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W240", since="0.3", instead_of=("W242",), needs_values=True)
def never_equal(program: AnalysedProgram) -> Iterator[Finding]:
    """Report comparisons whose outcome does not depend on what happens."""
    if program.nodes(ast.Compare):
        from elitescript.lint.comparisons import never_equal

        yield from never_equal(program)
