"""An argument whose type the command will refuse: a text for a number, five joints instead of six.

Only values that are certain before the run count; see `constants`.

    def job():
      sleep("1")                           # E304: a number
      movej([0, -1.57, 1.57, 0, 0])        # E304: six joints
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.errors import ArgumentTypeError
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="E304", since="0.1", needs_values=True)
def argument_type(program: AnalysedProgram) -> Iterator[Finding]:
    """Report arguments of the wrong type or length."""
    for refusal in program.refusals:
        if isinstance(refusal.error, ArgumentTypeError):
            yield Finding(refusal.node, refusal.text, refusal.hint)
