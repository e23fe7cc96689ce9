"""A name that nothing defines: not the program, not the robot, not Python.

The line is legal, and an alarm (`NameError`) when it is reached; often it is a slip, or a `true` for `True`.
A secondary program is left alone, because it finds the globals of whatever program runs.

    def job():
      speed = 0.25
      movel(TARGET, v=sped)      # W201 TARGET, W201 sped: is `speed` meant?
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.commands.reserved import GENERATED_PREFIXES
from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.kinds import SCRIPT
from elitescript.language.modules import AVAILABLE
from elitescript.language.symbols import Scope
from elitescript.lint.program import Program, Use
from elitescript.lint.registry import Finding, rule
from elitescript.lint.suggestions import MOST_SUGGESTIONS, nearest, visible_names


@rule(code="W201", since="0.1")
def unknown_name(program: Program) -> Iterator[Finding]:
    """Report uses of names that nothing defines, other than calls."""
    if program.shares_globals:
        return
    hints: dict[tuple[str, int], tuple[str, str]] = {}
    for use in program.unknown:
        name = use.name
        if use.is_call or _belongs_to_a_pendant_program(name, program) or program.expects_missing_names(use.node):
            continue
        key = (name, id(use.scope))
        if key not in hints:
            hints[key] = _meant(use, program, is_searched=len(hints) < MOST_SUGGESTIONS)
        meant, hint = hints[key]
        fix = None
        if meant:
            line, column, end_line, end_column = program.span(use.node)
            edit = Edit(line, column, end_line, end_column, meant)
            fix = Fix(f"write {meant}", (edit,), safe=name in _WORDS)
        yield Finding(use.node, f"the name `{name}` is not defined", hint, fix)


_PLACEHOLDERS: Final = ("null", "unconfigured")
"""What the pendant's plug-ins write, as a line of its own, for something that is not set up (*observed*)."""

_WORDS: Final = {
    "true": "True",
    "TRUE": "True",
    "false": "False",
    "FALSE": "False",
    "none": "None",
    "null": "None",
    "NULL": "None",
    "nil": "None",
}


def _belongs_to_a_pendant_program(name: str, program: Program) -> bool:
    """A script without a `def` may be a node of a program whose other parts the pendant writes."""
    return program.parsed.kind == SCRIPT and name.startswith(GENERATED_PREFIXES)


def _meant(use: Use, program: Program, *, is_searched: bool) -> tuple[str, str]:
    """The name that is meant, if that is clear, and the hint."""
    name = use.name
    if name in _PLACEHOLDERS and isinstance(program.symbols.parent(use.node), ast.Expr):
        return "", "the pendant writes this for something that is not set up"
    if name in _WORDS:
        return _WORDS[name], f"write {_WORDS[name]}"
    if name in AVAILABLE:
        return "", f"write `import {name}` before it"
    owner = _owner(name, program)
    if owner is not None:
        return "", f"it is a local variable of `{owner.name}`; declare it `global` there to share it"
    meant = nearest(name, visible_names(use, program)) if is_searched else ""
    return meant, f"is `{meant}` meant?" if meant else ""


def _owner(name: str, program: Program) -> Scope | None:
    """A function that has a local variable of that name, where its users cannot see it."""
    functions = (scope for scope in program.symbols.scopes if scope.kind == "function")
    return next((scope for scope in functions if scope.has_local(name) and name not in scope.parameters), None)
