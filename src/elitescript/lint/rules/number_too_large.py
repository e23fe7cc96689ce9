"""A number that what it is sent to cannot hold: only its lowest bits are sent.

A register of MODBUS has 16 bits, 0 to 65535, or -32768 to 32767 where the device takes it as signed; a byte has 8. Any
number but 0 counts as True.

    def job():
      modbus_add_signal("192.168.1.50", 255, 0, 3, "speed")
      modbus_set_output_register("speed", 60000)  # fine
      modbus_set_output_register("speed", 70000)  # W268: the device gets 4464
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from math import inf
from typing import Final

from elitescript.commands.definition.quantities import Boolean
from elitescript.lint.called import CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said
from elitescript.values.description import BOOL, Value

_HOLDS: Final = {
    ("modbus_set_output_register", "register_value"): (-32_768, 65_535, 16),
    ("socket_send_byte", "value"): (-128, 255, 8),
}
"""Least and greatest number, and bits, by command and parameter."""


@rule(code="W268", since="0.3", needs_values=True)
def number_too_large(program: AnalysedProgram) -> Iterator[Finding]:
    """Report numbers that are certainly outside."""
    for (command, param), (low, high, bits) in _HOLDS.items():
        for found in program.derived(CalledCommands).all_of(command):
            node = found.given.get(param)
            for part in node.elts if isinstance(node, ast.List) else [node]:
                value = None if part is None else program.values.of(part)
                if part is not None and value is not None and _is_outside(value, low, high):
                    number = value.low if value.low > high else value.high
                    text = said(
                        "{command}: {param} is {number:g}, and {bits} bits hold {low} to {high}",
                        command=command,
                        param=param,
                        number=number,
                        bits=bits,
                        low=low,
                        high=high,
                    )
                    hint = said("{number} is sent", number=int(number) & (1 << bits) - 1) if abs(number) != inf else ""
                    yield Finding(part, text, hint)
    yield from _truths(program)


def _truths(program: AnalysedProgram) -> Iterator[Finding]:
    """Report numbers in place of True or False."""
    for called, arguments in program.judged_calls:
        truths = [
            (param, node)
            for param, node in arguments.given
            if isinstance(param.quantity, Boolean)
            and not (isinstance(node, ast.Constant) and isinstance(node.value, bool))
        ]
        # With True as the number of an output, the arguments have changed places.
        if not truths or any(program.values.of(node).kinds == BOOL for _, node in arguments.given):
            continue
        for param, node in truths:
            number = program.constants.value(node, called.scope)
            if isinstance(number, int) and number not in (0, 1):
                text = said(
                    "{command}: {param} is {number}, and True or False belongs there",
                    command=called.command.name,
                    param=param.name,
                    number=number,
                )
                hint = said(
                    "{number} counts as True; it is called as {signature}",
                    number=number,
                    signature=called.command.signature,
                )
                yield Finding(node, text, hint)


def _is_outside(value: Value, low: int, high: int) -> bool:
    return value.is_number and (value.low > high or value.high < low)
