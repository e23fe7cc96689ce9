"""A list that is changed in the loop that goes through it: elements are left out, or the loop has no end.

The loop takes the next place of the list, whatever has moved there.

    def job():
      parts = [1, 2, 3, 4]
      for part in parts:
        parts.remove(part)                        # W225: 2 and 4 stay; for part in parts.copy():
      end
      for part in parts.copy():
        parts.remove(part)                        # fine
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.list_changes import Change, ListChanges, Variable, variable_of
from elitescript.lint.placing import loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_MOVING: Final = frozenset(("append", "clear", "extend", "insert", "pop", "remove"))
_SHORTENING: Final = frozenset(("clear", "pop", "remove"))


@rule(code="W225", since="0.3", needs_values=True)
def changed_while_gone_through(program: AnalysedProgram) -> Iterator[Finding]:
    """Report elements that are added and removed there, where the loop goes on behind it."""
    if not program.nodes(ast.For):
        return
    for change in program.derived(ListChanges).all:
        call = change.node
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Attribute):
            continue
        if call.func.attr not in _MOVING or not isinstance(change.list, ast.Name):
            continue
        if not program.values.of(change.list).is_list or _is_left(program, call):
            continue
        variable = variable_of(program, change.list)
        for loop in loops(program.symbols, call):
            if isinstance(loop, ast.For) and not _is_renewed(program, variable, loop):
                yield from _found(program, loop, change, call.func.attr, variable)


def _found(
    program: AnalysedProgram, loop: ast.For, change: Change, method: str, variable: Variable
) -> Iterator[Finding]:
    every, name = loop.iter, variable[0]
    if isinstance(every, ast.Name) and variable_of(program, every) == variable:
        text = said("the loop of line {line} goes through `{name}`, which this changes", line=loop.lineno, name=name)
        hint = said("go through a copy: for ... in {name}.copy():", name=name)
        fix = Fix(hint, (Edit(*program.span(every), f"{name}.copy()"),), safe=False)
        yield Finding(change.node, text, hint, fix)
    elif method in _SHORTENING and _counts(every, name):
        text = said(
            "the loop of line {line} counts all elements that `{name}` had, and this makes it shorter",
            line=loop.lineno,
            name=name,
        )
        yield Finding(change.node, text, said("while len({name}) > 0: goes on until it is empty", name=name))


def _counts(every: ast.expr, name: str) -> bool:
    """Return whether a loop goes through `range(len(name))`."""
    if not isinstance(every, ast.Call) or not isinstance(every.func, ast.Name) or every.func.id != "range":
        return False
    ends = [part for part in every.args if isinstance(part, ast.Call)]
    return len(every.args) == 1 and len(ends) == 1 and ast.unparse(ends[0]) in (f"len({name})", f"length({name})")


def _is_left(program: AnalysedProgram, node: ast.AST) -> bool:
    """Return whether the loop is left behind a statement, in the same block."""
    statement = next(above for above in program.symbols.ancestors(node) if isinstance(above, ast.stmt))
    _, block, place = program.symbols.block_of(statement)
    return any(isinstance(later, (ast.Break, ast.Return, ast.Raise)) for later in block[place:])


def _is_renewed(program: AnalysedProgram, variable: Variable, loop: ast.For) -> bool:
    name, home = variable
    bindings = program.symbols.global_bindings(name) if home is None else home.bindings[name]
    return any(loop.lineno < binding.line <= (loop.end_lineno or 0) for binding in bindings)
