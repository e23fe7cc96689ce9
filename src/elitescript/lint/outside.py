"""Lists what a program names outside of the robot: addresses, serial ports, files."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.symbols import Resolution, Scope
from elitescript.lint.program import AnalysedProgram
from elitescript.records import NamedTuple

SOCKET: Final = "socket"
RPC: Final = "rpc"
MODBUS: Final = "modbus"
SERIAL: Final = "serial"
FILE: Final = "file"
CODE: Final = "code"
"""A text that is run as a program: what it names is not known."""

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

_RUNNERS: Final = frozenset(("eval", "exec"))
_OPEN: Final = "open"
_NAME_KEYWORDS: Final = frozenset(("file", "name", "path"))
"""Keywords of `_FUNCTIONS` for the name."""

_FUNCTIONS: Final = frozenset(
    [
        _OPEN,
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
    """`socket`, `rpc`, `modbus`, `serial`, `file` or `code`."""
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
        defaults = {} if _spreads(called.call) else {param.name: param.default for param in called.command.params}
        names = [name for name in (target.name, target.port) if name]
        known = {
            name: program.constants.value(given[name], called.scope) if name in given else defaults.get(name)
            for name in names
        }
        value, port = known.get(target.name, target.fixed), known.get(target.port)
        written = [ast.unparse(given[name]) for name in names if name in given]
        yield Named(
            *_place(program, called.call),
            target.kind,
            called.command.name,
            value if isinstance(value, str) else None,
            port if isinstance(port, int) else None,
            _arguments(called.call) if _spreads(called.call) or not written else ", ".join(written),
        )


def _spreads(call: ast.Call) -> bool:
    """Return whether a call has arguments of the form `*list` or `**dict`."""
    return any(isinstance(argument, ast.Starred) for argument in call.args) or any(
        keyword.arg is None for keyword in call.keywords
    )


def _arguments(call: ast.Call) -> str:
    """Return the arguments of a call as they are written."""
    return ", ".join(map(ast.unparse, [*call.args, *call.keywords]))


def _passed_on(program: AnalysedProgram) -> Iterator[Named]:
    """Yield the commands and functions that are used otherwise than by a call: what they get is not known."""
    for use in program.outside:
        target = COMMANDS.get(use.name)
        kind = target.kind if target is not None else CODE if use.name in _RUNNERS else FILE
        if not use.is_call and (target is not None or use.name == _OPEN or use.name in _RUNNERS):
            yield Named(*_place(program, use.node), kind, use.name, None, None, use.name)


def _of_functions(program: AnalysedProgram) -> Iterator[Named]:
    aliases = _aliases(program)
    for scope in program.symbols.scopes:
        for call in scope.calls:
            name = _function(program, call.func, scope, aliases)
            if name in _RUNNERS:
                yield Named(*_place(program, call), CODE, name, None, None, _arguments(call))
            elif name in _FUNCTIONS:
                yield _of_function(program, call, name, scope)


def _of_function(program: AnalysedProgram, call: ast.Call, name: str, scope: Scope) -> Named:
    by_name = (keyword.value for keyword in call.keywords if keyword.arg in _NAME_KEYWORDS)
    node = call.args[0] if call.args else next(by_name, None)
    value = None if node is None else program.constants.value(node, scope)
    text = _arguments(call) if node is None or _spreads(call) else ast.unparse(node)
    return Named(*_place(program, call), FILE, name, value if isinstance(value, str) else None, None, text or "/task/")


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
