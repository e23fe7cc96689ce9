"""A reading with a time-out in a secondary program, which does not wait.

What `sec` starts has to be short, so its readings of sockets and serial ports look once: they return what has come
already, and the time-out is without effect. A request to a MODBUS slave never gets its answer there.

    sec ask():
      global answer
      answer = socket_read_string("camera", 2)   # W221: what is there now, also nothing
    end
"""

from __future__ import annotations

from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule


@rule(code="W221", since="0.2")
def poll_in_secondary(program: AnalysedProgram) -> Iterator[Finding]:
    """Report such calls inside `sec`."""
    if not program.secondaries:
        return
    for command, call, _ in program.command_calls:
        if not command.waits or not command.works_in_sec:
            continue
        if any(param.name in _TIME_OUTS for param in command.params) and program.is_in_secondary(call):
            yield Finding(
                call.func,
                f"a secondary program (sec) does not wait: {command.name} looks once, whatever its time-out",
                "read in the program and share the value as a global",
            )


_TIME_OUTS = frozenset(("time_out", "timeout"))
"""Names of the parameter in the manual."""
