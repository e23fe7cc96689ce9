"""A `global` that nothing gives a value.

Reading it is an alarm (`NameError`), and the variable monitor never shows it. Often the assignment uses a
slightly different name. A secondary program declares the globals of the running program, so it is left alone;
a script without a `def` may be part of a larger program, so only a name that it never mentions again counts.

    def job():
      global parts
      part = 0                   # and not `parts`: W206 in the line above
    end
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from elitescript.language.advice.unknown_names import nearest
from elitescript.language.options import SCRIPT
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W206", since="0.1")
def unassigned_global(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first declaration of each such name."""
    if program.shares_globals or program.secondaries:
        return
    scopes = program.symbols.scopes
    for name in sorted(program.symbols.global_names.difference(program.unread_names, program.presets)):
        if any(binding.kind != "delete" for binding in program.symbols.global_bindings(name)):
            continue
        if program.parsed.kind == SCRIPT and any(name in scope.reads for scope in scopes):
            continue
        first = min(
            (statement for scope in scopes for statement in scope.globals.get(name, ())), key=lambda node: node.lineno
        )
        assigned = {other for scope in scopes for other in scope.bindings}
        meant = nearest(name, assigned)
        hint = said("is `{meant}` meant?", meant=meant) if meant else "give it a value, or leave the line out"
        yield Finding(
            _name_in(first, name, program), said("nothing gives the global `{name}` a value", name=name), hint
        )


def _name_in(statement: ast.Global, name: str, program: AnalysedProgram) -> Span:
    """Return the place of the name in its declaration."""
    span = program.span(statement)
    for number in range(span.line, span.end_line + 1):
        start = span.column if number == span.line else 1
        found = re.search(rf"(?<!\w){re.escape(name)}(?!\w)", program.source.line(number)[start - 1 :])
        if found:
            return Span(number, start + found.start(), number, start + found.end())
    return span
