"""A MODBUS signal that cannot be used like this: an input that is written, one of the other kind, or one never added.

Signals of type 1 are coils, which `modbus_set_output_signal` writes; those of type 3 are registers, which
`modbus_set_output_register` writes; those of type 0 and 2 are inputs. A text that adds no signal is left alone.

    def job():
      modbus_add_signal("192.168.1.50", 255, 0, 3, "speed")
      modbus_add_signal("192.168.1.50", 255, 1, 2, "angle")
      modbus_set_output_register("speed", 7)      # fine
      modbus_set_output_signal("speed", True)     # W249: it is a register
      modbus_set_output_register("angle", 7)      # W249: it is an input
      modbus_set_output_register("sped", 7)       # W249: is `speed` meant?
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

_NAME: Final = "signal_name"
_ADD: Final = "modbus_add_signal"
_ADD_BOTH: Final = "modbus_add_rw_signal"
_KINDS: Final = {0: "a digital input", 1: "a coil", 2: "an input register", 3: "a register"}
_WRITERS: Final = {"modbus_set_output_signal": 1, "modbus_set_output_register": 3}
_WRITER_OF: Final = {kind: writer for writer, kind in _WRITERS.items()}


def added_signals(program: AnalysedProgram) -> dict[str, set[int | None]]:
    """Return the types of the signals that a program adds, None for one that is unknown; empty if any may be added."""
    called = program.derived(CalledCommands)
    added: dict[str, set[int | None]] = {}
    every = called.all_of(_ADD, _ADD_BOTH)
    passed = {found.written for found in every if found.written is not found.call}
    for found in every:
        names = called.texts(found, _NAME, "")
        if not names:
            return {}
        kind = 3 if found.name == _ADD_BOTH else called.number(found, "signal_type")
        for name in names:
            kinds = added.setdefault(name, set())
            if kind is not None or found.call not in passed:
                kinds.add(kind)
    return {} if called.are_passed_on(_ADD, _ADD_BOTH) else added


@rule(code="W249", since="0.3", needs_all_lines=True, needs_values=True)
def modbus_signal(program: AnalysedProgram) -> Iterator[Finding]:
    """Report each such use."""
    added = added_signals(program)
    if not added or program.shares_globals:
        return
    meant = Meant(lambda: added)
    listed = ", ".join(map(repr, sorted(added)[:4]))
    for found in program.derived(CalledCommands).all_of():
        node = found.given.get(_NAME)
        if node is None or found.name in (_ADD, _ADD_BOTH):
            continue
        names = program.derived(CalledCommands).texts(found, _NAME, "")
        if names and added.keys().isdisjoint(names):
            yield _unknown(program, found, node, names[0], meant.by(names[0]), listed)
        elif found.name in _WRITERS and len(names) == 1:
            yield from _unfit(found, node, names[0], added[names[0]])


def _unknown(program: AnalysedProgram, found: Called, node: ast.expr, name: str, meant: str, listed: str) -> Finding:
    hint = said("is {meant!r} meant?", meant=meant) if meant else said("added here: {added}", added=listed)
    fix = None
    if meant and isinstance(node, ast.Constant):
        fix = Fix(said("write {meant!r}", meant=meant), (Edit(*program.span(node), f'"{meant}"'),), safe=False)
    return Finding(node, said("{command}: nothing adds a signal {name!r}", command=found.name, name=name), hint, fix)


def _unfit(found: Called, node: ast.expr, name: str, kinds: set[int | None]) -> Iterator[Finding]:
    if len(kinds) != 1:
        return
    (kind,) = kinds
    wanted = _WRITERS[found.name]
    if kind is None or kind not in _KINDS or kind == wanted:
        return
    hint = (
        said("{command} writes it", command=_WRITER_OF[kind])
        if kind in _WRITER_OF
        else "only coils, type 1, and registers, type 3, are written"
    )
    yield Finding(
        node,
        said("{command}: {name!r} is {what}, type {kind}", command=found.name, name=name, what=_KINDS[kind], kind=kind),
        hint,
    )
