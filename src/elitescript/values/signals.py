"""Finds what the signals of MODBUS are that a program adds: a coil, a register, or several of them."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.language.symbols import Resolution, Symbols
from elitescript.values.description import BOOL, INT, LIST, NO_SITES, TEXT, Value

_ADDERS: Final = ("modbus_add_signal", "modbus_add_rw_signal")
_COILS: Final = (0, 1)
_REGISTERS: Final = (2, 3)
_PLAIN_ARGUMENTS: Final = 5
"""Of `modbus_add_signal`: address of the device, slave, address, type and name. More may make it several registers."""


class Signals:
    """The kinds of the values of signals, by name; None if any signal may be of any kind."""

    __slots__ = ("kinds",)

    def __init__(self, symbols: Symbols) -> None:
        self.kinds: dict[str, int] | None = {}
        for scope in symbols.scopes:
            if not any(adder in scope.reads for adder in _ADDERS):
                continue
            for call in scope.calls:
                function = call.func
                if not isinstance(function, ast.Name) or function.id not in _ADDERS:
                    continue
                if scope.resolve(function.id) is Resolution.BUILTIN:
                    self._add(function.id, call)

    def _add(self, adder: str, call: ast.Call) -> None:
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        place = 4 if adder == _ADDERS[0] else 6
        name = given.get("signal_name") or (call.args[place] if len(call.args) > place else None)
        if not isinstance(name, ast.Constant) or type(name.value) is not str or None in given:
            # It may be any signal.
            self.kinds = None
        if self.kinds is None:
            return
        assert isinstance(name, ast.Constant)
        kind = BOOL | INT | LIST
        if adder == _ADDERS[0] and len(call.args) == _PLAIN_ARGUMENTS and not given:
            written = call.args[3]
            number = written.value if isinstance(written, ast.Constant) else None
            kind = BOOL if number in _COILS else INT if number in _REGISTERS else kind
        self.kinds[str(name.value)] = self.kinds.get(str(name.value), 0) | kind

    def narrowed(self, value: Value, name: Value) -> Value:
        """Return what the value of a signal is, by the description of its name."""
        if self.kinds is None or name.kinds != TEXT or not name.has_constant:
            return value
        kinds = self.kinds.get(name.constant, 0) & value.kinds
        if not kinds or kinds & LIST:
            return value
        if kinds == BOOL:
            return value.but(kinds=BOOL, low=0, high=1, constants=(False, True), shape=None, sites=NO_SITES)
        return value.but(kinds=kinds, shape=None, sites=NO_SITES)
