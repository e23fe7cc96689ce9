"""A sleep of 100 s and more: perhaps milliseconds were meant.

A program may wait for so long, so this is a note.

    def job():
      sleep(0.5)
      sleep(500)                 # N226: 500 ms are 0.5 s
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_LONG_S: Final = 100


@rule(code="N226", since="0.3", needs_values=True)
def long_sleep(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such sleep."""
    for called in program.derived(CalledCommands).of("sleep"):
        node = called.given.get("t")
        time_s = None if node is None else program.least_number(node, called.scope)
        if node is not None and time_s is not None and time_s >= _LONG_S:
            hint = said("all times are in seconds: {ms:g} ms are {s:g} s", ms=time_s, s=time_s / 1000)
            yield Finding(node, said("sleep: t is {time:g} s", time=time_s), hint)
