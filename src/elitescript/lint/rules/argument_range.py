"""An argument outside the range that the command takes.

Only values that are certain before the run count; see `constants`.

    def job():
      set_standard_digital_out(16, True)   # E305: 0 to 15
      movej(HOME, a=-1)                    # E305: not below 0
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.errors import ArgumentTypeError
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="E305", since="0.1", needs_values=True)
def argument_range(program: AnalysedProgram) -> Iterator[Finding]:
    """Report arguments of the right type whose value is refused."""
    for refusal in program.refusals:
        if not isinstance(refusal.error, ArgumentTypeError):
            yield Finding(refusal.node, refusal.text, refusal.hint)
