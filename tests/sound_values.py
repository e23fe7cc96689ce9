"""Holds what the checker says of values against the values of every run: a pytest plugin.

Wherever a program of a test waits, its local variables and globals must be held by their descriptions (`values`).
A part of the programs is looked at in an ordinary session; with `ELITESCRIPT_SOUND=all` all of them are.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from types import FrameType
from typing import Any
from zlib import crc32

import pytest

from elitescript.language.compiler import CompiledUnit
from elitescript.language.garbage import without_collection
from elitescript.language.options import Options
from elitescript.language.parser import parse
from elitescript.language.scopes import Scope
from elitescript.language.symbols import Symbols
from elitescript.runtime.program import Program
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.values.description import holds
from elitescript.values.program import Values
from elitescript.values.words import words

LOOKS_AT_ALL = os.environ.get("ELITESCRIPT_SOUND") == "all"
ONE_IN = 1 if LOOKS_AT_ALL else 16
"""Of so many texts one is looked at."""
WAITS_MAX = 1_000 if LOOKS_AT_ALL else 100
"""Waits of a program at which its values are looked at."""


class Described:
    """A text that runs: its descriptions, and the scopes of its functions by line and name."""

    def __init__(self, unit: CompiledUnit, presets: frozenset[str]) -> None:
        self.unit = unit
        self.presets = presets
        self.waits = 0
        self._values: Values | None = None

    @property
    def values(self) -> Values:
        if self._values is None:
            symbols = Symbols(parse(self.unit.source, Options(kind=self.unit.kind)))
            self._values = without_collection(Values)(symbols, self.presets)
            self.scopes = {(getattr(scope.node, "lineno", 0), scope.name): scope for scope in symbols.scopes}
        return self._values

    def scope(self, frame: FrameType) -> Scope | None:
        """Return the scope of a frame; None if it is not certain."""
        symbols = self.values.symbols
        code = frame.f_code
        if code.co_name.startswith("<"):
            return None
        qualified = getattr(code, "co_qualname", code.co_name)
        if "." not in qualified:
            return symbols.body
        found = self.scopes.get((code.co_firstlineno, code.co_name))
        return found if found is not None and found.kind == "function" else None


class Witness:
    """Looks at the values of programs.

    Attributes:
        seen: how many values were looked at.
        known: of how many of them something is said.
        outside: what was said and is not so.
        is_on: programs are looked at.
    """

    def __init__(self) -> None:
        self.seen = 0
        self.known = 0
        self.outside: list[str] = []
        self.is_on = True
        self._programs: dict[int, tuple[Program, dict[str, Described]]] = {}
        """By the identity of their globals. They are kept, so that no other gets the same."""

    def runs(self, program: Program, unit: CompiledUnit) -> None:
        """Note that a text begins to run."""
        is_one = not crc32(unit.source.text.encode("utf-8", "surrogatepass")) % ONE_IN
        if not self.is_on or not (is_one or id(program.globals.values) in self._programs):
            return
        if not self._programs:
            Scheduler.wait = _wait  # type: ignore[method-assign]
        _, units = self._programs.setdefault(id(program.globals.values), (program, {}))
        units[unit.source.name] = Described(unit, frozenset(program.globals.values))

    def looks(self, scheduler: Scheduler) -> None:
        """Look at the variables of the strand that is about to wait."""
        strand = scheduler.current
        if strand is None or not self._programs:
            return
        for frame in strand.script_frames():
            _, units = self._programs.get(id(frame.f_globals), (None, {}))
            described = units.get(frame.f_code.co_filename)
            if described is None or described.waits >= WAITS_MAX:
                continue
            described.waits += 1
            scope = described.scope(frame)
            if scope is not None:
                self._compare(described, scope, dict(frame.f_locals), frame)

    def forgets(self) -> None:
        """Forget the programs of a test."""
        if self._programs:
            Scheduler.wait = _WAIT  # type: ignore[method-assign]
        self._programs.clear()
        self.outside.clear()

    def _compare(self, described: Described, scope: Scope, names: dict[str, Any], frame: FrameType) -> None:
        values = described.values
        if scope is values.symbols.body and described.unit.kind in ("program", "script"):
            # What a client sends while the program runs, such as a `sec`, may set its globals too.
            _, units = self._programs[id(frame.f_globals)]
            set_by_others = {
                name for unit in units.values() if unit is not described for name in unit.values.symbols.global_names
            }
            for other in values.symbols.scopes:
                for name in other.globals:
                    if name in frame.f_globals and name not in described.presets and name not in set_by_others:
                        self._hold(described, name, other, frame.f_globals[name], frame)
        for name, real in names.items():
            if not name.startswith(("@", ".")):
                self._hold(described, name, scope, real, frame)

    def _hold(self, described: Described, name: str, scope: Scope, real: object, frame: FrameType) -> None:
        value = described.values.variable(name, scope)
        self.seen += 1
        self.known += value.is_known
        if not holds(value, real):
            where = f"{described.unit.source.name}, line {frame.f_lineno}: {name} is {real!r:.80}"
            self.outside.append(f"{where}, but {words(value)!r} was said of it\n{described.unit.source.text}")


_DEBUGGING = ("tests/dap/", "tests/debugger/", "tests/studio/", "tests/mcp/", "tests/sweep/")
WITNESS = Witness()
_WAIT, _BODY_OF = Scheduler.wait, Program.body_of


def _wait(self: Scheduler, reason: str, until: int | None = None) -> bool:
    WITNESS.looks(self)
    return _WAIT(self, reason, until)


def _body_of(self: Program, unit: CompiledUnit, *variables: Any) -> Any:
    WITNESS.runs(self, unit)
    return _BODY_OF(self, unit, *variables)


def pytest_configure() -> None:
    """Look at every program that runs from now on."""
    Program.body_of = _body_of  # type: ignore[method-assign]


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Fail a test in whose programs a value is outside of what was said of it."""
    # Where calls are counted, those that look at values would be counted too; debuggers and sweeps change variables.
    WITNESS.is_on = "calls" not in item.name and not item.nodeid.startswith(_DEBUGGING)
    yield
    if WITNESS.outside:
        found = "\n".join(WITNESS.outside[:3])
        WITNESS.forgets()
        pytest.fail(f"values outside their descriptions:\n{found}", pytrace=False)
    WITNESS.forgets()


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say how many values were looked at."""
    if WITNESS.seen and LOOKS_AT_ALL:
        terminalreporter.write_line(f"{WITNESS.seen} values of programs, {WITNESS.known} of known kinds")
