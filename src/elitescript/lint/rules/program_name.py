"""A use of the program's own name.

The name behind the outer `def` is a label: the body runs at once, and nothing is bound to the name. Many
senders add a call of it behind the last `end`; on the script port that call is a program of its own, in which
the function does not exist.

    def job():
      textmsg("once")
      job()                      # W208: a NameError
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.language.options import SCRIPT
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W208", since="0.1", instead_of=("W201", "E301"))
def program_name(program: AnalysedProgram) -> Iterator[Finding]:
    """Report uses of the label inside the program, and calls of it behind."""
    parsed = program.parsed
    if parsed.unit is not None:
        for use in program.unknown:
            if use.name == parsed.name:
                text = said("`{name}` is the name of this program; no function here has this name", name=use.name)
                hint = "for a loop write `while True:`; for a function, `def` inside the program"
                yield Finding(use.node, text, hint)
    if parsed.kind == SCRIPT:
        yield from _trailing_calls(parsed.tree.body)


def _trailing_calls(statements: list[ast.stmt]) -> Iterator[Finding]:
    definition = None
    calls = []
    for statement in statements:
        value = statement.value if isinstance(statement, ast.Expr) else None
        if isinstance(statement, ast.FunctionDef) and definition is None:
            definition = statement
        elif definition is not None and _is_plain_call(value, definition.name):
            calls.append(value)
        elif not isinstance(value, ast.Constant):
            return
    for call in calls:
        assert definition is not None and call is not None
        yield Finding(
            call,
            said(
                "`{name}()` runs the function when this file is run; sent to the robot's script port, "
                "the text above runs at once and this line fails",
                name=definition.name,
            ),
            "leave the call out: a single `def` runs by itself",
        )


def _is_plain_call(value: ast.expr | None, name: str) -> bool:
    return (
        isinstance(value, ast.Call)
        and isinstance(value.func, ast.Name)
        and value.func.id == name
        and not value.args
        and not value.keywords
    )
