"""Finds what may stand in the strings that commands take as names: connections, signals, files, RTSI inputs."""

from __future__ import annotations

from typing import Final

from elitescript.assist.document import Document
from elitescript.commands.definition.registry import Command, Param
from elitescript.messages.signals import SIGNALS, parse_signal_name
from elitescript.errors import UsageError
from elitescript.records import NamedTuple

_KINDS: Final = {
    "socket_name": "socket",
    "signal_name": "modbus",
    "IP": "address",
    "address": "address",
    "connection_id": "address",
    "file_name": "file",
    "variable": "input",
    "var_name": "variable",
}
"""Kind of the names that parameters of these names take."""

_TEXTS: Final = {
    "socket": "connection of this program",
    "modbus": "MODBUS signal of this program",
    "address": "address used in this program",
    "file": "file of this program",
    "variable": "variable of the server, used in this program",
}


class StringName(NamedTuple):
    """A name that may stand in a string, and one line about it."""

    name: str
    text: str


def names_for(document: Document, command: Command, param: Param) -> list[StringName]:
    """Return the names that a parameter may take: those used elsewhere in the text, and those beside the robot."""
    kind = _KINDS.get(param.name, "")
    if not kind:
        return []
    if kind == "input":
        return inputs()
    found = {name: "beside the robot" for name in document.settings.names.get(kind, ())}
    default = param.default if isinstance(param.default, str) else ""
    if default:
        found.setdefault(default, "the usual connection")
    program = document.program
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        for other, node in arguments.given:
            if _KINDS.get(other.name) == kind and other.quantity.type_name == "str":
                value = program.constants.value(node, called.scope)
                if isinstance(value, str) and value:
                    found.setdefault(value, _TEXTS[kind])
    return [StringName(name, text) for name, text in found.items()]


def inputs() -> list[StringName]:
    """Return the names of the RTSI inputs, registers among them."""
    from elitescript.protocol.rtsi.inputs import INPUT_ROWS

    return [
        StringName(row.name.replace("#", str(index)), f"RTSI input: {row.summary}")
        for row in INPUT_ROWS
        for index in row.indices
    ]
