"""A name that nothing defines: not the program, not the robot, not Python.

The line is legal, and an alarm (`NameError`) when it is reached; often it is a slip, or a `true` for `True`.
A secondary program is left alone, because it finds the globals of whatever program runs.

    def job():
      speed = 0.25
      movel(TARGET, v=sped)      # W201 TARGET, W201 sped: is `speed` meant?
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.commands.definition.reserved import GENERATED_PREFIXES
from elitescript.language.advice.unknown_names import WORDS
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.kinds import SCRIPT
from elitescript.lint.program import MOST_SUGGESTIONS, AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W201", since="0.1")
def unknown_name(program: AnalysedProgram) -> Iterator[Finding]:
    """Report uses of names that nothing defines, other than calls."""
    if program.shares_globals:
        return
    hints: dict[tuple[str, int], tuple[str, str]] = {}
    for use in program.unknown:
        name = use.name
        if use.is_call or _belongs_to_a_pendant_program(name, program) or program.expects_missing_names(use.node):
            continue
        key = (name, id(use.scope))
        if key not in hints:
            hints[key] = program.meant_by(use, is_searched=len(hints) < MOST_SUGGESTIONS)
        meant, hint = hints[key]
        fix = None
        if meant:
            line, column, end_line, end_column = program.span(use.node)
            edit = Edit(line, column, end_line, end_column, meant)
            fix = Fix(f"write {meant}", (edit,), safe=name in WORDS)
        yield Finding(use.node, f"the name `{name}` is not defined", hint, fix)


def _belongs_to_a_pendant_program(name: str, program: AnalysedProgram) -> bool:
    """A script without a `def` may be a node of a program whose other parts the pendant writes."""
    return program.parsed.kind == SCRIPT and name.startswith(GENERATED_PREFIXES)
