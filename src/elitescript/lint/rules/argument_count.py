"""A call of a command with the wrong number or names of arguments.

The rules are those of the run: names may be spelt as the manuals spell them, and nothing is dropped in silence.

    def job():
      set_standard_digital_out(1)          # E303: the level is missing
      movel(TARGET, speed=0.1)             # E303: it is called `v`
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.advice.unknown_names import nearest
from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.program import AnalysedProgram, CommandCall
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="E303", since="0.1")
def argument_count(program: AnalysedProgram) -> Iterator[Finding]:
    """Report what is surplus, missing, misnamed or given twice."""
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        for misfit in arguments.misfits:
            yield Finding(misfit.node, misfit.text, called.command.call_hint, _fix(program, called, misfit.node))


def _fix(program: AnalysedProgram, called: CommandCall, node: ast.AST) -> Fix | None:
    """Return the repair of a misspelt keyword; None for anything else."""
    if not isinstance(node, ast.keyword) or not node.arg:
        return None
    names = [param.name for param in called.command.params]
    meant = nearest(node.arg, names) if node.arg not in names else ""
    line, column = program.symbols.place(node)
    edit = Edit(line, column, line, column + len(node.arg), meant)
    return Fix(said("write {meant}", meant=meant), (edit,), safe=False) if meant else None
