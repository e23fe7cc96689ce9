"""A function that nothing calls, and that no thread runs: its lines are never run.

Often the start of the thread, or the call, is missing or has another name. A function kept for later is no mistake, so
this is a note.

    def job():
      def watch():                                # N228: start_thread(watch, ())
        while True:
          set_flag(0, get_standard_digital_in(0))
          sleep(0.1)
        end
      end
      def blink():                                # fine
        set_standard_digital_out(0, True)
      end
      blink()
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.definition.reserved import GENERATED_PREFIXES
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_FOREIGN: Final = frozenset(("eval", "exec", "globals", "interpreter_mode", "locals", "vars"))
"""Names by which other texts may reach a function."""
_OTHERS: Final = ("_", *GENERATED_PREFIXES)
"""Names of functions that are kept for later, and of those that the pendant writes."""
_OF_TESTS: Final = ("test_", "mock_")


@rule(code="N228", since="0.3", needs_all_lines=True)
def uncalled_function(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the functions of a program that are never named."""
    symbols = program.symbols
    functions = [
        scope for scope in symbols.scopes if scope.kind == "function" and isinstance(scope.node, ast.FunctionDef)
    ]
    if any(scope.name.startswith(_OF_TESTS) for scope in functions):
        return
    if any(name in scope.reads for scope in symbols.scopes for name in _FOREIGN):
        return
    # A name that nothing defines may be meant for it: that is told there.
    if any(use.is_call for use in program.unknown):
        return
    for scope in functions:
        node, parent = scope.node, scope.parent
        if (
            parent is None
            or parent.kind == "class"
            or (parent is symbols.body and program.parsed.unit is None)
            or scope.name.startswith(_OTHERS)
            or not isinstance(node, ast.FunctionDef)
        ):
            continue
        if (
            node.decorator_list
            or len(parent.bindings[scope.name]) > 1
            or symbols.reads_of(scope.name, parent.home(scope.name))
        ):
            continue
        is_endless = any(isinstance(part, ast.While) for part in node.body)
        hint = "call it, or remove it"
        if is_endless:
            hint = said("start it: start_thread({name}, ())", name=scope.name)
        text = said("nothing calls `{name}`, and no thread runs it", name=scope.name)
        yield Finding(program.name_span(node, scope.name), text, hint)
