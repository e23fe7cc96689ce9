"""Lets a debugger attach to the programs of a robot: they are compiled for it, and it is made when it comes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final, Protocol

from elitescript.language.compiler import CompiledUnit, table_of
from elitescript.language.options import SECONDARY, Options
from elitescript.language.probes import ATTACH_PROBES, ProbeTable
from elitescript.messages.outcomes import Outcome
from elitescript.records import replace

if TYPE_CHECKING:
    from elitescript.controller.controller import Controller
    from elitescript.messages.events import Event
    from elitescript.messages.inputs import Debug
    from elitescript.runtime.host import ScriptHost

UNITS_MAX: Final = 32
"""Programs that are kept, the newest ones, and as many secondary programs."""
Reply = Callable[[str, Outcome], None]


class Debugger(Protocol):
    """Debugs the programs of one robot."""

    @property
    def is_attached(self) -> bool:
        """Whether somebody debugs."""

    def take(self, item: Debug) -> None:
        """Do what is asked for, in the inbox phase of a tick, and reply."""

    def arrived(self, unit: CompiledUnit) -> None:
        """Take note of a unit that will run."""

    def event(self, event: Event) -> None:
        """Take an event when it happens."""

    def after_tick(self) -> None:
        """Look at the robot after a tick that has run."""

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick that must run for it; None if none must."""


class Debugging:
    """Compiles programs for a debugger that may come. Implements `runtime.probe.Probe`.

    Args:
        make: makes the debugger when the first request comes.

    Attributes:
        debugger: None while none is attached.
    """

    __slots__ = ("_make", "_next", "_options", "_units", "debugger")

    def __init__(self, make: Callable[[Controller, ScriptHost, Debugging, Reply], Debugger]) -> None:
        self._make = make
        self._next = 0
        self._options = Options()
        self._units: dict[int, tuple[CompiledUnit, Options]] = {}
        """By the number of their first statement, with the options that they were compiled with."""
        self.debugger: Debugger | None = None

    # ---------------------------------------------------------------- `Probe`

    def options(self, options: Options) -> Options:
        """Return the options to compile a text with."""
        self._options = replace(options, probes=ATTACH_PROBES, first_probe=self._next)
        return self._options

    def compiled(self, unit: CompiledUnit) -> None:
        """Take note of a unit, before it runs."""
        if unit.probes.size:
            self._units[unit.probes.first] = unit, self._options
            self._next = unit.probes.first + unit.probes.size
            alike = [first for first, (item, _) in self._units.items() if _is_alike(item, unit)]
            for first in alike[:-UNITS_MAX]:
                del self._units[first]
            if self.debugger is not None:
                self.debugger.arrived(unit)

    def hooks(self) -> dict[str, object]:
        """Return nothing: what these probes call is there in every run."""
        return {}

    # ---------------------------------------------------------------- for the debugger

    def units(self) -> list[CompiledUnit]:
        """Return the newest units, the newest first."""
        return [unit for unit, _ in reversed(self._units.values())]

    def table(self, unit: CompiledUnit) -> ProbeTable:
        """Return the table of the statements of a unit."""
        return table_of(unit, self._units[unit.probes.first][1])

    # ---------------------------------------------------------------- inputs

    def take(self, item: Debug, controller: Controller, host: ScriptHost, reply: Reply) -> None:
        """Hand a request to the debugger, which is made for the first one."""
        if self.debugger is None:
            self.debugger = self._make(controller, host, self, reply)
        self.debugger.take(item)
        if not self.debugger.is_attached:
            self.debugger = None


def _is_alike(unit: CompiledUnit, other: CompiledUnit) -> bool:
    """Return whether both are secondary programs, or neither is."""
    return (unit.kind == SECONDARY) is (other.kind == SECONDARY)
