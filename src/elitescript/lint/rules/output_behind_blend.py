"""An output behind a move with a blend radius: it is set where the blend begins, that far in front of the point.

A move with a blend radius returns as soon as the tool comes into the sphere around its point. A sound program may want
that.

    def job():
      movel([0.4, 0, 0.4, 3.14, 0, 0], v=0.1, r=0.02)
      set_standard_digital_out(0, True)                 # N223: 20 mm before the point
      movel([0.5, 0, 0.4, 3.14, 0, 0], v=0.1)
      set_standard_digital_out(0, False)                # at the point: the move has no radius
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_MOVES: Final = ("movel", "movej", "movec", "movep")
_OUTPUTS: Final = (
    *("set_standard_digital_out", "set_configurable_digital_out", "set_tool_digital", "set_standard_analog_out"),
    *("modbus_set_output_signal", "modbus_set_output_register", "write_output_boolean_register"),
    *("write_output_integer_register", "write_output_float_register"),
)


@rule(code="N223", since="0.3")
def output_behind_blend(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first output in the line behind each such move."""
    radii: dict[ast.AST, float] = {}
    for found in program.derived(CalledCommands).of(*_MOVES):
        node = found.given.get("r")
        radius_m = None if node is None else program.least_number(node, found.scope)
        if radius_m is not None and radius_m > 0:
            radii[found.call] = radius_m
    if not radii:
        return
    moves = {found.call for found in program.derived(CalledCommands).of(*_MOVES)}
    for found in program.derived(CalledCommands).of(*_OUTPUTS):
        behind = _statement_before(program, found.call)
        if isinstance(behind, ast.Expr) and behind.value in radii and _moves_on(program, found.call, moves):
            radius_m = radii[behind.value]
            where = said(
                "{radius_mm:g} mm before the point of line {line}", radius_mm=radius_m * 1000, line=behind.lineno
            )
            text = said("{command} comes {where}, where its blend begins", command=found.name, where=where)
            yield Finding(found.call, text, "a move without r ends at its point")


def _block(program: AnalysedProgram, call: ast.Call) -> tuple[list[ast.stmt], int] | None:
    """Return the block in which a call is a statement of its own, and its place."""
    statement = program.symbols.parent(call)
    if not isinstance(statement, ast.Expr):
        return None
    above = program.symbols.parent(statement)
    for name in ("body", "orelse", "finalbody"):
        block = getattr(above, name, None)
        if isinstance(block, list):
            for place, other in enumerate(block):
                if other is statement:
                    return block, place
    return None


def _statement_before(program: AnalysedProgram, call: ast.Call) -> ast.stmt | None:
    found = _block(program, call)
    return None if found is None or found[1] == 0 else found[0][found[1] - 1]


def _moves_on(program: AnalysedProgram, call: ast.Call, moves: set[ast.Call]) -> bool:
    """Return whether another move follows in the block: without one there is no blend."""
    found = _block(program, call)
    if found is None:
        return False
    block, place = found
    following = (node for statement in block[place + 1 :] for node in ast.walk(statement))
    return any(node in moves for node in following)
