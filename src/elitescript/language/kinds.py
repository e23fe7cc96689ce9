"""Determines which kind of program a text is."""

from __future__ import annotations

import ast

from elitescript.language.options import PROGRAM, SCRIPT, SECONDARY
from elitescript.language.text.source import SourceFile


def outer_definition(tree: ast.Module) -> ast.FunctionDef | None:
    """Return the only statement of a text, if that is an undecorated `def`; texts in quotes do not count."""
    found = None
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef) and not statement.decorator_list and found is None:
            found = statement
        elif not is_text(statement):
            return None
    return found


def kind_of(tree: ast.Module, secondaries: frozenset[int]) -> str:
    """Return `program`, `secondary` or `script`.

    Args:
        tree: the syntax tree of the whole text.
        secondaries: lines of `sec` headers, which the tree has as `def`.
    """
    definition = outer_definition(tree)
    if definition is None:
        return SCRIPT
    return SECONDARY if definition.lineno in secondaries else PROGRAM


def is_sent_program(source: SourceFile) -> bool:
    """Return whether a text is a program that a client has sent: it is named after the client, as `<primary#3>`."""
    return source.name.startswith("<") and "#" in source.name and source.text.lstrip().startswith("def")


def is_text(statement: ast.stmt) -> bool:
    """Return whether a statement is only a text in quotes: a docstring, or a comment in that form."""
    value = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(value, ast.Constant) and isinstance(value.value, str)
