"""A program that only defines itself: one `def` beside imports and constants, and no call of it.

A `def` that stands alone is the program and runs. With a line beside it the whole text is the program, the `def`
in it is an ordinary function, and the run ends at once without an error. Reported is only what can be nothing
else: a single `def` that takes no arguments and returns no value, beside lines that do nothing by themselves.

    import math
    def job():                   # W214: move the import into the `def`
      textmsg(math.pi)
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.kinds import SCRIPT, is_text
from elitescript.lint.program import Program
from elitescript.lint.registry import Finding, rule


@rule(code="W214", since="0.1", needs_all_lines=True)
def uncalled_program(program: Program) -> Iterator[Finding]:
    """Report the only `def` of a script that does nothing."""
    if program.parsed.kind != SCRIPT or program.secondaries:
        return
    statements = program.parsed.tree.body
    functions = [statement for statement in statements if isinstance(statement, ast.FunctionDef)]
    others = [statement for statement in statements if not isinstance(statement, ast.FunctionDef)]
    if len(functions) != 1 or not all(_does_nothing(statement) for statement in others):
        return
    function = functions[0]
    if not _could_be_a_program(function) or any(function.name in scope.reads for scope in program.symbols.scopes):
        return
    yield Finding(
        program.name_span(function, function.name),
        f"nothing calls `{function.name}`: beside other top-level lines a `def` is a function and does not run",
        f"put those lines into the `def`, which then runs by itself, or call {function.name}() at the end",
    )


def _does_nothing(statement: ast.stmt) -> bool:
    """It imports, declares, or gives a name a value without calling anything."""
    if isinstance(statement, (ast.Assign, ast.AnnAssign)):
        return not any(isinstance(node, ast.Call) for node in ast.walk(statement))
    return isinstance(statement, (ast.Import, ast.ImportFrom, ast.Global, ast.Pass)) or is_text(statement)


def _could_be_a_program(function: ast.FunctionDef) -> bool:
    """Nothing about it says that it is meant to be called: no decorator, argument or result."""
    args = function.args
    needed = len(args.posonlyargs) + len(args.args) - len(args.defaults) + args.kw_defaults.count(None)
    if function.decorator_list or needed or any(isinstance(node, ast.Call) for node in ast.walk(args)):
        return False
    stack: list[ast.AST] = list(function.body)
    while stack:
        node = stack.pop()
        if isinstance(node, (ast.Yield, ast.YieldFrom)) or (isinstance(node, ast.Return) and node.value is not None):
            return False
        if not isinstance(node, (ast.FunctionDef, ast.Lambda, ast.ClassDef)):
            stack.extend(ast.iter_child_nodes(node))
    return True
