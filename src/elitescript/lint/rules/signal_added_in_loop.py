"""A MODBUS signal that is added in the loop that reads it: it never gets a value.

Adding a signal again makes a new one, which has no value before the device has answered.

    def job():
      modbus_add_signal("192.168.1.50", 255, 0, 2, "level")      # fine here
      while True:
        modbus_add_signal("192.168.1.50", 255, 1, 2, "angle")    # W251: add it once, before the loop
        textmsg(modbus_get_signal_status("angle"))
        sleep(0.5)
      end
    end
"""

from __future__ import annotations

import ast
from bisect import bisect_left
from collections.abc import Iterator
from typing import Final

from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.placing import loops
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_NAME: Final = "signal_name"
_ADDING: Final = ("modbus_add_signal", "modbus_add_rw_signal")
_READ: Final = "modbus_get_signal_status"
_DELETE: Final = "modbus_delete_signal"


@rule(code="W251", since="0.3", needs_values=True)
def signal_added_in_loop(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such call."""
    called = program.derived(CalledCommands)
    uses: dict[tuple[str, ast.AST], dict[str, list[Called]]] = {}
    waits = sorted(found.call.lineno for found in program.command_calls if found.command.waits)
    for found in called.of(*_ADDING, _READ, _DELETE):
        names = called.texts(found, _NAME, "")
        loop = next(loops(program.symbols, found.call), None)
        if len(names) == 1 and loop is not None:
            uses.setdefault((names[0], loop), {}).setdefault(found.name, []).append(found)
    for (name, _), by_command in uses.items():
        if _READ not in by_command or _DELETE in by_command:
            continue
        first = min(found.call.lineno for found in by_command[_READ])
        for found in (found for command in _ADDING for found in by_command.get(command, ())):
            if not _waits_between(waits, found.call, first):
                text = said(
                    "{command}: {name!r} is added again in each turn of the loop, and never gets a value",
                    command=found.name,
                    name=name,
                )
                yield Finding(found.call, text, "add it once, in front of the loop")


def _waits_between(waits: list[int], call: ast.Call, line: int) -> bool:
    """Return whether anything waits behind a call, in lines before another one; `waits` are the lines that do."""
    place = bisect_left(waits, call.lineno)
    return place < len(waits) and waits[place] < line
