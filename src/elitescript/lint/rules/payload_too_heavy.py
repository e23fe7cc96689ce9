"""A payload above what the arm carries.

Without `--robot` the strongest arm counts, 25 kg. At run time a payload above the limit is an alarm.

    def job():
      set_payload(500, [0, 0, 0.05])              # W233: 500 g are 0.5 kg
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W233", since="0.2", needs_values=True)
def payload_too_heavy(program: AnalysedProgram) -> Iterator[Finding]:
    """Report masses that the arm cannot carry."""
    return doubt_findings(program, "W233")
