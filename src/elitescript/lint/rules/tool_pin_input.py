"""A tool pin that is set although the program has configured it as an input, or disabled it.

`set_tool_digital` is an alarm then. The last argument of `set_tool_digital_io_config` makes a pin an output, the third
one puts it to use.

    def job():
      set_tool_digital_io_config(0, 0, True, True)       # enabled, an output
      set_tool_digital_io_config(1, 0, True, False)      # enabled, an input
      set_tool_digital(0, True)                          # fine
      set_tool_digital(1, True)                          # W255: pin 1 is an input
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_CONFIG: Final = "set_tool_digital_io_config"


@rule(code="W255", since="0.3", needs_values=True)
def tool_pin_input(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such call."""
    called = program.derived(CalledCommands)
    states: dict[int | None, set[str]] = {}
    if called.are_passed_on(_CONFIG):
        return
    for found in called.of(_CONFIG):
        values = [
            program.constants.value(found.given[name], found.scope) if name in found.given else None
            for name in ("enable", "is_out")
        ]
        state = "unknown"
        if all(isinstance(value, (bool, int)) for value in values):
            state = "disabled" if not values[0] else "an output" if values[1] else "an input"
        states.setdefault(called.number(found, "index"), set()).add(state)
    if None in states:
        return
    for found in called.of("set_tool_digital"):
        number = called.number(found, "n")
        known = states.get(number, set())
        if len(known) == 1 and known <= {"an input", "disabled"}:
            text = said("set_tool_digital: pin {number} is {copy}", number=number, copy=known.copy().pop())
            yield Finding(
                found.call,
                text,
                said("{config}({number}, 0, True, True) makes it an output", config=_CONFIG, number=number),
            )
