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
from bisect import bisect_right
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


@rule(code="N222", since="0.3", needs_all_lines=True, needs_values=True)
def ended_thread(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first such statement of each thread."""
    if program.parsed.kind not in (PROGRAM, SCRIPT):
        return
    symbols = program.symbols
    starts = program.derived(CalledCommands).of(_START)
    if not starts:
        return
    left = _waiting(program, symbols.body.statements)
    timelines: dict[Scope, list[tuple[float, Called]]] = {}
    for found in starts:
        statement = _statement_of_body(program, found.call)
        if not isinstance(statement, (ast.Expr, ast.Assign)):
            continue
        left_s = left[symbols.block_of(statement)[2] + 1]
        function = found.given.get("function")
        if left_s is None or not isinstance(function, ast.Name):
            continue
        for target in symbols.definitions(function.id, found.scope):
            if target not in timelines:
                timelines[target] = list(_effects(program, target))
            effects = timelines[target]
            place = bisect_right(effects, left_s, key=lambda effect: effect[0])
            if place < len(effects):
                late = effects[place][1]
                text = said(
                    "{command}: the program ends {left_s:g} s after it has started this thread, and ends it too",
                    command=late.name,
                    left_s=left_s,
                )
                yield Finding(late.call, text, "join_thread waits for a thread")


def _statement_of_body(program: AnalysedProgram, call: ast.Call) -> ast.AST:
    """Return the statement of the program's body in which a call stands."""
    child: ast.AST = call
    for above in program.symbols.ancestors(call):
        if above is program.symbols.body.node:
            break
        child = above
    return child


def _waiting(program: AnalysedProgram, statements: Sequence[ast.stmt]) -> list[float | None]:
    """Return how long what begins at each statement takes, s, and at their end; None where that is not known."""
    left: list[float | None] = [0.0]
    for statement in reversed(statements):
        seconds = left[-1]
        if isinstance(statement, (ast.While, ast.For, ast.Try, ast.With, ast.Match)):
            seconds = None
        if seconds is not None and not isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
            for node in ast.walk(statement):
                taken = _taken(program, node)
                if taken is None:
                    seconds = None
                    break
                seconds += taken
        left.append(seconds)
    return left[::-1]


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


def _effects(program: AnalysedProgram, target: Scope) -> Iterator[tuple[float, Called]]:
    """Yield the calls with an effect that a thread comes to, and after how long, s, as far as that is known."""
    called = program.derived(CalledCommands)
    seconds = 0.0
    for statement in target.statements:
        if isinstance(statement, (ast.While, ast.For, ast.Try, ast.If, ast.With, ast.Match)):
            return
        for node in ast.walk(statement):
            found = called.at(node)
            if found is not None and found.name.startswith(_EFFECTS):
                yield seconds, found
            taken = _taken(program, node)
            if taken is None:
                return
            seconds += taken
