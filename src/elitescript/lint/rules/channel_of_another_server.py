"""A second server under the name of a channel that is still open.

`socket_open` keeps a channel that stands, and returns True: what is sent then goes to the first server. A second
address that is only tried if the first one fails is left alone, and so is a channel that is closed anywhere.

    def job():
      socket_open("192.168.1.20", 5000)           # the camera
      socket_open("192.168.1.50", 6000)           # W247: the name still stands for the camera
      socket_open("192.168.1.60", 7000, "plc")    # fine: a name of its own
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.scopes import Scope
from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.lint.rules.channel_not_open import USUAL
from elitescript.said import said

_OPEN: Final = "socket_open"
_CLOSE: Final = "socket_close"
_NAME: Final = "socket_name"
_DEPTH_MAX: Final = 5
"""Functions around a call that are followed."""


@rule(code="W247", since="0.3", needs_values=True)
def channel_of_another_server(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each `socket_open` of another address."""
    called = program.derived(CalledCommands)
    opens = called.of(_OPEN)
    if len(opens) < 2 or called.are_passed_on(_CLOSE):
        return
    closed: set[str] = set()
    for found in called.of(_CLOSE):
        names = called.texts(found, _NAME, USUAL)
        if not names:
            return
        closed.update(name or USUAL for name in names)
    first: dict[str, tuple[Called, str, int]] = {}
    for found in sorted(opens, key=lambda one: (one.call.lineno, one.call.col_offset)):
        names, addresses = called.texts(found, _NAME, USUAL), called.texts(found, "address", "")
        port = called.number(found, "port")
        if len(names) != 1 or len(addresses) != 1 or port is None:
            continue
        name = names[0] or USUAL
        older = first.setdefault(name, (found, addresses[0], port))
        if name in closed or older[1:] == (addresses[0], port) or not _is_behind(program, older[0], found):
            continue
        text = said(
            "socket_open: the channel {name!r} stands for {address}:{port} since line {line}",
            name=name,
            address=older[1],
            port=older[2],
            line=older[0].call.lineno,
        )
        yield Finding(found.call, text, "give each server a name of its own, the third argument")


def _is_behind(program: AnalysedProgram, first: Called, second: Called) -> bool:
    """Return whether a call always follows another one, and does not depend on how that ended."""
    from elitescript.lint.placing import conditions

    symbols = program.symbols
    earlier, later = (dict(_places(program, one)) for one in (first, second))
    for scope, call in earlier.items():
        if scope in later:
            other = later[scope]
            around = conditions(symbols, call)
            is_later = (call.lineno, call.col_offset) < (other.lineno, other.col_offset)
            return is_later and all(condition in around for condition in conditions(symbols, other))
        if conditions(symbols, call):
            break
    return False


def _places(program: AnalysedProgram, found: Called) -> Iterator[tuple[Scope, ast.Call]]:
    """Yield a call in its scope, and the only call of the function around it in its scope, and so on."""
    symbols = program.symbols
    scope, call = found.scope, found.call
    for _ in range(_DEPTH_MAX):
        yield scope, call
        if not isinstance(scope.node, ast.FunctionDef) or scope.kind != "function" or scope.parent is None:
            return
        reads = symbols.reads_of(scope.name, scope.parent.home(scope.name))
        above = symbols.parent(reads[0]) if len(reads) == 1 else None
        if not isinstance(above, ast.Call) or above.func is not reads[0]:
            return
        scope, call = symbols.scope_of(above), above
