"""A variable that only one branch gives a value, and that is read in any case: an alarm (`NameError`) on other days.

Found are variables that some branches of an `if` assign and others do not, where a condition depends on an input, a
register, a sensor or a peer. Where the reading has a condition of its own, the program may know what it does.

    def job():
      if get_standard_digital_in(0):
        part = 1
      end
      textmsg(part)              # W257: without the input it has no value
      if get_standard_digital_in(1):
        speed = 0.1
      else:
        speed = 0.2
      end
      textmsg(speed)             # fine
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.assignment import Assignments
from elitescript.lint.placing import conditions
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W257", since="0.3", needs_all_lines=True, needs_values=True)
def assigned_in_one_branch(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first such reading of each variable."""
    symbols = program.symbols
    for found in program.derived(Assignments).found:
        branch = found.branch
        if branch is None or program.is_tried(found.node):
            continue
        if not any(_depends_on_outside(program, test) for test in _tests(branch)):
            continue
        around = conditions(symbols, branch)
        if all(condition in around for condition in conditions(symbols, found.node)):
            if not branch.orelse:
                text = said(
                    "the variable `{node}` has a value only if {test}, line {line}",
                    node=found.node.id,
                    test=_shown(branch.test),
                    line=branch.lineno,
                )
            else:
                text = said(
                    "the variable `{node}` has a value only behind some branches of the `if` of line {line}",
                    node=found.node.id,
                    line=branch.lineno,
                )
            yield Finding(found.node, text, "give it a value in front of the `if`, or in an `else`")


def _tests(branch: ast.If) -> Iterator[ast.expr]:
    """Yield the conditions of an `if` and of its `elif`s."""
    current: ast.If | None = branch
    while current is not None:
        yield current.test
        rest = current.orelse
        current = rest[0] if len(rest) == 1 and isinstance(rest[0], ast.If) else None


def _shown(node: ast.expr) -> str:
    text = " ".join(ast.unparse(node).split())
    return f"`{text if len(text) <= 60 else text[:57] + '...'}`"


def _depends_on_outside(program: AnalysedProgram, test: ast.expr) -> bool:
    from elitescript.values.description import OUTSIDE

    return any(
        isinstance(node, (ast.Name, ast.Call, ast.Subscript)) and program.values.of(node).must & OUTSIDE
        for node in ast.walk(test)
    )
