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
      p = get_target_tcp_pose()
      p[0] = p[0] + socket_read_ascii_float(1)[1]
      movel(p)                                    # W262: a number of a reading is part of p
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Final

from elitescript.language.scopes import Binding, Scope
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

_ADDING: Final = ("append", "insert", "extend")
"""Methods that make an argument part of a list."""
_ASKING: Final = (ast.If, ast.While, ast.IfExp, ast.Assert, ast.Compare, ast.BoolOp, ast.Match)

Variable = tuple[str, Scope | None]
Carrier = Variable | ast.Call


@rule(code="W262", since="0.3", needs_all_lines=True, needs_values=True)
def unasked_reading(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first use of each such reading."""
    readings = [found for found in program.derived(CalledCommands).of(*_READERS) if found.call.lineno]
    if not readings:
        return
    refused = {refusal.node for refusal in program.refusals}
    sinks = _sinks(program)
    for reading in readings:
        carriers = _carriers(program, reading.call)
        if carriers is None:
            continue
        reached = [
            sink
            for part, since in ((reading.call, 0), *carriers.items())
            for sink in sinks.get(part, ())
            if sink.call.lineno > since and not (since and _is_renewed(program, part, since, sink.call.lineno))
        ]
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


def _sinks(program: AnalysedProgram) -> dict[Carrier, list[Called]]:
    """Return the moves, outputs and registers that each variable, and each call, reaches, in order."""
    found: dict[Carrier, list[Called]] = {}
    sinks = [called for called in program.derived(CalledCommands) if called.name.startswith(_SINKS)]
    for sink in sorted(sinks, key=lambda called: called.call.lineno):
        for node in sink.given.values():
            for part in ast.walk(node):
                if isinstance(part, ast.Call):
                    found.setdefault(part, []).append(sink)
                elif isinstance(part, ast.Name):
                    home = program.symbols.scope_of(part).home(part.id)
                    found.setdefault((part.id, home), []).append(sink)
    return found


def _carriers(program: AnalysedProgram, call: ast.Call) -> dict[Carrier, int] | None:
    """Return the variables and calls that are a reading, or what was computed of it; None if that is not certain.

    Each has the line behind which it is so; 0 for everywhere.
    """
    symbols = program.symbols
    found: dict[Carrier, int] = {}
    waiting: list[ast.AST] = [call]

    def carry(target: ast.expr, since: int) -> bool:
        """Note what a target carries from a line on; return whether it is certain what it is."""
        if isinstance(target, (ast.Tuple, ast.List)):
            return all(carry(part, since) for part in target.elts)
        name = target.value if isinstance(target, ast.Subscript) else target
        if not isinstance(name, ast.Name):
            return False
        variable = (name.id, symbols.scope_of(name).home(name.id))
        if not since and _has_other_values(program, *variable):
            return False
        if variable not in found:
            found[variable] = since
            waiting.extend(read for read in symbols.reads_of(*variable) if read.lineno > since)
        return True

    while waiting:
        node = below = waiting.pop()
        for above in symbols.ancestors(node):
            if isinstance(above, _ASKING):
                # Its body holds the statement; its test would ask.
                if isinstance(above, (ast.If, ast.While)) and node not in _within(above.test):
                    break
                return None
            if isinstance(above, ast.Return):
                # The function's callers have it.
                calls = _callers(program, above)
                if calls is None:
                    return None
                found.update(dict.fromkeys(calls, 0))
                waiting += calls
                break
            if isinstance(above, (ast.Yield, ast.Lambda, ast.For)) or not _is_gone_through(above, below):
                return None
            if isinstance(above, ast.Call) and above is not node and above is not call:
                given = _parameter(program, above, node)
                if given is not None:
                    if given not in found:
                        found[given] = 0
                        waiting += symbols.reads_of(*given)
                    break
                method = above.func
                if isinstance(method, ast.Attribute) and method.attr in _ADDING:
                    if below is not method and not carry(method.value, above.lineno):
                        return None
                    break
                is_copy = below is method and isinstance(method, ast.Attribute) and method.attr == "copy"
                if not is_copy and (below is method or not _is_followed(program, above)):
                    return None
            if isinstance(above, ast.AugAssign):
                if below is above.value and not carry(above.target, above.lineno):
                    return None
                break
            if isinstance(above, ast.Assign):
                if below is above.value:
                    for target in above.targets:
                        is_part = isinstance(target, ast.Subscript)
                        if not carry(target, above.lineno if is_part else 0):
                            return None
                break
            if isinstance(above, ast.stmt):
                break
            below = above
    return found


def _is_gone_through(above: ast.AST, below: ast.AST) -> bool:
    """Return whether a comprehension takes all elements of a value; True for what is no comprehension."""
    if isinstance(above, ast.comprehension):
        return below is above.iter and not above.ifs
    if isinstance(above, (ast.ListComp, ast.GeneratorExp)):
        return isinstance(below, ast.comprehension) and not any(
            isinstance(part, _ASKING) for part in ast.walk(above.elt)
        )
    return not isinstance(above, (ast.SetComp, ast.DictComp))


def _is_renewed(program: AnalysedProgram, carrier: Carrier, since: int, until: int) -> bool:
    """Return whether a variable gets another value between two lines."""
    if isinstance(carrier, ast.Call):
        return False
    return any(since < binding.line < until for binding in _bindings(program, *carrier))


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
    return len(_bindings(program, name, home)) > 1


def _bindings(program: AnalysedProgram, name: str, home: Scope | None) -> Sequence[Binding]:
    return program.symbols.bindings(name, program.symbols.body) if home is None else home.bindings[name]
