"""A call of a function that exists nowhere: not in the program, not in the catalogue, not in Python.

It is an alarm (`NameError`) when it is reached. Names of other robots' languages get the command that does
the same here. A secondary program may call functions that the running program has declared `global`, so only names
that are plainly a slip are reported there.

    def job():
      set_digital_out(1, True)   # E301: here it is set_standard_digital_out
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="E301", since="0.1")
def unknown_command(program: AnalysedProgram) -> Iterator[Finding]:
    """Report calls of unknown functions."""
    for use, meant, hint in program.undefined(is_call=True):
        if program.shares_globals and not hint:
            continue
        fix = (
            Fix(said("write {meant}", meant=meant), (Edit(*program.span(use.node), meant),), safe=False)
            if meant
            else None
        )
        yield Finding(use.node, said("there is no command or function called `{name}`", name=use.name), hint, fix)
