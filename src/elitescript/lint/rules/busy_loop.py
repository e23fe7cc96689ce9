"""A loop that waits for something without ever waiting.

Found are loops that nothing inside them can end: `while True` without a way out, and loops whose condition
only an input or another thread can change. If no call in them takes time, also none in the functions that they
call, they burn the controller's time and starve other threads. A loop that asks an input and only counts its turns
looks at one moment that many times.

    def job():
      while not get_standard_digital_in(0):    # W204
        pass                                   # write sync(), or sleep(0.01)
      end
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.lint.repetition import Analyst


@rule(code="W204", since="0.1", needs_all_lines=True)
def busy_loop(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such loop."""
    loops = program.nodes(ast.While)
    if not loops:
        return
    analyst = Analyst(program)
    # A word alone in a line is a call that is still being typed, and may wait.
    symbols = program.symbols
    words = [use.node for use in program.unknown if isinstance(symbols.parent(use.node), ast.Expr)]
    unfinished = {above for word in words for above in symbols.ancestors(word)}
    for loop in loops:
        if loop not in unfinished and analyst.is_busy(loop):
            text = "this loop never waits: no call in it takes time, and no other thread runs meanwhile"
            yield Finding(program.header_span(loop), text, "put sync() or sleep(0.01) into it")
        elif loop not in unfinished and analyst.polls(loop):
            text = "this loop never waits: it asks for the same moment in each turn, until its counter ends it"
            yield Finding(program.header_span(loop), text, "put sync() or sleep(0.01) into it")
