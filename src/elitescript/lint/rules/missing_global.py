"""An assignment that makes a local variable where a global is meant.

In a function an assignment makes a new local variable, whatever the rest of the program declares global; the
global keeps its value, without a message. Found are names that the program's body declares `global` and a
function assigns without declaring them; names that a function assigns without using them while another one
declares them; and names that the body assigns for itself while a function declares them. The variable of a `for`
counts where only other functions read it: what the function itself uses is meant to be its own.

    def job():
      global level
      level = 0
      def fill():
        level = 100              # W202: the global stays 0
      end
      fill()
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.language.symbols import Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import Said, said


@rule(code="W202", since="0.1")
def missing_global(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first assignment of each such name in each scope."""
    for scope in program.symbols.scopes:
        if scope.kind not in ("function", "body"):
            continue
        for name, bindings in scope.bindings.items():
            first = next((binding for binding in bindings if binding.kind in _ASSIGNMENTS), None)
            if first is None and bindings[0].kind == "for" and _is_for_others(name, scope, program):
                first = bindings[0]
            if first is None or not scope.has_local(name) or name in scope.parameters or name in program.unread_names:
                continue
            owner = _declaring_scope(name, scope, program)
            if owner is not None:
                from elitescript.lint.insertions import declare

                yield Finding(
                    program.name_span(first.node, name),
                    said(
                        "`{name}` is a local variable here; {place} declares it global", name=name, place=_place(owner)
                    ),
                    said(
                        "write `global {name}` at the start of {place}, or use another name",
                        name=name,
                        place=_place(scope),
                    ),
                    declare(program, "global", name, scope),
                )


_ASSIGNMENTS: Final = ("assign", "augmented", "annotated", "walrus")
_LONGEST_COUNTER: Final = 2
"""Most characters of a name (`i`, `n2`) that counts as that of a loop counter."""


def _is_for_others(name: str, scope: Scope, program: AnalysedProgram) -> bool:
    """Return whether a loop variable of `scope` is not used there, while something reads a global of that name."""
    if len(name) <= _LONGEST_COUNTER or name not in program.symbols.global_names:
        return False
    return not program.symbols.reads_of(name, scope) and bool(program.symbols.reads_of(name, None))


def _declaring_scope(name: str, scope: Scope, program: AnalysedProgram) -> Scope | None:
    """Return the scope whose `global` statement the assignment in `scope` misses."""
    if name not in program.symbols.global_names:
        return None
    first = program.symbols.declaring(name)[0]
    body = program.symbols.body
    if scope is body:
        return first
    if scope.home(name) is not scope or program.symbols.is_nonlocal_inside(name, scope):
        return None
    if name in body.globals:
        return body
    # Two functions may use the same name for different things, but an assigned variable has a use.
    return None if program.symbols.reads_of(name, scope) else first


def _place(scope: Scope) -> str:
    if scope.kind == "body":
        return Said("the program") if not scope.name else said("the program `{scope}`", scope=scope.name)
    return said("the function `{scope}`", scope=scope.name) if scope.name else Said("another function")
