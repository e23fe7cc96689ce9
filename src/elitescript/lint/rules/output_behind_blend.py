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


@rule(code="N223", since="0.3", needs_values=True)
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
    last = _last_moves(program)
    for found in program.derived(CalledCommands).of(*_OUTPUTS):
        statement = program.symbols.parent(found.call)
        if not isinstance(statement, ast.Expr):
            continue
        _, block, place = program.symbols.block_of(statement)
        behind = block[place - 1] if place else None
        # Without another move there is no blend.
        if isinstance(behind, ast.Expr) and behind.value in radii and last.get(id(block), 0) > place:
            radius_m = radii[behind.value]
            where = said(
                "{radius_mm:g} mm before the point of line {line}", radius_mm=radius_m * 1000, line=behind.lineno
            )
            text = said("{command} comes {where}, where its blend begins", command=found.name, where=where)
            yield Finding(found.call, text, "a move without r ends at its point")


def _last_moves(program: AnalysedProgram) -> dict[int, int]:
    """Return the place of the last statement with a move in it, of each block by its identity."""
    symbols = program.symbols
    found: dict[int, int] = {}
    seen: set[ast.AST] = set()
    for called in program.derived(CalledCommands).of(*_MOVES):
        for node in symbols.ancestors(called.call):
            if node in seen:
                break
            seen.add(node)
            field, block, place = symbols.block_of(node)
            if field:
                found[id(block)] = max(place, found.get(id(block), 0))
    return found
