"""True or False where the number of a pin, port or register belongs: the arguments have changed places.

True counts as 1, so the command would set another output. So it is with any other number, where another argument
is a number in place of True or False.

    def job():
      set_standard_digital_out(0, True)           # fine
      set_standard_digital_out(True, 0)           # W266
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.quantities import Boolean, Integer
from elitescript.commands.definition.registry import Param
from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.arguments import Arguments
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import BOOL, NUMBER

_INDICES: Final = ("n", "address", "port", "index", "encoder_index")


@rule(code="W266", since="0.3", needs_values=True)
def swapped_arguments(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such argument."""
    for found, arguments in zip(program.command_calls, program.arguments, strict=True):
        for param, node in arguments.given:
            if not (param.name in _INDICES or _takes_number(param)) or not _is_truth(program, node):
                continue
            if all(_is_truth(program, other) for _, other in arguments.given):
                break
            if param.name not in _INDICES and not _gives_number(program, arguments):
                continue
            text = said(
                "{command}: {param} is {expression}, and a number belongs there",
                command=found.command.name,
                param=param.name,
                expression=ast.unparse(node),
            )
            call = found.call
            fix = None
            if len(call.args) == 2 and call.args[0] is node and not call.keywords:
                one, other = call.args
                written = f"{found.command.name}({ast.unparse(other)}, {ast.unparse(one)})"
                edits = (Edit(*program.span(one), ast.unparse(other)), Edit(*program.span(other), ast.unparse(one)))
                fix = Fix(said("write {written}", written=written), edits, safe=False)
            yield Finding(
                node, text, said("the number comes first: {signature}", signature=found.command.signature), fix
            )


def _takes_number(param: Param) -> bool:
    return isinstance(param.quantity, Integer)


def _gives_number(program: AnalysedProgram, arguments: Arguments) -> bool:
    """Return whether a call has a number, and not 0 or 1, where True or False belongs."""
    for param, node in arguments.given:
        if isinstance(param.quantity, Boolean):
            value = program.values.of(node)
            if value.has_constant and not value.kinds & ~NUMBER and value.constant not in (0, 1):
                return True
    return False


def _is_truth(program: AnalysedProgram, node: ast.expr) -> bool:
    """Return whether an argument is True or False in any case."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, bool)
    return isinstance(node, (ast.Name, ast.Call)) and program.values.of(node).kinds == BOOL
