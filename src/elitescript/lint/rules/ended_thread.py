"""A thread that the end of the program ends, with an output, a write or a move still to make.

All threads end with the program. The waiting in front of what is left is longer than what the program waits after it
has started the thread; where either is not known, nothing is said.

    def job():
      def late():
        sleep(5)
        set_standard_digital_out(0, True)         # N222: the program has ended by then
      end
      t = start_thread(late, ())
      sleep(1)                                    # join_thread(t) waits for it
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Final

from elitescript.language.options import PROGRAM, SCRIPT
from elitescript.language.scopes import Scope
from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_START: Final = "start_thread"
_WAIT: Final = "sleep"
_EFFECTS: Final = ("set_", "write_", "move", "modbus_set_output_", "socket_send_", "serial_write", "tool_serial_write")


@rule(code="N222", since="0.3", needs_all_lines=True)
def ended_thread(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first such statement of each thread."""
    if program.parsed.kind not in (PROGRAM, SCRIPT):
        return
    symbols = program.symbols
    for found in program.derived(CalledCommands).of(_START):
        statements = symbols.body.statements
        place = next((index for index, statement in enumerate(statements) if _holds(statement, found.call)), None)
        if place is None or not isinstance(statements[place], (ast.Expr, ast.Assign)):
            continue
        left_s = _waiting(program, statements[place + 1 :])
        function = found.given.get("function")
        if left_s is None or not isinstance(function, ast.Name):
            continue
        for target in symbols.definitions(function.id, found.scope):
            late = _too_late(program, target, left_s)
            if late is not None:
                text = said(
                    "{command}: the program ends {left_s:g} s after it has started this thread, and ends it too",
                    command=late.name,
                    left_s=left_s,
                )
                yield Finding(late.call, text, "join_thread waits for a thread")


def _holds(statement: ast.stmt, call: ast.Call) -> bool:
    return statement.lineno <= call.lineno <= (statement.end_lineno or statement.lineno)


def _waiting(program: AnalysedProgram, statements: Sequence[ast.stmt]) -> float | None:
    """Return how long statements take, s; None if that is not known."""
    seconds = 0.0
    for statement in statements:
        if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
            continue
        if isinstance(statement, (ast.While, ast.For, ast.Try, ast.With, ast.Match)):
            return None
        for node in ast.walk(statement):
            taken = _taken(program, node)
            if taken is None:
                return None
            seconds += taken
    return seconds


def _taken(program: AnalysedProgram, node: ast.AST) -> float | None:
    """Return how long one call takes, s; 0 for anything else; None if that is not known."""
    if not isinstance(node, ast.Call):
        return 0.0
    scope = program.symbols.scope_of(node)
    command = program.command(node.func.id, scope) if isinstance(node.func, ast.Name) else None
    if command is None:
        is_quick = isinstance(node.func, ast.Name) and node.func.id in ("str", "len", "range", "int", "float")
        return 0.0 if is_quick else None
    if command.name == _WAIT and len(node.args) == 1:
        time_s = program.constants.value(node.args[0], scope)
        return float(time_s) if isinstance(time_s, (int, float)) else None
    return None if command.waits else 0.0


def _too_late(program: AnalysedProgram, target: Scope, left_s: float) -> Called | None:
    """Return the first call with an effect that a thread comes to after some time; None if there is none."""
    seconds = 0.0
    for statement in target.statements:
        if isinstance(statement, (ast.While, ast.For, ast.Try, ast.If, ast.With, ast.Match)):
            return None
        for node in ast.walk(statement):
            if seconds > left_s:
                late = _effect(program, node)
                if late is not None:
                    return late
            taken = _taken(program, node)
            if taken is None:
                return None
            seconds += taken
    return None


def _effect(program: AnalysedProgram, node: ast.AST) -> Called | None:
    if not isinstance(node, ast.Call):
        return None
    for found in program.derived(CalledCommands):
        if found.call is node and found.name.startswith(_EFFECTS):
            return found
    return None
