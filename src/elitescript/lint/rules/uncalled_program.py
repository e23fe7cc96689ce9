"""A text in which nothing runs: it defines functions, and no line at its top calls one.

A `def` that stands alone is the program and runs. With a line beside it (an import, a constant, a second `def`)
the whole text is the program, each `def` in it is a function, and the run ends at once, "finished", with nothing
done. Texts that are empty but for comments do nothing either.

    import math
    def job():                   # W214: put the import into the `def`, or call job() at the end
      textmsg(math.pi)
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.language.idle import idle_problem
from elitescript.lint.effects import has_effect
from elitescript.lint.program import AnalysedProgram, Span
from elitescript.lint.registry import Finding, rule


@rule(code="W214", since="0.1", needs_all_lines=True)
def uncalled_program(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the function with which a text that does nothing was meant to begin."""
    found = idle_problem(program.parsed, lambda value: has_effect(value, program))
    if found is not None:
        place = Span(found.line, found.column, found.end_line, found.end_column)
        yield Finding(place, found.text, found.hint, found.fix)
