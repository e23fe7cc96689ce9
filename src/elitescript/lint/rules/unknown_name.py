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

from elitescript.language.advice.unknown_names import WORDS, owner_of
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.modules import AVAILABLE
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W201", since="0.1")
def unknown_name(program: AnalysedProgram) -> Iterator[Finding]:
    """Report uses of names that nothing defines, other than calls."""
    if program.shares_globals:
        return
    for use, meant, hint in program.undefined(is_call=False):
        fix = None
        if meant:
            fix = Fix(
                said("write {meant}", meant=meant), (Edit(*program.span(use.node), meant),), safe=use.name in WORDS
            )
        elif use.name in AVAILABLE:
            from elitescript.lint.insertions import import_module

            fix = import_module(program, use.name)
        elif (owner := owner_of(use.name, program.symbols)) is not None:
            from elitescript.lint.insertions import declare

            fix = declare(program, "global", use.name, owner)
        yield Finding(use.node, said("the name `{name}` is not defined", name=use.name), hint, fix)
