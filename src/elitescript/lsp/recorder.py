"""Records what the events of a run do not tell: how often functions were called, and last values of their variables."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from types import CodeType, FrameType
from typing import Any, Final

from elitescript.language.compiler import CompiledUnit
from elitescript.plotting.packing import shown_text
from elitescript.records import NamedTuple
from elitescript.runtime.environment import without_addresses

VALUE_MAX: Final = 120
"""Characters of a value."""
NAMES_MAX: Final = 500
"""Names of a scope whose values are kept."""

BODY: Final = ""
"""Scope of the globals and of the body of the program."""


class _Function(NamedTuple):
    """A function of the text that runs: its scope, and the line of its first statement."""

    scope: str
    line: int


class CallRecorder:
    """Listens to the calls of a program's own functions, while it is entered.

    Attributes:
        counts: how often each function was called, by the line of its first statement.
    """

    __slots__ = ("_functions", "_unit", "_values", "counts")

    def __init__(self, unit: CompiledUnit) -> None:
        self._unit = unit
        self._functions: dict[CodeType, _Function | None] = {}
        self._values: dict[str, Mapping[str, Any]] = {}
        self.counts: dict[int, int] = {}

    def __enter__(self) -> CallRecorder:
        sys.setprofile(self._called)
        return self

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)

    def values(self) -> dict[str, dict[str, str]]:
        """Return the values that the variables of each scope had at the end of its last call, as text."""
        return {scope: _shown(values) for scope, values in self._values.items()}

    def _called(self, frame: FrameType, what: str, _: object) -> None:
        if what != "call" and what != "return":
            return
        code = frame.f_code
        try:
            function = self._functions[code]
        except KeyError:
            function = self._functions[code] = self._function(code)
        if function is None:
            return
        if what == "call":
            self.counts[function.line] = self.counts.get(function.line, 0) + 1
        else:
            self._values[function.scope] = dict(frame.f_locals)

    def _function(self, code: CodeType) -> _Function | None:
        """Return what a code object is; None if it is no function of the text."""
        if code.co_filename != self._unit.source.name or code.co_name.startswith("<"):
            return None
        lines = sorted(line for _, _, line in code.co_lines() if line is not None and line > code.co_firstlineno)
        scope = BODY if code.co_name == self._unit.name else code.co_name
        return _Function(scope, lines[0] if lines else code.co_firstlineno)


def _shown(values: Mapping[str, Any]) -> dict[str, str]:
    """Return the values of names as text, without functions and modules."""
    found: dict[str, str] = {}
    for name, value in values.items():
        if len(found) >= NAMES_MAX:
            break
        if name.startswith("_") or callable(value) or type(value).__name__ == "module":
            continue
        try:
            found[name] = shown_text(without_addresses(repr(value)), VALUE_MAX)
        except Exception:
            # The repr of an object of the program is a function of the program.
            found[name] = f"<{type(value).__name__}>"
    return found
