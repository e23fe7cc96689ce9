"""A channel that nothing opens, in a program that opens another one: its name is misspelt or left out.

Without a name a command uses the channel `socket_0`. A text that opens no channel may be a part of a program that does,
and names that are computed may be any: both are left alone.

    def job():
      socket_open("192.168.1.20", 5000, "camera")
      socket_send_line("where?", 0, "camera")     # fine
      s = socket_read_string("camra")             # W246: is `camera` meant?
      n = socket_read_ascii_float(3)              # W246: the name is left out
    end
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from elitescript.language.advice.unknown_names import Meant
from elitescript.language.diagnostics import Edit, Fix
from elitescript.lint.called import Called, CalledCommands
from elitescript.lint.program import AnalysedProgram
from elitescript.lint.registry import Finding, rule
from elitescript.said import said

_OPEN: Final = "socket_open"
_NAME: Final = "socket_name"
USUAL: Final = "socket_0"
"""Name of the channel where none is given."""
_TEXTS: Final = ("str", "name", "var_name", "value")
"""Parameters for what is sent, which stand before the name."""


@rule(code="W246", since="0.3", needs_all_lines=True, needs_values=True)
def channel_not_open(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each use of such a name."""
    called = program.derived(CalledCommands)
    opened: set[str] = set()
    for found in called.all_of(_OPEN):
        names = called.texts(found, _NAME, USUAL)
        if not names:
            return
        opened.update(name or USUAL for name in names)
    if not opened or called.are_passed_on(_OPEN) or program.shares_globals:
        return
    meant = Meant(lambda: opened)
    listed = ", ".join(repr(name) for name in sorted(opened)[:4])
    for found in called.all_of():
        if not found.name.startswith("socket_") or found.name == _OPEN:
            continue
        names = tuple(name or USUAL for name in called.texts(found, _NAME, USUAL))
        if names and opened.isdisjoint(names):
            yield _told(program, found, names[0], opened, meant, listed)


def _told(program: AnalysedProgram, found: Called, name: str, opened: set[str], likely: Meant, listed: str) -> Finding:
    node = found.given.get(_NAME)
    if node is None:
        text = said(
            "{command}: no channel is named, and nothing opens the usual one, {usual!r}",
            command=found.name,
            usual=USUAL,
        )
        return Finding(found.call, text, said("name the channel: {listed}", listed=listed))
    text = said("{command}: nothing opens a channel {name!r}", command=found.name, name=name)
    if any(not opened.isdisjoint(program.derived(CalledCommands).texts(found, param, "")) for param in _TEXTS):
        return Finding(node, text, "what is sent comes first, the name of the channel behind it")
    if not name.strip("\r\n"):
        return Finding(node, text, said("the name comes first: suffix={name!r} is the mark behind the text", name=name))
    meant = likely.by(name)
    hint = said("is {meant!r} meant?", meant=meant) if meant else said("opened here: {listed}", listed=listed)
    fix = None
    if meant and isinstance(node, ast.Constant):
        fix = Fix(said("write {meant!r}", meant=meant), (Edit(*program.span(node), f'"{meant}"'),), safe=False)
    return Finding(node, text, hint, fix)
