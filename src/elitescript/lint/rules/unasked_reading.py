"""Numbers of a reading that may have failed, which reach a move, an output or a register unasked.

A reading of numbers returns first how many arrived. What did not come is nan or -1. Any condition that asks for the
reading, or a `try` around the command, is enough.

    def job():
      socket_open("192.168.1.20", 5000)
      r = socket_read_ascii_float(3)
      movel([r[1], r[2], 0.4, 3.14159, 0, 0])     # W262: if r[0] == 3:
      s = socket_read_ascii_float(2)
      if s[0] == 2:
        movel([s[1], s[2], 0.4, 3.14159, 0, 0])   # fine
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_READERS: Final = {
    "socket_read_ascii_float": "nan",
    "socket_read_binary_integer": "-1",
    "socket_read_byte_list": "-1",
}
"""Readings that say first how many values arrived, and what stands in place of a value that did not."""
_SINKS: Final = ("move", "servoj", "speed", "set_", "write_", "modbus_set_output_")

Variable = tuple[str, Scope | None]


@rule(code="W262", since="0.3", needs_all_lines=True, needs_values=True)
def unasked_reading(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first use of each such reading."""
    readings = [found for found in program.derived(CalledCommands).of(*_READERS) if found.call.lineno]
    if not readings:
        return
    refused = {refusal.node for refusal in program.refusals}
    sinks = _sinks(program)
    for reading in readings:
        names = _carriers(program, reading.call)
        if names is None:
            continue
        reached = [sinks[part] for part in (reading.call, *names) if part in sinks]
        sink = min(reached, key=lambda found: found.call.lineno, default=None)
        if sink is not None and refused.isdisjoint(sink.given.values()) and not program.is_tried(sink.call):
            text = said(
                "{command}: {reading} of line {line} may have failed: then it is {failed}",
                command=sink.name,
                reading=reading.name,
                line=reading.call.lineno,
                failed=_READERS[reading.name],
            )
            hint = "ask before how many values arrived, the first element"
            yield Finding(sink.call, text, hint)


def _sinks(program: AnalysedProgram) -> dict[Variable | ast.Call, Called]:
    """Return the first move, output or register that each variable, and each call, reaches."""
    found: dict[Variable | ast.Call, Called] = {}
    sinks = [called for called in program.derived(CalledCommands) if called.name.startswith(_SINKS)]
    for sink in sorted(sinks, key=lambda called: called.call.lineno):
        for node in sink.given.values():
            for part in ast.walk(node):
                if isinstance(part, ast.Call):
                    found.setdefault(part, sink)
                elif isinstance(part, ast.Name):
                    found.setdefault((part.id, program.symbols.scope_of(part).home(part.id)), sink)
    return found


def _carriers(program: AnalysedProgram, call: ast.Call) -> set[Variable | ast.Call] | None:
    """Return the variables and calls that are a reading, or what was computed of it; None if that is not certain."""
    symbols = program.symbols
    found: set[Variable | ast.Call] = set()
    waiting: list[ast.AST] = [call]
    while waiting:
        node = waiting.pop()
        for above in symbols.ancestors(node):
            if isinstance(above, (ast.If, ast.While, ast.IfExp, ast.Assert, ast.Compare, ast.BoolOp, ast.Match)):
                # Its body holds the statement; its test would ask.
                if isinstance(above, (ast.If, ast.While)) and node not in _within(above.test):
                    break
                return None
            if isinstance(above, ast.Return):
                # The function's callers have it.
                calls = _callers(program, above)
                if calls is None:
                    return None
                found |= calls
                waiting += calls
                break
            if isinstance(above, (ast.Yield, ast.Lambda, ast.For, ast.comprehension, ast.AugAssign)):
                return None
            if isinstance(above, ast.Call) and above is not node and above is not call:
                given = _parameter(program, above, node)
                if given is not None:
                    if given not in found:
                        found.add(given)
                        waiting += symbols.reads_of(*given)
                    break
                if not _is_followed(program, above):
                    return None
            if isinstance(above, ast.Assign):
                for target in above.targets:
                    if not isinstance(target, ast.Name):
                        return None
                    variable = (target.id, symbols.scope_of(target).home(target.id))
                    if variable not in found:
                        if _has_other_values(program, *variable):
                            return None
                        found.add(variable)
                        waiting += symbols.reads_of(*variable)
                break
            if isinstance(above, ast.stmt):
                break
    return found


def _callers(program: AnalysedProgram, statement: ast.Return) -> set[ast.Call] | None:
    """Return the calls of the function that a statement ends; None if it may be used otherwise."""
    symbols = program.symbols
    scope = symbols.scope_of(statement)
    if not isinstance(scope.node, ast.FunctionDef) or scope.parent is None or scope.node.decorator_list:
        return None
    if len(symbols.bindings(scope.name, scope.parent)) != 1:
        return None
    calls: set[ast.Call] = set()
    for read in symbols.reads_of(scope.name, scope.parent.home(scope.name)):
        above = symbols.parent(read)
        if not isinstance(above, ast.Call) or above.func is not read:
            return None
        calls.add(above)
    return calls


def _parameter(program: AnalysedProgram, call: ast.Call, node: ast.AST) -> Variable | None:
    """Return the parameter of a function of the program that a value goes to; None for any other call."""
    if not isinstance(call.func, ast.Name) or not isinstance(node, ast.expr) or node not in call.args:
        return None
    made = program.symbols.definitions(call.func.id, program.symbols.scope_of(call))
    at = call.args.index(node)
    if len(made) != 1 or any(isinstance(part, ast.Starred) for part in call.args):
        return None
    scope = made[0]
    names = list(scope.parameters)
    if at >= len(names) or len(scope.bindings[names[at]]) != 1:
        return None
    return names[at], scope


def _within(node: ast.AST) -> set[ast.AST]:
    return set(ast.walk(node))


def _is_followed(program: AnalysedProgram, call: ast.Call) -> bool:
    """Return whether a call takes a value and does not ask for it: a command, or a function that converts it."""
    if not isinstance(call.func, ast.Name):
        return False
    name = call.func.id
    scope = program.symbols.scope_of(call)
    return program.command(name, scope) is not None or name in ("float", "int", "abs", "round", "list", "str")


def _has_other_values(program: AnalysedProgram, name: str, home: Scope | None) -> bool:
    """Return whether a variable is assigned in more than one place, so that it may hold something else."""
    bindings = program.symbols.bindings(name, program.symbols.body) if home is None else home.bindings[name]
    return len(bindings) > 1
