"""A call of a value that is no function: a variable hides a function of the same name.

`list`, `str`, `max` and `sum` are functions until a program gives their names to something else.

    def job():
      list = [1, 2, 3]
      copy = list(range(3))                       # W245: the variable `list` cannot be called
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.commands.catalogue import CATALOGUE
from elitescript.language.symbols import Resolution
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W245", since="0.3", needs_values=True)
def not_a_function(program: AnalysedProgram) -> Iterator[Finding]:
    """Report calls of numbers, texts and lists; W203 tells of commands, and None stands for a function to come."""
    for scope in program.symbols.scopes:
        are_own: dict[str, bool] = {}
        for call in scope.calls:
            function = call.func
            if not isinstance(function, ast.Name):
                continue
            if function.id not in are_own:
                are_own[function.id] = scope.resolve(function.id) is not Resolution.BUILTIN
            if not are_own[function.id]:
                continue
            value = program.values.of(function)
            if not value.is_known or value.is_callable or program.is_tried(call):
                continue
            from elitescript.values.description import NONE
            from elitescript.values.words import phrase

            if not value.kinds & NONE and CATALOGUE.get(function.id) is None:
                text = said(
                    "`{function}` is {words} here, and cannot be called", function=function.id, words=phrase(value)
                )
                yield Finding(function, text, "give the variable another name than the function")
