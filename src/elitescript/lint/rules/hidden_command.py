"""A name of the robot's own commands, used for something else.

From there on the command cannot be called, in the program's body also not by any function inside it. Some
commands are named like everyday things (`force`, `length`, `norm`), and functions may call their parameters
and local variables as they like: both are reported only where a call then misses the command. Words that the
vendor's tools reserve are reported as well, but not `end` and other plain words.

    def job():
      sleep = 5                  # W203
      sleep(1)                   # an alarm: 5 cannot be called
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.commands.catalogue import CATALOGUE
from elitescript.commands.definition.reserved import RESERVED
from elitescript.language.symbols import Binding, Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W203", since="0.1")
def hidden_command(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first binding of each such variable."""
    seen = set()
    for scope in program.symbols.scopes:
        if scope.kind not in ("body", "function"):
            continue
        for name, bindings in scope.bindings.items():
            command = CATALOGUE.get(name)
            if command is None and (name not in RESERVED or name in _PLAIN_WORDS):
                continue
            first = next((binding for binding in bindings if binding.kind not in _NOT_HIDING), None)
            variable = (name, scope.home(name))
            if first is None or name in scope.nonlocals or variable in seen:
                continue
            seen.add(variable)
            if command is None:
                if not _is_private(first, scope):
                    text = said("`{name}` is a word that the robot's own tools reserve", name=name)
                    yield Finding(program.name_span(first.node, name), text, "use another name")
            elif command.evidence == "documented" and program.is_available(command):
                is_missed = _is_missed(name, first, scope, program)
                if is_missed or not (name in _EVERYDAY or _is_private(first, scope)):
                    text = said("`{name}` hides the robot command {signature}", name=name, signature=command.signature)
                    hint = "calls of it below mean this one" if is_missed else "use another name"
                    yield Finding(program.name_span(first.node, name), text, hint)


_NOT_HIDING: Final = ("import", "delete")
"""`from math import sin` gives the same function."""

_EVERYDAY: Final = frozenset(("force", "length", "log", "norm", "pow", "random"))
"""Commands whose names are ordinary names of variables, too."""

_PLAIN_WORDS: Final = frozenset(("end", "join", "kill", "local", "run", "thread", "xor"))
"""Reserved words that programs use for things of their own."""


def _is_private(binding: Binding, scope: Scope) -> bool:
    """Return whether it is a variable of one function alone."""
    return scope.kind == "function" and scope.has_local(binding.name) and binding.kind not in ("def", "class")


def _is_missed(name: str, first: Binding, scope: Scope, program: AnalysedProgram) -> bool:
    """Return whether a variable, which is no function, is called where the command would be."""
    if first.kind in ("def", "class", "parameter"):
        return False
    home = scope if scope.has_local(name) else None
    reads = program.symbols.reads_of(name, home)
    return any(getattr(program.symbols.parent(read), "func", None) is read for read in reads)
