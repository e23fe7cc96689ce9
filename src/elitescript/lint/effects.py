"""Determines which expressions have no effect besides their value."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.commands.definition.registry import Command
from elitescript.language.builtin_names import PURE_BUILTINS
from elitescript.language.nodes import children
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram

_PURE_FAMILIES: Final = frozenset(("kinematics", "lists", "maths", "poses", "strings"))
_READING: Final = ("get_", "is_", "read_")
_ALSO_READING: Final = frozenset(
    """
    cal_rpy_frame controller_timestamp encoder_get_tick_count encoder_unwind_delta_tick_count force modbus_get_error
    modbus_get_signal_status modbus_get_time_since_signal_invalid path_offset_get serial_is_open serial_mode
    socket_is_connected tool_serial_is_open tool_serial_mode
    """.split()  # noqa: SIM905
)
_CHANGING: Final = frozenset(("random", "get_micro_line_values_by_index"))
"""`random` gives another value each time; the other one belongs to a file that is loaded."""


def only_gives_a_value(command: Command) -> bool:
    """Return whether a command changes nothing, so that a call of it is made for its result alone."""
    if command.waits or command.name in _CHANGING:
        return False
    module = command.function.__module__.rpartition(".")[2]
    return module in _PURE_FAMILIES or command.name in _ALSO_READING or command.name.startswith(_READING)


def _is_pure_call(call: ast.Call, program: AnalysedProgram) -> bool:
    """Return whether a call only gives a value, whatever its arguments do: a reading command, `math.sin`, `len`."""
    function = call.func
    if isinstance(function, ast.Attribute):
        base = function.value
        scope = program.symbols.scope_of(call)
        return isinstance(base, ast.Name) and program.symbols.imported(base.id, scope) == "math"
    if not isinstance(function, ast.Name):
        return False
    scope = program.symbols.scope_of(function)
    command = program.command(function.id, scope)
    if command is not None:
        return only_gives_a_value(command)
    return function.id in PURE_BUILTINS and scope.resolve(function.id) is Resolution.BUILTIN


def has_effect(root: ast.expr, program: AnalysedProgram) -> bool:
    """Return whether evaluating an expression may do anything besides giving its value."""
    stack: list[ast.AST] = [root]
    while stack:
        node = stack.pop()
        if isinstance(node, (ast.Yield, ast.YieldFrom, ast.Await, ast.NamedExpr)):
            return True
        if isinstance(node, ast.Call) and not _is_pure_call(node, program):
            return True
        if not isinstance(node, ast.Lambda):
            stack += children(node)
    return False
