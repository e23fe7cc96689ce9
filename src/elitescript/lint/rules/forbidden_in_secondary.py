"""A call that a secondary program may not make.

What `sec` starts runs beside the program and has to be short: it cannot move the arm, wait, or start threads.
The call is refused when it is reached.

    sec lamp():
      set_standard_digital_out(1, True)
      sleep(1)                   # W205
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import Program
from elitescript.lint.registry import Finding, rule


@rule(code="W205", since="0.1")
def forbidden_in_secondary(program: Program) -> Iterator[Finding]:
    """Report such calls inside `sec`."""
    inside = [(node.lineno, node.end_lineno or node.lineno) for node in program.secondaries]
    if not inside:
        return
    for command, call, _ in program.command_calls:
        if not command.works_in_sec and any(first <= call.lineno <= last for first, last in inside):
            yield Finding(
                call.func,
                f"a secondary program (sec) may not call {command.name}: it cannot move the arm, wait or start threads",
                "do it in the program; a secondary program can set a global for it",
            )
