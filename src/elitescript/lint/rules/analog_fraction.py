"""An analog level outside 0 to 1: it is a fraction of the range of the output, neither volts nor amperes.

The controller limits it to the range without a message.

    def job():
      set_standard_analog_out(0, 24)              # W234: 1 is 10 V
      set_standard_analog_out(0, 5)               # W234: 5 V are 0.5
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, doubt_findings, rule


@rule(code="W234", since="0.2", needs_values=True)
def analog_fraction(program: AnalysedProgram) -> Iterator[Finding]:
    """Report levels of analog outputs outside their range."""
    return doubt_findings(program, "W234")
