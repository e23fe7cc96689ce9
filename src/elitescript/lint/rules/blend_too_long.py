"""A blend radius that is longer than half of the move.

A blend takes at most half of a move, so that two of them never overlap; a longer radius is shortened. Two moves in a
row count whose targets are certain, of `movej` with `--robot` only.

    def job():
      movel([0.4, 0, 0.30, 3.14, 0, 0])
      movel([0.4, 0, 0.34, 3.14, 0, 0], r=0.05)   # W235: 0.02 is the most
      movel([0.4, 0.2, 0.34, 3.14, 0, 0])
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import dist
from typing import Final

from elitescript.commands.definition.plausibility import BLEND_MOST_M
from elitescript.language.nodes import children
from elitescript.lint.places import TargetPlaces
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.messages.motion import BLEND_SHARE, RADIUS_HINT, RADIUS_SHORTENED, Six
from elitescript.said import said

_MOVES: Final = ("movel", "movej", "movec", "movep")
_ROOM: Final = 1e-3
"""Relative tolerance of the radius, for rounded numbers."""


@rule(code="W235", since="0.2", needs_values=True)
def blend_too_long(program: AnalysedProgram) -> Iterator[Finding]:
    """Report radii that reach back further than the middle of their move."""
    places = TargetPlaces(program)
    calls = {called.call: place for place, called in enumerate(program.command_calls)}
    moving = [called.call for place, called in enumerate(program.command_calls) if _name(program, place) in _MOVES]
    for block in _blocks_of(program, moving):
        yield from _block_findings(program, places, calls, block)


def _name(program: AnalysedProgram, place: int) -> str:
    command = program.command_calls[place].command
    return command.alias_of or command.name


def _blocks_of(program: AnalysedProgram, calls: list[ast.Call]) -> list[list[ast.stmt]]:
    """Return each list of statements of which some of the calls are one, once."""
    found: dict[int, list[ast.stmt]] = {}
    for call in calls:
        statement = program.symbols.parent(call)
        if isinstance(statement, ast.Expr):
            _, block, _ = program.symbols.block_of(statement)
            found[id(block)] = block
    return list(found.values())


def _block_findings(
    program: AnalysedProgram, places: TargetPlaces, calls: dict[ast.Call, int], block: list[ast.stmt]
) -> Iterator[Finding]:
    start: int | None = None
    for statement in block:
        call = statement.value if isinstance(statement, ast.Expr) else None
        place = calls.get(call) if isinstance(call, ast.Call) else None
        if place is None:
            # A plain assignment moves nothing.
            if start is not None and (not isinstance(statement, ast.Assign) or _calls(statement)):
                start = None
            continue
        if _name(program, place) in _MOVES:
            if start is not None:
                yield from _judged(program, places, start, place)
            start = place
        elif program.command_calls[place].command.waits or _name(program, place) == "set_tcp":
            start = None


def _calls(statement: ast.stmt) -> bool:
    """Return whether anything is called in a statement."""
    stack: list[ast.AST] = [statement]
    while stack:
        node = stack.pop()
        if type(node) is ast.Call:
            return True
        stack += children(node)
    return False


def _judged(program: AnalysedProgram, places: TargetPlaces, start: int, place: int) -> Iterator[Finding]:
    found = program.command_calls[place]
    node = next((node for param, node in program.arguments[place].given if param.name == "r"), None)
    r = None if node is None else program.constants.value(node, found.scope)
    if node is None or not isinstance(r, (int, float)) or not 0.0 < r <= BLEND_MOST_M:
        return
    most = _most(places, program, start, place)
    if most is not None and most > 0.0 and most < r * (1.0 - _ROOM):
        yield Finding(node, said(RADIUS_SHORTENED, r=float(r), most=most), said(RADIUS_HINT, most=most))


def _most(places: TargetPlaces, program: AnalysedProgram, start: int, place: int) -> float | None:
    """Return the longest radius that the way from one target to the next allows, m."""
    name = _name(program, place)
    if name == "movel":
        ends: list[Six | None] = [places.position(program.command_calls[at], at) for at in (start, place)]
        if ends[0] is None or ends[1] is None:
            return None
        return BLEND_SHARE * dist(ends[0][:3], ends[1][:3])
    if name == "movej" and _name(program, start) == "movej":
        q_from, q_to = places.argument(start, "q"), places.argument(place, "q")
        return None if q_from is None or q_to is None else places.farthest_m(q_from, q_to)
    return None
