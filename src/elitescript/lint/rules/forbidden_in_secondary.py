"""A call that a secondary program may not make.

What `sec` starts runs beside the program and has to be short: it cannot move the arm, wait, or start threads.
The call is refused when it is reached.

    sec lamp():
      set_standard_digital_out(1, True)
      sleep(1)                   # W205
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W205", since="0.1")
def forbidden_in_secondary(program: AnalysedProgram) -> Iterator[Finding]:
    """Report such calls inside `sec`."""
    if not program.secondaries:
        return
    forbidden = [(call, command.name) for command, call, _ in program.command_calls if not command.works_in_sec]
    forbidden += [(call, _PYTHON_SLEEP) for call in _python_sleeps(program)]
    forbidden += _remote_calls(program)
    for call, name in forbidden:
        if program.is_in_secondary(call):
            yield Finding(
                call.func,
                said(
                    "a secondary program (sec) may not call {name}: it cannot move the arm, wait or start threads",
                    name=name,
                ),
                "do it in the program; a secondary program can set a global for it",
            )


_PYTHON_SLEEP: Final = "time.sleep"
"""Python's own function that waits, and so is refused like the command `sleep`."""


def _remote_calls(program: AnalysedProgram) -> Iterator[tuple[ast.Call, str]]:
    """Yield remote procedures, called through what `rpc_factory` gave in the same text."""
    for scope in program.symbols.scopes:
        for call in scope.calls:
            base = call.func.value if isinstance(call.func, ast.Attribute) else None
            if isinstance(base, ast.Name):
                bindings = program.symbols.bindings(base.id, scope)
                sources = [getattr(program.symbols.parent(binding.node), "value", None) for binding in bindings]
            else:
                sources = [base]
            if sources and all(_is_factory(source, program) for source in sources):
                yield call, "remote procedures"


def _is_factory(node: ast.AST | None, program: AnalysedProgram) -> bool:
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name) or node.func.id != "rpc_factory":
        return False
    return program.command(node.func.id, program.symbols.scope_of(node)) is not None


def _python_sleeps(program: AnalysedProgram) -> Iterator[ast.Call]:
    module, _, name = _PYTHON_SLEEP.partition(".")
    for scope in program.symbols.scopes:
        for call in scope.calls:
            function = call.func
            if isinstance(function, ast.Name):
                is_sleep = program.symbols.imported(function.id, scope) == _PYTHON_SLEEP
            elif isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
                is_sleep = function.attr == name and program.symbols.imported(function.value.id, scope) == module
            else:
                is_sleep = False
            if is_sleep:
                yield call
