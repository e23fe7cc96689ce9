"""True or False where the number of a pin, port or register belongs: the arguments have changed places.

True counts as 1, so the command would set another output.

    def job():
      set_standard_digital_out(0, True)           # fine
      set_standard_digital_out(True, 0)           # W266
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import BOOL

_INDICES: Final = ("n", "address", "port", "index", "encoder_index")


@rule(code="W266", since="0.3")
def swapped_arguments(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such argument."""
    for found, arguments in zip(program.command_calls, program.arguments, strict=True):
        if all(_is_truth(program, node) for _, node in arguments.given):
            continue
        for param, node in arguments.given:
            if param.name not in _INDICES or not _is_truth(program, node):
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


def _is_truth(program: AnalysedProgram, node: ast.expr) -> bool:
    """Return whether an argument is True or False in any case."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, bool)
    return isinstance(node, (ast.Name, ast.Call)) and program.values.of(node).kinds == BOOL
