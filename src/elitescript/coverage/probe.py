"""Counts what the programs of a process run, in a `Recorder`. Implements `runtime.probe.Probe`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

from elitescript.coverage.recording import Recorder, counters_max
from elitescript.errors import InternalError, ScriptError
from elitescript.language.compiler import CompiledUnit
from elitescript.language.hooks import HITS
from elitescript.language.options import LINE, SCRIPT, Options
from elitescript.language.probes import HITS_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.messages.events import Alarm, Event, SafetyModeChanged, TaskStateChanged
from elitescript.records import replace

ALARM: Final = "alarm"
REFUSAL: Final = "refusal"
SAFETY: Final = "safety"
TASK: Final = "task"
FAULT: Final = "fault"
"""Kinds of facts. Their details: a code; command, class and code; a state; a state; place and kind of fault."""
PLACE: Final = "place"
"""A place of a world that can have faults: its name, its kind and the device there."""


class CoverageProbe:
    """Counts the statements of all programs of a process.

    Args:
        recorder: keeps the counters.
        path_of: returns the path of a program by its name, as reports need it.

    Attributes:
        recorder: see above; in a process that was forked, a copy takes its place.
    """

    __slots__ = ("__weakref__", "_path_of", "recorder")

    def __init__(self, recorder: Recorder, path_of: Callable[[str], str]) -> None:
        self.recorder = recorder
        self._path_of = path_of

    def options(self, options: Options, source: SourceFile) -> Options:
        """Return the options that count the statements of a text.

        Neither lines of interpreter mode are counted, nor a program that is read as a script, which has other numbers.
        """
        if options.kind in (LINE, SCRIPT):
            return options
        name = source.name
        first = self.recorder.counters(name if name.startswith("<") else self._path_of(name), source.text)
        return options if first is None else replace(options, probes=HITS_PROBES, first_probe=first)

    def compiled(self, unit: CompiledUnit) -> None:
        """Check that the counters of a unit are its own.

        Raises:
            InternalError: they would be those of another program.
        """
        if unit.probes.size > counters_max(unit.source.text):
            raise InternalError(f"{unit.source.name} has {unit.probes.size} counters, more than there is room for")

    def hooks(self) -> dict[str, object]:
        """Return the counters, by the name under which programs find them."""
        return {HITS: self.recorder.cells}

    def event(self, event: Event) -> None:
        """Take note of alarms and states."""
        if isinstance(event, Alarm):
            self.recorder.fact(ALARM, event.code)
        elif isinstance(event, SafetyModeChanged):
            self.recorder.fact(SAFETY, event.mode.name)
        elif isinstance(event, TaskStateChanged):
            self.recorder.fact(TASK, event.state.name)

    def refused(self, command: str, error: ScriptError) -> None:
        """Take note of the refusal of a command."""
        self.recorder.fact(REFUSAL, command, type(error).__name__, error.code)

    def faults(self, places: Sequence[tuple[str, str, str]], faults: Sequence[tuple[str, str]]) -> None:
        """Take note of what can have faults, and of faults."""
        for place in places:
            self.recorder.fact(PLACE, *place)
        for fault in faults:
            self.recorder.fact(FAULT, *fault)
