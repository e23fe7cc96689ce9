"""A variable that only one branch gives a value, and that is read in any case: an alarm (`NameError`) on other days.

Found are variables that some branches of an `if` or `match` assign and others do not, and those that a loop assigns
which may have no turn at all, where a condition depends on an input, a register, a sensor or a peer; and those of a
`try` whose `except` goes on without them. Where the reading has a condition of its own, the program may know what it
does.

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

from elitescript.lint.assignment import Assignments, Branch
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
        if branch is None or program.is_tried(found.node) or not _is_uncertain(program, branch, found.node.id):
            continue
        around = conditions(symbols, branch)
        if all(condition in around for condition in conditions(symbols, found.node)):
            yield Finding(found.node, *_words(branch, found.node.id))


def _words(branch: Branch, name: str) -> tuple[str, str]:
    """Return what is wrong, and what to do."""
    hint, line = "give it a value in front of the `if`, or in an `else`", branch.lineno
    if isinstance(branch, ast.If):
        if branch.orelse:
            return said(
                "the variable `{node}` has a value only behind some branches of the `if` of line {line}",
                node=name,
                line=line,
            ), hint
        return said(
            "the variable `{node}` has a value only if {test}, line {line}",
            node=name,
            test=_shown(branch.test),
            line=line,
        ), hint
    if isinstance(branch, ast.Try):
        return said(
            "the variable `{name}` has a value only if nothing fails in the `try` of line {line}", name=name, line=line
        ), "give it a value in front of the `try`, or in the `except`"
    if isinstance(branch, ast.Match):
        return said(
            "the variable `{name}` has a value only behind some cases of the `match` of line {line}",
            name=name,
            line=line,
        ), "give it a value in front of the `match`, or in a `case _`"
    return said(
        "the variable `{name}` has a value only if the loop of line {line} has a turn", name=name, line=line
    ), "give it a value in front of the loop"


def _is_uncertain(program: AnalysedProgram, branch: Branch, name: str) -> bool:
    """Return whether it depends on what happens outside of the program which way is taken."""
    if isinstance(branch, ast.If):
        return any(_depends_on_outside(program, test) for test in _tests(branch))
    if isinstance(branch, ast.While):
        return _depends_on_outside(program, branch.test)
    if isinstance(branch, ast.Match):
        return _depends_on_outside(program, branch.subject)
    if isinstance(branch, ast.For):
        shape = program.values.of(branch.iter).shape
        return shape is not None and shape.least == 0 and _depends_on_outside(program, branch.iter)
    return _may_fail_first(branch, name)


def _may_fail_first(branch: ast.Try, name: str) -> bool:
    """Return whether a call stands in a `try` up to where it gives a variable its value."""
    for statement in branch.body:
        parts = list(ast.walk(statement))
        if any(isinstance(part, ast.Call) for part in parts):
            return True
        if any(isinstance(part, ast.Name) and part.id == name and isinstance(part.ctx, ast.Store) for part in parts):
            return False
    return False


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
