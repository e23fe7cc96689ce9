"""A write to an address of the controller's own MODBUS server that only shows a state of the robot, or nothing.

Nothing changes there; a client's write would be refused.

    def job():
      write_port_bit(5, True)         # W260: a digital input
      write_port_register(66, 7)      # W260: the robot mode
    end
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.errors import ArgumentRangeError, MirroredAddressError
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_WRITERS: Final = ("write_port_bit", "write_port_register")


@rule(code="W260", since="0.1", needs_values=True)
def mirrored_address(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such write whose address is certain."""
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        name = called.command.name
        if name not in _WRITERS:
            continue
        from elitescript.modbus.port_image import check_writable_coils, check_writable_registers

        check = check_writable_coils if name == "write_port_bit" else check_writable_registers
        for param, node in arguments.given:
            address = program.constants.value(node, called.scope)
            if param.name != "address" or not isinstance(address, int):
                continue
            try:
                check(int(address), 1)
            except MirroredAddressError as error:
                hint = "docs/reference/modbus.md lists what can be set"
                yield Finding(node, said("{name}: {error}; nothing changes", name=name, error=error), hint)
            except ArgumentRangeError:
                continue  # the range of the parameter says so
