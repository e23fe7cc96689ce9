"""A function that never ends and is called where a thread should run it.

Its loop runs in the caller; `start_thread` is not reached. A call that does end is refused by `start_thread` itself,
unless it returns a function (E304).

    def job():
      def watch():
        while True:
          sync()
        end
      end
      start_thread(watch())                       # W269: write start_thread(watch, ())
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.lint.flow import Flow
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_START: Final = "start_thread"


@rule(code="W269", since="0.3")
def called_for_thread(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each call as the first argument of `start_thread` that never returns."""
    for found, placed in zip(program.command_calls, program.arguments, strict=True):
        if found.command.name != _START or not placed.given:
            continue
        _, node = placed.given[0]
        if isinstance(node, ast.Call) and program.derived(Flow).never_returns(node):
            called = ast.unparse(node.func)
            text = said(
                "{start}: `{called}` runs here and never ends, so that no thread is started",
                start=_START,
                called=called,
            )
            arguments = ", ".join(map(ast.unparse, node.args))
            given = f"({arguments},)" if len(node.args) == 1 else f"({arguments})"
            yield Finding(
                node,
                text,
                said(
                    "write the function without parentheses: {start}({called}, {given})",
                    start=_START,
                    called=called,
                    given=given,
                ),
            )
