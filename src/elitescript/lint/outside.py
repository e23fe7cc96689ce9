"""Lists what a program names outside of the robot: addresses, serial ports, files."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any, Final

from elitescript.commands.definition.registry import Command
from elitescript.language.symbols import Resolution, Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple

SOCKET: Final = "socket"
RPC: Final = "rpc"
MODBUS: Final = "modbus"
SERIAL: Final = "serial"
FILE: Final = "file"

_TOOL: Final = "tool"


class _Target(NamedTuple):
    """What a command reaches: the parameters with the address, or the name, and with the port."""

    kind: str
    name: str
    port: str = ""
    fixed: str = ""
    """The name, if no parameter has it."""


COMMANDS: Final[dict[str, _Target]] = {
    "socket_open": _Target(SOCKET, "address", "port"),
    "rpc_factory": _Target(RPC, "url"),
    "modbus_add_signal": _Target(MODBUS, "IP", "port"),
    "modbus_add_rw_signal": _Target(MODBUS, "IP", "port"),
    "modbus_send_custom_command": _Target(MODBUS, "IP", "port"),
    "modbus_reset_connection": _Target(MODBUS, "connection_id", "port"),
    "serial_config": _Target(SERIAL, "port"),
    "tool_serial_config": _Target(SERIAL, "", fixed=_TOOL),
    "load_micro_line_file": _Target(FILE, "file_name"),
}
"""Commands that begin to reach something outside; others use what these have opened."""

_FUNCTIONS: Final = frozenset(
    [
        "open",
        "os.listdir",
        "os.makedirs",
        "os.mkdir",
        "os.remove",
        "os.unlink",
        "os.path.exists",
        "os.path.getmtime",
        "os.path.getsize",
        "os.path.isdir",
        "os.path.isfile",
    ]
)
"""Functions of Python that take the name of a file or folder first."""


class Named(NamedTuple):
    """One place where a program names something outside."""

    line: int
    column: int
    kind: str
    """`socket`, `rpc`, `modbus`, `serial` or `file`."""
    by: str
    """The command or function."""
    name: str | None
    """Address, URL, serial port or file; None if it is not known before the run."""
    port: int | None
    """None if it is not known, or there is none."""
    text: str
    """How it is written."""


def outside_names(program: AnalysedProgram) -> list[Named]:
    """Return everything outside that a program names, in the order of its text.

    A value that is worked out while the program runs is listed without it.
    """
    found = {*_of_commands(program), *_passed_on(program), *_of_functions(program)}
    return sorted(found, key=lambda named: (named.line, named.column, named.by))


def _of_commands(program: AnalysedProgram) -> Iterator[Named]:
    for called, arguments in zip(program.command_calls, program.arguments, strict=True):
        target = COMMANDS.get(called.command.name)
        if target is None:
            continue
        given = {param.name: node for param, node in arguments.given}
        known: dict[str, Any] = {}
        for name in (target.name, target.port):
            if name in given:
                known[name] = program.constants.value(given[name], called.scope)
            elif name:
                known[name] = _default(called.command, name)
        value, port = known.get(target.name, target.fixed), known.get(target.port)
        text = ast.unparse(given[target.name]) if target.name in given else str(value)
        yield Named(
            *_place(program, called.call),
            target.kind,
            called.command.name,
            value if isinstance(value, str) else None,
            port if isinstance(port, int) else None,
            text,
        )


def _default(command: Command, name: str) -> Any:
    return next((param.default for param in command.params if param.name == name), None)


def _passed_on(program: AnalysedProgram) -> Iterator[Named]:
    """Yield the commands that are used otherwise than by a call: what they get is not known."""
    for use in program.outside:
        target = COMMANDS.get(use.name)
        if target is not None and not use.is_call:
            yield Named(*_place(program, use.node), target.kind, use.name, None, None, use.name)


def _of_functions(program: AnalysedProgram) -> Iterator[Named]:
    aliases = _aliases(program)
    for scope in program.symbols.scopes:
        for call in scope.calls:
            name = _function(program, call.func, scope, aliases)
            if name not in _FUNCTIONS:
                continue
            node = call.args[0] if call.args else next((item.value for item in call.keywords), None)
            value = None if node is None else program.constants.value(node, scope)
            text = "" if node is None else ast.unparse(node)
            yield Named(
                *_place(program, call), FILE, name, value if isinstance(value, str) else None, None, text or "/task/"
            )


def _function(program: AnalysedProgram, node: ast.expr, scope: Scope, aliases: dict[str, str]) -> str:
    """Return the full name of a function of Python that a call names; empty if it is none."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        return ""
    if node.id in aliases:
        return ".".join([aliases[node.id], *reversed(parts)])
    return node.id if not parts and scope.resolve(node.id) is Resolution.BUILTIN else ""


def _aliases(program: AnalysedProgram) -> dict[str, str]:
    """Return what imported names stand for, wherever they are imported."""
    found: dict[str, str] = {}
    for statement in program.nodes(ast.Import):
        for alias in statement.names:
            found[alias.asname or alias.name.partition(".")[0]] = (
                alias.name if alias.asname else alias.name.partition(".")[0]
            )
    for source in program.nodes(ast.ImportFrom):
        for alias in source.names:
            found[alias.asname or alias.name] = f"{source.module}.{alias.name}"
    return {name: meant for name, meant in found.items() if meant == "os" or meant.startswith("os.")}


def _place(program: AnalysedProgram, node: ast.AST) -> tuple[int, int]:
    return program.symbols.place(node)
