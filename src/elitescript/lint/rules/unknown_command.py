"""A call of a function that exists nowhere: not in the program, not in the catalogue, not in Python.

It is an alarm (`NameError`) when it is reached. Names of other robots' languages get the command that does
the same here. A secondary program may call functions of the running program, so only names that are plainly
a slip are reported there.

    def job():
      set_digital_out(1, True)   # E301: here it is set_standard_digital_out
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.commands.definition.reserved import GENERATED_PREFIXES
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.kinds import SCRIPT
from elitescript.lint.program import MOST_SUGGESTIONS, AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="E301", since="0.1")
def unknown_command(program: AnalysedProgram) -> Iterator[Finding]:
    """Report calls of unknown functions."""
    hints: dict[tuple[str, int], tuple[str, str]] = {}
    for use in program.unknown:
        name = use.name
        if not use.is_call or program.expects_missing_names(use.node):
            continue
        if program.parsed.kind == SCRIPT and name.startswith(GENERATED_PREFIXES):
            continue
        key = (name, id(use.scope))
        if key not in hints:
            hints[key] = program.meant_by(use, is_searched=len(hints) < MOST_SUGGESTIONS)
        meant, hint = hints[key]
        if program.shares_globals and not hint:
            continue
        fix = None
        if meant:
            line, column, end_line, end_column = program.span(use.node)
            fix = Fix(f"write {meant}", (Edit(line, column, end_line, end_column, meant),), safe=False)
        yield Finding(use.node, f"there is no command or function called `{name}`", hint, fix)
