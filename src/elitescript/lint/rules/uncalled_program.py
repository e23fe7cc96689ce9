"""A text in which nothing runs: it defines functions, and no line at its top calls one.

A `def` that stands alone is the program and runs. With a line beside it (an import, a constant, a second `def`)
the whole text is the program, each `def` in it is a function, and the run ends at once, "finished", with nothing
done. Texts that are empty but for comments do nothing either.

    import math
    def job():                   # W214: put the import into the `def`, or call job() at the end
      textmsg(math.pi)
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.language.kinds import SCRIPT, is_text
from elitescript.lint.effects import has_effect
from elitescript.lint.program import Program
from elitescript.lint.registry import Finding, Span, rule


@rule(code="W214", since="0.1", needs_all_lines=True, is_structural=True)
def uncalled_program(program: Program) -> Iterator[Finding]:
    """Report the function with which a text that does nothing was meant to begin."""
    if program.parsed.kind != SCRIPT or program.secondaries:
        return
    statements = program.parsed.tree.body
    if not statements:
        yield Finding(Span(1, 1, 1, 2), "nothing runs: the text holds no statement", "write `def job():` and its lines")
        return
    functions = [statement for statement in statements if isinstance(statement, ast.FunctionDef)]
    if not functions or not all(_does_nothing(statement, program) for statement in statements):
        return
    first, is_certain = _beginning(functions, program)
    where = program.name_span(first, first.name)
    if len(functions) == 1:
        text = f"nothing calls `{first.name}`: beside other top-level lines a `def` is a function and does not run"
        hint = "put those lines into the `def`, which then runs by itself, or call {call} at the end"
    else:
        names = [f"`{function.name}`" for function in functions]
        listed = ", ".join(names) if len(names) <= _MOST_NAMES else f"{', '.join(names[:_MOST_NAMES])}, ..."
        text = f"nothing runs: the text only defines {len(names)} functions ({listed}), and no line calls one"
        hint = "call {call} at the end, or put the other functions into the `def` of that one"
    call = f"{first.name}()" if _runs_without_arguments(first) else f"{first.name}(...)"
    fix = _call_at_the_end(program, first) if is_certain else None
    yield Finding(where, text, hint.format(call=call), fix)


_MOST_NAMES = 4
"""Functions that the message lists."""


def _does_nothing(statement: ast.stmt, program: Program) -> bool:
    """It imports, declares, defines, or gives a name a value without doing anything for that."""
    if isinstance(statement, (ast.Assign, ast.AnnAssign)):
        return statement.value is None or not has_effect(statement.value, program)
    if isinstance(statement, ast.FunctionDef):
        defaults = [*statement.args.defaults, *(value for value in statement.args.kw_defaults if value is not None)]
        return not statement.decorator_list and not any(has_effect(value, program) for value in defaults)
    if isinstance(statement, ast.ClassDef):
        return not statement.decorator_list and all(_does_nothing(inner, program) for inner in statement.body)
    return isinstance(statement, (ast.Import, ast.ImportFrom, ast.Global, ast.Pass)) or is_text(statement)


def _beginning(functions: list[ast.FunctionDef], program: Program) -> tuple[ast.FunctionDef, bool]:
    """The function that was probably meant to run, and whether only it can be: no other one calls it."""
    used = {
        name for scope in program.symbols.scopes for name in scope.reads if scope.node is not program.parsed.tree
    }
    roots = [function for function in functions if function.name not in used and _runs_without_arguments(function)]
    if not roots:
        return functions[-1], False
    return roots[-1], len(roots) == 1


def _runs_without_arguments(function: ast.FunctionDef) -> bool:
    args = function.args
    return len(args.posonlyargs) + len(args.args) == len(args.defaults) and None not in args.kw_defaults


def _call_at_the_end(program: Program, function: ast.FunctionDef) -> Fix:
    lines = program.source.lines
    last = max(number for number, row in enumerate(lines, 1) if row.strip())
    column = len(lines[last - 1]) + 1
    return Fix(f"call {function.name}()", (Edit(last, column, last, column, f"\n{function.name}()"),), safe=False)
