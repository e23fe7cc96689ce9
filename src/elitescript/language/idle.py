"""Detects texts in which nothing runs: they hold no statement, or only define functions.

A `def` that stands alone is the program. With a line beside it the whole text is the program and each `def` in it a
function, which runs only if it is called.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Final

from elitescript.language.diagnostics import Diagnostic, Edit, Fix, Severity, diagnostic
from elitescript.language.kinds import is_text
from elitescript.language.options import SCRIPT
from elitescript.language.parser import Parsed, character_offset
from elitescript.language.text.source import SourceFile
from elitescript.said import said

NO_STATEMENT: Final = "nothing runs: the text holds no statement"

_MOST_NAMES: Final = 4
"""Functions that the message lists."""


def idle_problem(parsed: Parsed, has_effect: Callable[[ast.expr], bool]) -> Diagnostic | None:
    """Return the finding about a text that holds nothing or only defines functions (W214); None for any other.

    Args:
        parsed: the text.
        has_effect: whether evaluating an expression may do anything besides giving a value.
    """
    if parsed.kind != SCRIPT or parsed.translation.secondaries:
        return None
    statements = parsed.tree.body
    if not statements:
        return _finding(parsed, 1, 1, 2, NO_STATEMENT, "write `def job():` and below it what is to run", None)
    functions = [statement for statement in statements if isinstance(statement, ast.FunctionDef)]
    if not functions or not all(_does_nothing(statement, has_effect) for statement in statements):
        return None
    first, is_certain = _beginning(functions)
    if len(functions) == 1:
        text = said(
            "nothing calls `{command}`: beside other top-level lines a `def` is a function and does not run",
            command=first.name,
        )
        hint = "put those lines into the `def`, which then runs by itself, or call {call} at the end"
    else:
        names = [f"`{function.name}`" for function in functions]
        listed = ", ".join(names) if len(names) <= _MOST_NAMES else f"{', '.join(names[:_MOST_NAMES])}, ..."
        text = said(
            "nothing runs: the text only defines {count} functions ({listed}), and no line calls one",
            count=len(names),
            listed=listed,
        )
        hint = "call what is to run at the end, as in {call}"
        if is_certain:
            hint = "call {call} at the end, or put the other functions into the `def` of that one"
    call = f"{first.name}()" if _runs_without_arguments(first) else f"{first.name}(...)"
    row = parsed.source.line(first.lineno)
    column = row.find(first.name, character_offset(row, first.col_offset) + len("def")) + 1
    fix = _call_at_the_end(parsed, first) if is_certain else None
    return _finding(parsed, first.lineno, column, column + len(first.name), text, said(hint, call=call), fix)


def holds_nothing(source: SourceFile) -> bool:
    """Return whether a text has only blank lines and comments."""
    return all(not row.strip() or row.lstrip().startswith("#") for row in source.lines)


def _finding(
    parsed: Parsed, line: int, column: int, end_column: int, text: str, hint: str, fix: Fix | None
) -> Diagnostic:
    severity = Severity.ERROR if parsed.options.strict else None
    return diagnostic("W214", line, column, text, end_column=end_column, hint=hint, fix=fix, severity=severity)


def calls_something(value: ast.expr) -> bool:
    """Return whether evaluating an expression calls anything."""
    return any(isinstance(node, ast.Call) for node in ast.walk(value))


def _does_nothing(statement: ast.stmt, has_effect: Callable[[ast.expr], bool]) -> bool:
    """Return whether a statement only imports, declares, defines, or assigns a value without side effects."""
    if isinstance(statement, (ast.Assign, ast.AnnAssign)):
        return statement.value is None or not has_effect(statement.value)
    if isinstance(statement, ast.FunctionDef):
        defaults = [*statement.args.defaults, *(value for value in statement.args.kw_defaults if value is not None)]
        return not statement.decorator_list and not any(map(has_effect, defaults))
    if isinstance(statement, ast.ClassDef):
        return not statement.decorator_list and all(_does_nothing(inner, has_effect) for inner in statement.body)
    return isinstance(statement, (ast.Import, ast.ImportFrom, ast.Global, ast.Pass)) or is_text(statement)


def _beginning(functions: list[ast.FunctionDef]) -> tuple[ast.FunctionDef, bool]:
    """Return the function that was probably meant to run, and whether it is the only candidate."""
    used = {node.id for function in functions for node in ast.walk(function) if isinstance(node, ast.Name)}
    roots = [function for function in functions if function.name not in used and _runs_without_arguments(function)]
    return (roots or functions)[-1], len(roots) == 1


def _runs_without_arguments(function: ast.FunctionDef) -> bool:
    args = function.args
    return len(args.posonlyargs) + len(args.args) == len(args.defaults) and None not in args.kw_defaults


def _call_at_the_end(parsed: Parsed, function: ast.FunctionDef) -> Fix:
    lines = parsed.source.lines
    last = max(number for number, row in enumerate(lines, 1) if row.strip())
    column = len(lines[last - 1]) + 1
    return Fix(
        said("call {function}()", function=function.name),
        (Edit(last, column, last, column, f"\n{function.name}()"),),
        safe=False,
    )
