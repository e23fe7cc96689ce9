"""Writes repairs that insert a statement at the start of a function or of the program."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.scopes import Scope
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.lint.program import AnalysedProgram


def declare(program: AnalysedProgram, word: str, name: str, scope: Scope) -> Fix:
    """Return the repair that declares a name `global` or `nonlocal` in a scope."""
    where = said(" in `{scope}`", scope=scope.name) if scope.name else ""
    return Fix(
        said("declare `{name}` {word}{where}", name=name, word=word, where=where),
        (_first(program, f"{word} {name}", scope),),
        safe=False,
    )


def import_module(program: AnalysedProgram, name: str) -> Fix:
    """Return the repair that imports a module at the start of the program."""
    return Fix(said("import {name}", name=name), (_first(program, f"import {name}", program.symbols.body),), safe=False)


def _first(program: AnalysedProgram, statement: str, scope: Scope) -> Edit:
    """Return the edit that puts a statement in front of the first one of a scope, behind its docstring."""
    statements = scope.statements
    first = statements[0]
    is_docstring = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    if is_docstring and len(statements) > 1:
        first = statements[1]
    decorators = getattr(first, "decorator_list", [])
    if decorators:
        line = program.symbols.place(decorators[0])[0]
        column = program.source.line(line).index("@") + 1
    else:
        line, column = program.symbols.place(first)
    before = program.source.line(line)[: column - 1]
    separator = "; " if before.strip() else f"\n{before}"
    return Edit(line, column, line, column, f"{statement}{separator}")
