"""A recorded session of a served robot that runs again, with what came from outside, so that it can be debugged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from elitescript.controller.controller import Controller
from elitescript.environment.request_channels import RequestEnvironment
from elitescript.errors import UsageError
from elitescript.kernel import Kernel
from elitescript.language.compiler import CompiledUnit, compile_unit
from elitescript.language.diagnostics import Diagnostic
from elitescript.language.options import Options
from elitescript.language.probes import STEPS_PROBES
from elitescript.language.text.source import SourceFile
from elitescript.messages.cut import WHOLE
from elitescript.messages.events import Event
from elitescript.messages.inputs import Debug, Input
from elitescript.records import replace
from elitescript.runtime.host import ScriptHost
from elitescript.runtime.probe import Probe
from elitescript.runtime.threads.meter import RepeatingMeter
from elitescript.services.child.remote_files import RemoteFiles
from elitescript.services.journal.writer import JournalReader

Text = tuple[str, str]
"""Name and text of a program."""


class JournalSource:
    """The journal of a `serve`. Implements `debugger.source.Source`.

    Args:
        path: of the journal.
        until_tick: the last tick to play; all if None.

    Raises:
        UsageError: no journal, or one that cannot be debugged.

    Attributes:
        name: of the first program.
        text: of the first program.
        may_fork: True: nothing that is connected is real.
        problems: none: what was wrong with a program was said in the session.
        may_write: False: what files held is in the journal.
        texts: of all programs, by their names; one that has run more than once by the name that it had first.
        first_names: that name of every text, by the name that it has each time.
    """

    may_fork = True
    may_write = False

    def __init__(self, path: Path, until_tick: int | None = None) -> None:
        self._reader = JournalReader(path)
        # Read as a whole: an open file would be shared with snapshots of the process.
        self._records = list(self._reader.records())
        self._until = until_tick
        if any(isinstance(item, Debug) for record in self._records for item in record.get("in", ())):
            raise UsageError(f"{path}: a debugger was attached in this session, so that it cannot be debugged again")
        found = _Compiled()
        self._execution(found, lambda event: None, lambda: None, lambda tick: None).run()
        self._plan = found.plan
        self._units: dict[Text, CompiledUnit] = {}
        first = 0
        for unit, options in found.units:
            if _text(unit) not in self._units:
                counted = replace(options, probes=STEPS_PROBES, first_probe=first)
                self._units[_text(unit)] = compile_unit(unit.source, counted)
                first += self._units[_text(unit)].probes.size
        if not self._units:
            raise UsageError(f"{path}: no program has run in this session")
        self.problems: tuple[Diagnostic, ...] = ()
        firsts: dict[str, str] = {}
        for name, text in self._units:
            firsts.setdefault(text, name)
        self.texts = {name: text for text, name in firsts.items()}
        self.first_names = {name: firsts[text] for name, text in self._units}
        self.name, self.text = next(iter(self._units))

    def may_connect(self, text: str) -> bool:
        """See `debugger.source.Source.may_connect`: nothing that is connected is real."""
        return False

    @property
    def requests(self) -> int:
        """See `debugger.source.Source.requests`."""
        return 0

    def forget_requests(self, requests: int) -> None:
        """See `debugger.source.Source.forget_requests`."""

    def begin(
        self,
        probe: Probe | None,
        *,
        on_event: Callable[[Event], None],
        after_tick: Callable[[], None],
        next_stop: Callable[[int], int | None],
    ) -> JournalExecution:
        """See `debugger.source.Source.begin`."""
        if probe is None:
            return self._execution(None, on_event, after_tick, next_stop)
        for unit in self._units.values():
            probe.compiled(unit)
        firsts = {text: unit.probes.first for text, unit in self._units.items()}
        return self._execution(_Counted(probe, self._plan, firsts), on_event, after_tick, next_stop)

    def _execution(
        self,
        probe: Probe | None,
        on_event: Callable[[Event], None],
        after_tick: Callable[[], None],
        next_stop: Callable[[int], int | None],
    ) -> JournalExecution:
        return JournalExecution(self._reader, self._records, self._until, probe, on_event, after_tick, next_stop)


class JournalExecution:
    """One execution of a `JournalSource`. Implements `debugger.source.Execution`."""

    def __init__(
        self,
        reader: JournalReader,
        records: Sequence[dict[str, Any]],
        until_tick: int | None,
        probe: Probe | None,
        on_event: Callable[[Event], None],
        after_tick: Callable[[], None],
        next_stop: Callable[[int], int | None],
    ) -> None:
        self._records = records
        self._until = until_tick
        self._after_tick = after_tick
        self._next_stop = next_stop
        self._answers: list[Any] = []
        environment = RequestEnvironment(RemoteFiles(self._answer))
        self._meter = RepeatingMeter() if reader.is_metered else None
        self._kernel = Kernel(reader.options, environment, on_event=on_event, probe=probe, meter=self._meter)
        self.controller: Controller = self._kernel.controller
        self.host: ScriptHost = self._kernel.host

    def run(self) -> str:
        """Run to the end of the session, or to where its robot was replaced by a new one."""
        for record in self._records:
            if "tick" in record:
                self._advance(record["tick"] - 1)
                self._answers = list(record.get("asked", ()))
                if self._meter is not None:
                    self._meter.expect(record.get("cut", WHOLE))
                self._advance(record["tick"], record["in"])
            elif "digest" in record:
                self._advance(record["digest"])
            elif "restart" in record:
                return "stopped"
            elif "end" in record:
                self._advance(record["end"] - 1)
            if self._until is not None and self._kernel.next_tick > self._until:
                return "time_limit"
        return "finished"

    def close(self) -> None:
        """See `debugger.source.Execution.close`."""
        self.host.forget_threads()

    def _advance(self, last: int, inputs: Sequence[Input] = ()) -> None:
        """Run what is due up to and including a tick; the inputs are for that one."""
        kernel = self._kernel
        last = last if self._until is None else min(last, self._until)
        while kernel.next_tick <= last:
            number = kernel.next_tick
            if kernel.has_run:
                tick = self.controller.tick
                wanted = [due for due in (kernel.due_tick(), self._next_stop(tick), last) if due is not None]
                number = max(number, min(wanted))
            kernel.tick(inputs if number == last else (), number)
            self._after_tick()

    def _answer(self, question: list[Any]) -> list[Any]:
        if not self._answers:
            raise UsageError(f"tick {self._kernel.next_tick}: the journal has no answer to {question[0]!r} about files")
        return list(self._answers.pop(0))


class _Compiled:
    """Takes note of all texts of a session. Implements `runtime.probe.Probe`.

    Attributes:
        plan: the text of each attempt to compile one; None where that failed.
        units: those that were compiled, with how.
    """

    __slots__ = ("_options", "plan", "units")

    def __init__(self) -> None:
        self.plan: list[Text | None] = []
        self.units: list[tuple[CompiledUnit, Options]] = []
        self._options = Options()

    def options(self, options: Options, source: SourceFile) -> Options:
        self.plan.append(None)
        self._options = options
        return options

    def compiled(self, unit: CompiledUnit) -> None:
        self.plan[-1] = _text(unit)
        self.units.append((unit, self._options))

    def hooks(self) -> dict[str, object]:
        return {}


class _Counted:
    """Gives the statements of a text the same numbers each time it is compiled. Implements `runtime.probe.Probe`.

    Args:
        probe: counts them.
        plan: see `_Compiled`.
        firsts: number of the first statement of each text.
    """

    __slots__ = ("_firsts", "_next", "_plan", "_probe")

    def __init__(self, probe: Probe, plan: Sequence[Text | None], firsts: dict[Text, int]) -> None:
        self._probe = probe
        self._plan = plan
        self._firsts = firsts
        self._next = 0

    def options(self, options: Options, source: SourceFile) -> Options:
        self._next += 1
        text = self._plan[self._next - 1] if self._next <= len(self._plan) else None
        if text is None:
            return self._probe.options(options, source)
        return replace(options, probes=STEPS_PROBES, first_probe=self._firsts[text])

    def compiled(self, unit: CompiledUnit) -> None:
        text = self._plan[self._next - 1] if self._next <= len(self._plan) else None
        if text is None:
            self._probe.compiled(unit)
        elif text != _text(unit):
            raise UsageError(f"{unit.source.name}: another program than in the recorded session")

    def hooks(self) -> dict[str, object]:
        return self._probe.hooks()


def _text(unit: CompiledUnit) -> Text:
    return unit.source.name, unit.source.text
