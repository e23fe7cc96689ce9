"""An endless loop that does nothing but move and swallow the refusal.

A move that is refused takes no time. If it is refused once, it is refused in each turn: the loop never waits, and
nothing says why the arm stands.

    def job():
      while True:
        try:                                      # W261
          movel([2.0, 0, 0.3, 3.14, 0, 0])
        except:
          pass                                    # textmsg(str(e)) and sleep(0.1), or break
        end
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Final

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_REFUSABLE: Final = ("move", "servoj", "get_inverse_kin", "speed")


@rule(code="W261", since="0.3")
def swallowed_refusals(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the `try` of each such loop."""
    for loop in program.nodes(ast.While):
        if len(loop.body) != 1 or not isinstance(loop.body[0], ast.Try) or not _is_endless(loop.test):
            continue
        attempt = loop.body[0]
        command = _refusable(program, attempt.body)
        if not command or attempt.finalbody or not attempt.handlers:
            continue
        nodes = [node for statement in loop.body for node in ast.walk(statement)]
        leaves = any(isinstance(node, (ast.Break, ast.Return, ast.Raise)) for node in nodes)
        handled = [node for handler in attempt.handlers for part in handler.body for node in ast.walk(part)]
        if not leaves and not any(isinstance(node, ast.Call) for node in handled):
            text = said(
                "if {command} is refused, this loop repeats it without waiting and without a word", command=command
            )
            hint = "say what is wrong: `except Exception as e:`, textmsg(str(e)), and leave the loop or sleep"
            yield Finding(program.header_span(attempt), text, hint)


def _is_endless(test: ast.expr) -> bool:
    return isinstance(test, ast.Constant) and bool(test.value)


def _refusable(program: AnalysedProgram, statements: Sequence[ast.stmt]) -> str:
    """Return the command that may be refused, before anything in a block waits; empty if there is none."""
    for statement in statements:
        for node in ast.walk(statement):
            if not isinstance(node, ast.Call):
                continue
            scope = program.symbols.scope_of(node)
            command = program.command(node.func.id, scope) if isinstance(node.func, ast.Name) else None
            if command is None:
                return ""
            if command.name.startswith(_REFUSABLE):
                return command.name
            if command.waits:
                return ""
    return ""
