"""A time that looks like milliseconds: all times are in seconds.

A time-out, the time of a move or a watchdog of 100 s and more is hardly meant; for `servoj`, which is called every few
milliseconds, it is one of 1 s. `sleep` may take long.

    def job():
      socket_open("192.168.1.20", 5000, "cam")
      s = socket_read_string("cam", timeout=2000) # W244: 2000 ms are 2 s
      movel([0.4, 0, 0.3, 3.14, 0, 0], t=1500)    # W244
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_MOST_S: Final = 100
_MOST_OF: Final = {"servoj": 1}
"""Times that are short, s, by command."""
_LONG: Final = frozenset(("sleep",))
"""Commands whose times may be long."""


@rule(code="W244", since="0.3", needs_values=True)
def time_in_milliseconds(program: AnalysedProgram) -> Iterator[Finding]:
    """Report times that are too long to be seconds."""
    refused = {refusal.node for refusal in program.refusals}
    for called, arguments in program.judged_calls:
        most = _MOST_OF.get(called.command.name, _MOST_S)
        for param, node in arguments.given:
            if param.quantity.unit != "s" or called.command.name in _LONG or node in refused:
                continue
            time_s = program.least_number(node, called.scope)
            if time_s is not None and time_s >= most:
                text = said(
                    "{command}: {param} is {time_s:g} s", command=called.command.name, param=param.name, time_s=time_s
                )
                hint = said(
                    "{time_s:g} looks like milliseconds: {time_s:g} ms are {meant:g} s",
                    time_s=time_s,
                    meant=time_s / 1000,
                )
                yield Finding(node, text, hint)
