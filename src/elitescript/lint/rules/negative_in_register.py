"""A negative value goes into a register as its 16 bits: -5 as 65531.

A device with signed registers reads -5, and `modbus_get_signal_status` gives 65531.

    def job():
      modbus_add_signal("192.168.1.50", 255, 0, 3, "offset")
      modbus_set_output_register("offset", -5)    # N287: 65531
      modbus_set_output_register("offset", 5)     # fine
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import NUMBER

_REGISTERS: Final = {"modbus_set_output_register": "register_value", "write_port_register": "value"}


@rule(code="N287", since="0.3", needs_values=True)
def negative_in_register(program: AnalysedProgram) -> Iterator[Finding]:
    """Report numbers below 0 in registers of 16 bits, which hold 0 to 65535."""
    for command, param in _REGISTERS.items():
        for found in program.derived(CalledCommands).of(command):
            node = found.given.get(param)
            if node is None:
                continue
            value = program.values.of(node)
            if not value.has_constant or value.kinds & ~NUMBER or not -32_768 <= value.low < 0:
                continue
            text = said(
                "{command}: {number} becomes {low} in the register",
                command=command,
                number=int(value.low),
                low=int(value.low) % 2**16,
            )
            yield Finding(node, text, "a device with signed registers reads it as it was meant")
