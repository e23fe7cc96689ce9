"""Writes repairs of numbers in other units: `d2r(-90)` for -90, 0.4 for 400.

With a doubtful number those of its list are converted that have the same unit, but not the ones that plainly are in it
already: lengths below 1 and quarters of a turn (*assumed*). None of these repairs is safe: the arm goes elsewhere.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from elitescript.commands.definition.plausibility import is_quarter_turns
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.scopes import Resolution, Scope
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.lint.program import AnalysedProgram, Doubted

_CONVERTED: Final = ("W230", "W231", "W232")
_TO_RADIANS: Final = "d2r"
_SHORTEST_MM: Final = 1.0


def unit_fix(program: AnalysedProgram, doubted: Doubted) -> Fix | None:
    """Return the repair of a value in other units; None if it is not written out as numbers."""
    doubt = doubted.doubt
    if doubt.code not in _CONVERTED or doubted.param is None:
        return None
    units = doubted.param.quantity.unit.split(", ")
    unit = units[-1] if doubt.element is not None and doubt.element >= 3 else units[0]
    is_angle = unit.startswith("rad")
    if is_angle and doubted.scope.resolve(_TO_RADIANS) is not Resolution.BUILTIN:
        return None
    written = _written(program, doubted.whole, doubted.scope)
    if doubt.element is None:
        numbers = [written]
    else:
        elements = written.elts if isinstance(written, (ast.List, ast.Tuple)) else []
        numbers = [
            element
            for index, element in enumerate(elements)
            if (units[-1] if index >= 3 else units[0]) == unit and _is_foreign(element, is_angle)
        ]
    edits = []
    for number in numbers:
        span = program.span(number)
        if not _is_number(number) or span.line != span.end_line:
            continue
        text = program.source.line(span.line)[span.column - 1 : span.end_column - 1]
        new = f"{_TO_RADIANS}({text})" if is_angle else f"{ast.literal_eval(number) / 1000.0:.12g}"
        edits.append(Edit(*span, new))
    if not edits:
        return None
    title = (
        said("write {text}", text=edits[0].text)
        if len(edits) == 1
        else said("write {text} and so on", text=edits[0].text)
    )
    return Fix(title, tuple(edits), safe=False)


def _written(program: AnalysedProgram, node: ast.expr, scope: Scope) -> ast.expr:
    """Return the expression that a name stands for, if only one statement sets it; else the expression itself."""
    if not isinstance(node, ast.Name):
        return node
    bindings = program.symbols.bindings(node.id, scope)
    statement = program.symbols.parent(bindings[0].node) if len(bindings) == 1 else None
    is_plain = isinstance(statement, ast.Assign) and statement.targets == [bindings[0].node]
    return statement.value if is_plain and isinstance(statement, ast.Assign) else node


def _is_number(node: ast.expr) -> bool:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _is_foreign(node: ast.expr, is_angle: bool) -> bool:
    """Return whether a number can be in degrees or millimetres."""
    if not _is_number(node):
        return False
    value = abs(float(ast.literal_eval(node)))
    return not is_quarter_turns(value) if is_angle else value >= _SHORTEST_MM
