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
from collections.abc import Iterator

from elitescript.language.advice.unknown_names import Meant
from elitescript.language.options import SCRIPT
from elitescript.language.text.source import find_word
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W206", since="0.1")
def unassigned_global(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first declaration of each such name."""
    if program.shares_globals or program.secondaries:
        return
    scopes = program.symbols.scopes
    read = {name for scope in scopes for name in scope.reads}
    meant = Meant(lambda: {name for scope in scopes for name in scope.bindings})
    for name in sorted(program.symbols.global_names.difference(program.unread_names, program.presets)):
        if any(binding.kind != "delete" for binding in program.symbols.global_bindings(name)):
            continue
        if program.parsed.kind == SCRIPT and name in read:
            continue
        statements = [node for scope in program.symbols.declaring(name) for node in scope.globals[name]]
        first = min(statements, key=lambda node: node.lineno)
        other = meant.by(name)
        if program.source.places:
            # Its declaration was generated: what is meant is where a node uses it.
            uses = [node for scope in scopes for node in scope.reads.get(name, ())]
            if uses:
                hint = said("is `{meant}` meant?", meant=other) if other else said("give it a value in a node before")
                text = said("the variable {name} has no value", name=name)
                yield Finding(min(uses, key=lambda node: node.lineno), text, hint)
            continue
        hint = said("is `{meant}` meant?", meant=other) if other else "give it a value, or leave the line out"
        yield Finding(
            _name_in(first, name, program), said("nothing gives the global `{name}` a value", name=name), hint
        )


def _name_in(statement: ast.Global, name: str, program: AnalysedProgram) -> Span:
    """Return the place of the name in its declaration."""
    span = program.span(statement)
    for number in range(span.line, span.end_line + 1):
        start = span.column if number == span.line else 1
        place = find_word(program.source.line(number), name, start - 1)
        if place >= 0:
            return Span(number, place + 1, number, place + 1 + len(name))
    return span
