"""A call or a calculation that is made for its result alone, and whose result is not used.

Commands that read or compute (`get_...()`, `pose_trans(...)`, `str_cat(...)`) change nothing, neither their
arguments nor the robot; so do `len`, `sorted`, the functions of `math`
and the methods of texts: `s.strip()` leaves `s` as it is. A sum alone on its line is often the
rest of a line above that was broken without brackets. Where an argument does something, the call is left alone.

    def job():
      target = get_actual_tcp_pose()
      pose_trans(target, [0, 0, 0.1, 0, 0, 0])   # W219: target is as before
      movel(target)
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.options import LINE
from elitescript.lint.effects import has_effect
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W219", since="0.2", needs_values=True)
def unused_result(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such statement."""
    if program.parsed.options.kind == LINE:
        return
    has_classes = bool(program.nodes(ast.ClassDef))
    for statement in program.nodes(ast.Expr):
        value = statement.value
        if program.is_tried(statement):
            continue
        if isinstance(value, ast.Call) and not has_effect(value, program):
            name = ast.unparse(value.func)
            text = said("`{name}` only gives a value, and this line does not use it", name=name)
            hint = said("write x = {name}(...), or remove the line", name=name)
            if isinstance(value.func, ast.Attribute) and _is_of_text(program, value.func):
                owner = ast.unparse(value.func.value)
                hint = said("a text never changes: write {owner} = {call}", owner=owner, call=ast.unparse(value))
            yield Finding(value.func, text, hint)
        elif isinstance(value, (ast.BinOp, ast.UnaryOp)) and not has_classes and not has_effect(value, program):
            # Classes may give operators a meaning of their own.
            text = "the result of this calculation is not used"
            hint = "give it to a variable; a line that goes on with the one above needs brackets around both"
            yield Finding(value, text, hint)


def _is_of_text(program: AnalysedProgram, method: ast.Attribute) -> bool:
    from elitescript.values.description import TEXT

    return program.values.of(method.value).kinds == TEXT
