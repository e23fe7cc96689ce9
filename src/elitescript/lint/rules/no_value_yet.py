"""A variable that is read before anything gives it a value: an alarm (`UnboundLocalError`).

An assignment anywhere in a function makes a variable of its own, also `count = count + 1`: its `count` has no value
yet, whatever a variable of that name around the function holds.

    def job():
      count = 0
      def bump():
        count = count + 1        # W256: write `nonlocal count` above
      end
      def bump_both():
        nonlocal count
        count = count + 1        # fine
      end
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.assignment import Assignments
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W256", since="0.3", needs_all_lines=True)
def no_value_yet(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first such reading of each variable."""
    for found in program.derived(Assignments).found:
        name, scope = found.node.id, found.scope
        # A `global` somewhere else is told by another rule.
        if found.branch is not None or name in program.symbols.global_names or program.is_tried(found.node):
            continue
        text = said("the variable `{name}` has no value yet here", name=name)
        outer = None if scope.parent is None else scope.parent.home(name)
        if outer is None:
            yield Finding(found.node, text, "assign it before")
            continue
        from elitescript.lint.insertions import declare

        place = said("the function `{scope}`", scope=scope.name)
        hint = said(
            "write `nonlocal {name}` at the start of {place}: it is a variable of its own there", name=name, place=place
        )
        yield Finding(found.node, text, hint, declare(program, "nonlocal", name, scope))
