"""A reading with a time-out in a secondary program, which does not wait.

What `sec` starts has to be short, so its readings of sockets and serial ports look once: they return what has come
already, and the time-out is without effect. A request to a MODBUS slave waits for its answer as long as the secondary
program may run, one second, if the call has no time-out; with one it looks once too (*assumed*).

    sec ask():
      global answer
      answer = socket_read_string("camera", 2)   # W221: what is there now, also nothing
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said


@rule(code="W221", since="0.2")
def poll_in_secondary(program: AnalysedProgram) -> Iterator[Finding]:
    """Report such calls inside `sec`."""
    if not program.secondaries:
        return
    for command, call, _ in program.command_calls:
        if not command.waits or not command.works_in_sec:
            continue
        times = [place for place, param in enumerate(command.params) if param.name in _TIME_OUTS]
        if command.family == "modbus_rtu" and not any(_is_given(call, place) for place in times):
            continue
        if times and program.is_in_secondary(call):
            yield Finding(
                call.func,
                said(
                    "a secondary program (sec) does not wait: {command} looks once, whatever its time-out",
                    command=command.name,
                ),
                "without a time-out it waits for its answer, one second at most"
                if command.family == "modbus_rtu"
                else "read in the program and share the value as a global",
            )


def _is_given(call: ast.Call, place: int) -> bool:
    """Return whether a call has, or may have, an argument at a place."""
    has_stars = any(isinstance(argument, ast.Starred) for argument in call.args)
    is_named = any(word.arg is None or word.arg in _TIME_OUTS for word in call.keywords)
    return has_stars or is_named or len(call.args) > place


_TIME_OUTS = frozenset(("time_out", "timeout"))
"""Names of the parameter in the manual."""
