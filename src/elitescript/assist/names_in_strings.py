"""Finds what may stand in the strings that commands take as names: connections, signals, files, RTSI inputs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from elitescript.assist.document import Document
from elitescript.assist.names import STRING_NAMES
from elitescript.commands.definition.registry import Param
from elitescript.records import NamedTuple

_KINDS: Final = {
    **STRING_NAMES,
    "IP": "address",
    "address": "address",
    "connection_id": "address",
    "file_name": "file",
    "var_name": "variable of a server",
}
"""Kind of the names that parameters of these names take."""

_INPUTS: Final = STRING_NAMES["variable"]


class StringName(NamedTuple):
    """A name that may stand in a string, and one line about it."""

    name: str
    text: str


def names_for(document: Document, param: Param) -> list[StringName]:
    """Return the names that a parameter may take: those used elsewhere in the text, and those beside the robot."""
    kind = _KINDS.get(param.name, "")
    if not kind:
        return []
    if kind == _INPUTS:
        return inputs()
    found = dict.fromkeys(document.settings.names.get(kind, ()), "beside the robot")
    default = param.default if isinstance(param.default, str) else ""
    if default:
        found.setdefault(default, "the usual connection")
    for value, _ in _used(document, kind):
        found.setdefault(value, f"{kind} of this program")
    return [StringName(name, text) for name, text in found.items()]


def uses_of_name(document: Document, param: Param, name: str) -> list[int]:
    """Return the lines of the calls that use a name of the kind that a parameter takes."""
    kind = _KINDS.get(param.name, "")
    return sorted({line for value, line in _used(document, kind) if value == name}) if kind else []


def _used(document: Document, kind: str) -> Iterator[tuple[str, int]]:
    """Yield the names of a kind that calls of the text use, and their lines."""
    program = document.program
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        for param, node in arguments.given:
            if _KINDS.get(param.name) == kind and param.quantity.type_name == "str":
                value = program.constants.value(node, called.scope)
                if isinstance(value, str) and value:
                    yield value, node.lineno


def inputs() -> list[StringName]:
    """Return the names of the RTSI inputs, registers among them."""
    from elitescript.protocol.rtsi.inputs import INPUT_ROWS

    return [
        StringName(row.name.replace("#", str(index)), f"RTSI input: {row.summary}")
        for row in INPUT_ROWS
        for index in row.indices
    ]
