"""Which moves of a program give a speed and an acceleration, by line."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from inspect import signature
from math import isfinite
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple

MOVES: Final = ("movej", "movel", "movep", "movec")


class ProgramMove(NamedTuple):
    """A move in the text of a program."""

    name: str
    line: int
    given: Mapping[str, float | None]
    """Arguments of the call by parameter: the number, None if it is not written as one. A parameter that the call
    leaves out is missing."""

    @property
    def is_joint(self) -> bool:
        return self.name == "movej"

    def has_default(self, parameter: str) -> bool:
        """Return whether the call leaves a parameter to its default, and gives no time that replaces it."""
        return parameter not in self.given and self.given.get("t", 0.0) == 0.0


def moves_of(text: str, name: str) -> dict[int, ProgramMove]:
    """Return the moves of a program by line; lines with two moves are left out, since no recording tells them apart."""
    found: dict[int, ProgramMove] = {}
    doubled = set()
    for node in ast.walk(parse(SourceFile(name, text)).tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in MOVES:
            move = ProgramMove(node.func.id, node.lineno, _given(node))
            for line in range(node.lineno, (node.end_lineno or node.lineno) + 1):
                if line in found:
                    doubled.add(line)
                found[line] = move
    return {line: move for line, move in found.items() if line not in doubled}


def _given(call: ast.Call) -> dict[str, float | None]:
    assert isinstance(call.func, ast.Name)
    command = CATALOGUE.get(call.func.id)
    names = [] if command is None else list(signature(command.function).parameters)[1:]
    given = {name: _number(node) for name, node in zip(names, call.args, strict=False)}
    given.update({word.arg: _number(word.value) for word in call.keywords if word.arg})
    return given


def _number(node: ast.expr) -> float | None:
    try:
        value = ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return None
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
    return float(value) if is_number else None
