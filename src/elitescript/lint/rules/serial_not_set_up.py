"""A command of MODBUS-RTU on a serial port that the program has not set up for it.

`serial_config` and `tool_serial_config` enable a port; MODBUS-RTU needs `modbus_rtu=True`. A text that sets up no port
may be a part of a program that does, and is left alone.

    def job():
      tool_serial_config(True, 115200, 0, 1)             # plain bytes
      r = tool_modbus_read_registers(1, 0, 2)            # W253: modbus_rtu=True is missing above
      serial_config(True, 9600, 0, 1, modbus_rtu=True)
      r = serial_modbus_read_registers(1, 0, 2)          # fine
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_CONFIGS: Final = {"tool_": "tool_serial_config", "serial_": "serial_config"}
_OTHER: Final = {"tool_": "the tool", "serial_": "the control box"}
_BYTES: Final = ("read", "write", "flush")


@rule(code="W253", since="0.3", needs_all_lines=True, needs_values=True)
def serial_not_set_up(program: AnalysedProgram) -> Iterator[Finding]:
    """Report the first such command of each port."""
    called = program.derived(CalledCommands)
    if called.are_passed_on(*_CONFIGS.values()) or program.shares_globals:
        return
    set_up = {prefix: called.of(config) for prefix, config in _CONFIGS.items()}
    if not any(set_up.values()):
        return
    for prefix, config in _CONFIGS.items():
        modes: set[bool | None] = set()
        for found in set_up[prefix]:
            node = found.given.get("modbus_rtu")
            value = False if node is None else program.constants.value(node, found.scope)
            modes.add(bool(value) if found.is_complete and isinstance(value, (bool, int)) else None)
        uses = [found for found in called if found.name.startswith(f"{prefix}modbus_")]
        if not uses or True in modes or None in modes:
            continue
        first = min(uses, key=lambda one: (one.call.lineno, one.call.col_offset))
        if modes:
            text = said("{command}: {config} sets up the port for plain bytes", command=first.name, config=config)
            yield Finding(first.call, text, said("write {config}(..., modbus_rtu=True)", config=config))
        else:
            text = said(
                "{command}: nothing sets up the serial port of {other}", command=first.name, other=_OTHER[prefix]
            )
            yield Finding(first.call, text, said("call {config}(..., modbus_rtu=True) first", config=config))
