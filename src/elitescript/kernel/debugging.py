"""Lets a debugger attach to the programs of a robot: they are compiled for it, and it is made when it comes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from elitescript.language.compiler import CompiledUnit
from elitescript.language.options import Options
from elitescript.language.probes import ATTACH_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.messages.outcomes import Outcome
from elitescript.records import replace

if TYPE_CHECKING:
    from elitescript.controller.controller import Controller
    from elitescript.messages.events import Event
    from elitescript.messages.inputs import Debug
    from elitescript.runtime.host import ScriptHost

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

    __slots__ = ("_make", "_next", "debugger")

    def __init__(self, make: Callable[[Controller, ScriptHost, Reply], Debugger]) -> None:
        self._make = make
        self._next = 0
        self.debugger: Debugger | None = None

    # ---------------------------------------------------------------- `Probe`

    def options(self, options: Options, source: SourceFile) -> Options:
        """Return the options to compile a text with."""
        return replace(options, probes=ATTACH_PROBES, first_probe=self._next)

    def reserve(self, size: int) -> None:
        """Keep so many numbers from the next one on for a text that comes back later."""
        self._next += size

    def compiled(self, unit: CompiledUnit) -> None:
        """Take note of a unit, before it runs."""
        self._next = max(self._next, unit.probes.first + unit.probes.size)
        if self.debugger is not None and unit.probes.size:
            self.debugger.arrived(unit)

    def hooks(self) -> dict[str, object]:
        """Return nothing: what these probes call is there in every run."""
        return {}

    # ---------------------------------------------------------------- inputs

    def take(self, item: Debug, controller: Controller, host: ScriptHost, reply: Reply) -> None:
        """Hand a request to the debugger, which is made for the first one."""
        if self.debugger is None:
            self.debugger = self._make(controller, host, reply)
        self.debugger.take(item)
        if not self.debugger.is_attached:
            self.debugger = None
