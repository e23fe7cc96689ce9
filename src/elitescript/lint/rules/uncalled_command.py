"""A command without its parentheses: `sync` where `sync()` was meant.

The name alone is the command itself, a value that is always true; nothing waits, reads or moves. Reported is where
that can be no purpose: as a statement, in a condition or a calculation, and given to a name that is never called.

    while True:
      sync                                   # W215: write `sync()`
      if get_flag:                           # W215: always true
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.program import Program, Use
from elitescript.lint.registry import Finding, rule

_OPERATIONS = (ast.BoolOp, ast.BinOp, ast.Compare, ast.UnaryOp, ast.If, ast.While, ast.IfExp, ast.Assert)


@rule(code="W215", since="0.1")
def uncalled_command(program: Program) -> Iterator[Finding]:
    """Report the name of a command where only its result can be meant."""
    for use in program.outside:
        command = program.command(use.name, use.scope)
        if command is None or use.is_call or not _wants_the_result(program, use):
            continue
        has_arguments = any(param.is_required for param in command.params)
        call = f"{use.name}(...)" if has_arguments else f"{use.name}()"
        line, _, end_line, end_column = program.span(use.node)
        fix = None
        if not has_arguments:
            fix = Fix("call it", (Edit(line, end_column, end_line, end_column, "()"),), safe=True)
        yield Finding(
            use.node,
            f"`{use.name}` without parentheses is the command itself, which does nothing and is always true",
            f"write {call}",
            fix,
        )


def _wants_the_result(program: Program, use: Use) -> bool:
    parent = program.symbols.parent(use.node)
    if isinstance(parent, ast.Expr):
        return True
    if isinstance(parent, _OPERATIONS):
        # `f == sync` and `f is sync` ask which function f is.
        return not isinstance(parent, ast.Compare) or not all(
            isinstance(operator, (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)) for operator in parent.ops
        )
    if isinstance(parent, ast.Assign) and parent.value is use.node:
        targets = [target.id for target in parent.targets if isinstance(target, ast.Name)]
        return len(targets) == len(parent.targets) and not any(_is_used_as_function(program, name) for name in targets)
    return False


def _is_used_as_function(program: Program, name: str) -> bool:
    """Whether a name is called, or handed on to somebody who may call it."""
    parent = program.symbols.parent
    for node in program.nodes(ast.Name):
        if node.id == name and isinstance(node.ctx, ast.Load):
            above = parent(node)
            if not isinstance(above, (ast.Expr, *_OPERATIONS)):
                return True
    return False
