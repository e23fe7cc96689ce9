"""Finds loops in which a program waits, so that it can be said since when it does.

Such a loop is marked: the runtime keeps the tick in which a thread has come to it. That costs a call for each time that
the loop is begun, none in its passes, and other loops have no mark.
"""

from __future__ import annotations

import ast
from bisect import bisect_left
from typing import Final

from elitescript.language.nodes import Census

_WAITING: Final = (
    *("sleep", "sync", "wait", "get", "read", "recv", "acquire", "locked", "join", "is_", "socket_", "serial_"),
    *("tool_", "modbus_", "rpc", "popup", "time", "move", "servo", "speed", "stop"),
)
"""How names of functions and methods begin with which a loop waits, or looks at what it waits for."""
_ROUNDS_MAX: Final = 3
"""Helpers of helpers of helpers that are followed."""


def waiting_loops(census: Census) -> list[ast.While]:
    """Return the `while` loops that wait: with a call of such a function, also in a helper, or with nothing to do."""
    loops = census.of(ast.While)
    if not loops:
        return []
    calls = [(_called(call), call.lineno) for call in census.of(ast.Call)]
    lines = sorted(line for name, line in calls if name.startswith(_WAITING))
    functions = census.of(ast.FunctionDef)
    helpers: set[str] = set()
    for _ in range(_ROUNDS_MAX):
        found = {function.name for function in functions if _has_one(function, lines)} - helpers
        if not found:
            break
        helpers |= found
        lines = sorted([*lines, *(line for name, line in calls if name in found)])
    return [loop for loop in loops if _has_one(loop, lines) or _does_nothing(loop.body)]


def _called(call: ast.Call) -> str:
    function = call.func
    if isinstance(function, ast.Name):
        return function.id
    return function.attr if isinstance(function, ast.Attribute) else ""


def _has_one(node: ast.stmt, lines: list[int]) -> bool:
    """Return whether one of the lines, which are sorted, belongs to a statement."""
    at = bisect_left(lines, node.lineno)
    return at < len(lines) and lines[at] <= (node.end_lineno or node.lineno)


def _does_nothing(body: list[ast.stmt]) -> bool:
    """Return whether the body of a loop changes nothing, so that it can only wait for something else."""
    for statement in body:
        if isinstance(statement, ast.If):
            if not _does_nothing(statement.body) or not _does_nothing(statement.orelse):
                return False
        elif not isinstance(statement, ast.Pass | ast.Continue | ast.Break):
            return False
    return True
