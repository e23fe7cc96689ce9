"""A call of a command with the wrong number or names of arguments.

The rules are those of the run: names may be spelt as the manuals spell them, and nothing is dropped in silence.

    def job():
      set_standard_digital_out(1)          # E303: the level is missing
      movel(TARGET, speed=0.1)             # E303: it is called `v`
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="E303", since="0.1")
def argument_count(program: AnalysedProgram) -> Iterator[Finding]:
    """Report what is surplus, missing, misnamed or given twice."""
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        for misfit in arguments.misfits:
            yield Finding(misfit.node, misfit.text, called.command.call_hint)
