"""The record of a run."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar, get_args

from elitescript.controller.views.trace_signals import SignalRecord
from elitescript.errors import AlarmError, UsageError, did_you_mean
from elitescript.language.compiler import CompiledUnit
from elitescript.messages.events import (
    UNDELIVERED,
    Alarm,
    Change,
    DeviceNoted,
    Event,
    Popup,
    Printed,
    SignalChanged,
    TextMessage,
    Warned,
    event_of,
)
from elitescript.messages.motion import Six
from elitescript.records import NamedTuple
from elitescript.said import joined, said

if TYPE_CHECKING:
    from elitescript.controller.views.trace_rows import TraceRows
    from elitescript.findings.found import Findings, Found
    from elitescript.language.diagnostics import Diagnostic
    from elitescript.solids.contacts import Contact, ContactWatch

RECORDS_MAX: Final = 50_000
"""Events, and texts of each kind, that a run keeps at least, unless they are long:"""
TEXT_MAX: Final = 64 << 20
"""Characters of the texts of its events that a run keeps; likewise of the texts of each kind."""

NOT_DELIVERED: Final = "not delivered: {text}"
"""Begin of the warning about data that a program sent before its end and that did not arrive."""

_Record = TypeVar("_Record")

EndState = Literal["finished", "alarm", "stopped", "time_limit", "stuck"]

EXIT_CODES: Final = {"finished": 0, "stopped": 0, "alarm": 1, "time_limit": 4, "stuck": 5}
"""Exit code of a process that runs one program, by the state at its end."""

ENDINGS: Final = {
    "": "still running",
    "finished": "finished",
    "alarm": "ended by an alarm",
    "stopped": "stopped",
    "time_limit": "still running at the time limit",
    "stuck": "stuck: nothing can ever happen again",
}
"""States of a run in words."""


class ProgramGlobals(dict[str, Any]):
    """The variable monitor; a name that is not there is refused with the names that are."""

    __slots__ = ()

    def __missing__(self, name: object) -> Any:
        near = did_you_mean(name, self) if isinstance(name, str) else ""
        known = f"; there are {', '.join(sorted(self)[:20])}" if self else "; the program declares none"
        raise KeyError(f"no global is called {name!r}{near or known}")


class Look(NamedTuple):
    """State of a run at a tick; see the properties of `Run`."""

    time_s: float = 0.0
    joints: Six | tuple[()] = ()
    tcp_pose: Six | tuple[()] = ()
    signals: SignalRecord = SignalRecord()
    globals: dict[str, Any] = ProgramGlobals()


class EventRecord:
    """The last events of a run. Those of signals are made when the events are read for the first time.

    Attributes:
        dropped: how many events have gone.
    """

    __slots__ = ("_events", "_is_read", "_text", "dropped")

    def __init__(self) -> None:
        self._events: list[Any] = []
        self._is_read = False
        self._text = 0
        """Characters of the texts of the events, at least."""
        self.dropped = 0

    def add(self, event: Event | Change) -> None:
        """Record an event."""
        self._events.append(event_of(event) if self._is_read else event)
        if len(self._events) > _SURPLUS_FROM:
            self.dropped += _trim(self._events)

    def weigh(self, characters: int) -> None:
        """Count the text of the event that was added last; the oldest events go if all texts are too long."""
        self._text += characters
        if self._text > TEXT_MAX:
            self._text, gone = _lighten(self._events)
            self.dropped += gone

    def read(self) -> list[Event]:
        """Return the events, always in the same list, which grows with the run."""
        if not self._is_read:
            self._is_read = True
            self._events[:] = map(event_of, self._events)
        return self._events

    def raw(self) -> list[Any]:
        """Return the events, of which changes of signals may not have been made."""
        return self._events

    def replace(self, events: list[Event]) -> None:
        """Go on with another list, which grows instead of the one before."""
        self._is_read, self._events = True, events


class ChosenEvents(EventRecord):
    """The last events of a run that are of chosen kinds; the others count as gone.

    Args:
        kinds: types of events.
    """

    __slots__ = ("_is_kept", "_kinds")

    def __init__(self, kinds: frozenset[type]) -> None:
        super().__init__()
        self._kinds = kinds
        self._is_kept = False

    def add(self, event: Event | Change) -> None:
        # A change of a signal is a tuple until its event is made.
        kind = SignalChanged if type(event) is tuple else type(event)
        self._is_kept = kind in self._kinds
        if self._is_kept:
            super().add(event)
        else:
            self.dropped += 1

    def weigh(self, characters: int) -> None:
        if self._is_kept:
            super().weigh(characters)


def record_of(keep: str | Iterable[str]) -> EventRecord:
    """Return a record that keeps events of these kinds.

    Args:
        keep: `all`, `none`, or names of kinds, as in `docs/reference/events.md`; in a string separated by commas.

    Raises:
        UsageError: there is no such kind.
    """
    names = [name.strip() for name in keep.split(",")] if isinstance(keep, str) else list(keep)
    if names == ["all"]:
        return EventRecord()
    if names == ["none"]:
        return ChosenEvents(frozenset())
    kinds = {kind.__name__: kind for kind in get_args(Event)}
    for name in names:
        if name not in kinds:
            near = did_you_mean(str(name), kinds)
            raise UsageError(
                said(
                    "no kind of event is called {name}{near}; keep takes all, none, or some of {kinds}",
                    name=repr(name),
                    near=near,
                    kinds=", ".join(map(str, kinds)),
                )
            )
    return ChosenEvents(frozenset(kinds[name] for name in names))


class Run:
    """The record of a run, which grows while the program runs.

    `time_s`, `globals`, `joints`, `tcp_pose` and `signals` are those of the present tick while it runs.

    Attributes:
        state: `finished`, `alarm`, `stopped`, `time_limit` or `stuck`; empty while it runs.
        log: texts of `textmsg`, in order.
        printed: texts of `print`, in order.
        warnings: texts of warnings, those of the compiler and of virtual devices included. Of one kind there are at
            most ten, and then their number, here and in `events`.
        alarms: what stopped the program.
        undelivered: data that the program sent and that did not arrive, as text; each is a warning too.
        check_text: returns what `check` finds in the text; None leaves that out of `findings`.
        look: returns the present values of the properties; None before the start and after the end.
        watch: finds contacts; None if the world has no solids.
        threads: script threads at the end of a program that did not end by itself: where each was.
        is_paced: whether a connection to the outside held virtual time back to the wall clock.
    """

    __slots__ = (
        "__weakref__",
        "_end",
        "_found",
        "_signals",
        "_texts",
        "_trace",
        "alarms",
        "check_text",
        "is_alone",
        "is_paced",
        "log",
        "look",
        "printed",
        "record",
        "start_tick",
        "state",
        "threads",
        "undelivered",
        "unit",
        "warnings",
        "watch",
    )

    def __init__(
        self,
        unit: CompiledUnit,
        start_tick: int,
        problems: Iterable[Diagnostic] = (),
        record: EventRecord | None = None,
    ) -> None:
        self.unit = unit
        self.start_tick = start_tick
        self.state: EndState | Literal[""] = ""
        self.log: list[str] = []
        self.printed: list[str] = []
        self.warnings: list[str] = [str(problem) for problem in problems]
        self._texts = [0, 0, 0]
        """Characters of `log`, `printed` and `warnings`, at least."""
        self.alarms: list[Alarm] = []
        self.record = EventRecord() if record is None else record
        """What `events` are read from."""
        self._trace: TraceRows | None = None
        self.undelivered: list[str] = []
        self.check_text: Callable[[], tuple[Diagnostic, ...]] | None = None
        self._found: Found | None = None
        """Findings of the run itself, from the first on."""
        self.look: Callable[[], Look] | None = None
        self._end: Look | None = None
        self._signals: SignalRecord | None = None
        self.threads: tuple[Any, ...] = ()
        self.watch: ContactWatch | None = None
        self.is_paced = False
        self.is_alone = False
        """Whether no preset holds a set, and nothing is beside it: devices, clients, secondary programs with sets."""

    @property
    def events(self) -> list[Event]:
        """Everything that happened, in order, each kind as `docs/reference/events.md` says.

        Of a very long run these are the last `RECORDS_MAX`, and fewer if their texts have more than `TEXT_MAX`
        characters. So it is with the texts.
        """
        return self.record.read()

    @events.setter
    def events(self, events: list[Event]) -> None:
        self.record.replace(events)

    @property
    def events_dropped(self) -> int:
        """How many events have gone, so that a run of days does not fill the memory, or were not to be kept."""
        return self.record.dropped

    @property
    def findings(self) -> Findings:
        """What `check` finds in the text and what the run has found, in one list: the worst first, then by line.

        Equal ones are one row with their number; `findings.error`, `findings.warning` and `findings.note` count rows.
        """
        # Imported late: of most runs nothing asks for it.
        from elitescript.findings.found import Found

        found = Found() if self._found is None else self._found
        return found.listed(() if self.check_text is None else self.check_text())

    @property
    def has_findings(self) -> bool:
        """Whether `findings` may have a row: False costs less than the list."""
        return self._found is not None or self.unit.findings != ()

    def __getattr__(self, name: str) -> Any:
        # Called for what is not there alone.
        raise AttributeError(f"'Run' object has no attribute {name!r}{did_you_mean(name, dir(type(self)))}")

    @property
    def verdict(self) -> str:
        """How it ended and what was found, in words: `finished, 2 warnings`."""
        # An alarm is the state.
        counted = self.findings.without_alarms.words if self.has_findings else ""
        return f"{ENDINGS[self.state]}, {counted}" if counted else ENDINGS[self.state]

    @property
    def is_clean(self) -> bool:
        """Whether it finished, and neither its text nor the run has an error or a warning; notes do not count."""
        return self.state == "finished" and (not self.has_findings or self.findings.is_clean)

    @property
    def is_spoilt(self) -> bool:
        """Whether it finished with warnings of its own, which a strict robot does not allow."""
        return self.state == "finished" and self._found is not None and not self._found.listed().is_clean

    def exit_code(self, *, is_strict: bool = False) -> int:
        """Return the exit code of a process that runs this program alone.

        Args:
            is_strict: warnings of the run are a failure.
        """
        return EXIT_CODES[self.state or "stopped"] or (1 if is_strict and self.is_spoilt else 0)

    @property
    def why(self) -> str | None:
        """Why it did not finish, in a sentence; None if it finished, was stopped or still runs."""
        if self.alarms and self.state in ("alarm", "stuck"):
            return said("{kind}: {text}", kind=self.alarms[-1].class_name, text=self.alarms[-1].text)
        if self.state != "time_limit":
            return None
        text = "{thread} is in line {line}, {doing}"
        return joined("; ", (said(text, thread=row.name, line=row.line, doing=row.doing) for row in self.threads))

    @property
    def time_s(self) -> float:
        """Virtual time since the program began; at the end, until program and arm came to rest."""
        return self._now.time_s

    @property
    def globals(self) -> dict[str, Any]:
        """The variable monitor: names declared `global` and their values."""
        return self._now.globals

    @property
    def joints(self) -> Six | tuple[()]:
        """Target joint positions, rad."""
        return self._now.joints

    @property
    def tcp_pose(self) -> Six | tuple[()]:
        """Target TCP pose, base frame, m and rad."""
        return self._now.tcp_pose

    @property
    def signals(self) -> SignalRecord:
        """Every output and register that is not at its default; any other name gives its default.

        At the end of a run: when everything that the program sent has arrived.
        """
        if self._signals is not None:
            return self._signals
        return self._now.signals if self.look is None else self.look().signals

    @property
    def trace(self) -> TraceRows:
        """Rows, if a trace was requested; `trace[i].signals` has the signals by name."""
        if self._trace is None:
            # Imported late: few runs have rows.
            from elitescript.controller.views.trace_rows import TraceRows

            self._trace = TraceRows()
        return self._trace

    @property
    def contacts(self) -> list[Contact]:
        """Where the arm, its tool or payload touched a thing of the world file, or itself, in the order of time.

        Contacts are looked for if the world file has solids: `[[box]]`, `[[cylinder]]`, `[[sphere]]` or `[tool]`.
        """
        return [] if self.watch is None else self.watch.now

    @property
    def clearances(self) -> list[Contact]:
        """The closest that arm, tool or payload came to each thing of the world file; below 0 it was a contact."""
        return [] if self.watch is None else self.watch.clearances

    @property
    def _now(self) -> Look:
        if self._end is not None:
            return self._end
        return Look() if self.look is None else self.look()

    @property
    def is_over(self) -> bool:
        """Whether program and arm have come to rest."""
        return self._end is not None

    @property
    def is_closed(self) -> bool:
        """Whether everything that the program sent has arrived or was given up, so that nothing is added any more."""
        return self._signals is not None

    def rest(self, end: Look) -> None:
        """Keep the values at the end: program and arm have come to rest."""
        self._end = end

    def close(self, signals: SignalRecord) -> None:
        """Complete the record."""
        self._signals = signals
        self.look = None

    @property
    def is_reproducible(self) -> bool:
        """Whether another process gives the same bytes.

        Always if the program and its secondary programs cannot show the order of a set, no preset holds one, and
        neither devices nor clients are beside the robot. Else that needs a fixed seed of Python's string hashing:
        without it, what depends on the order of a set of strings can differ.
        """
        if self.is_alone and not self.unit.shows_hash_order:
            return True
        seed = "" if sys.flags.ignore_environment else os.environ.get("PYTHONHASHSEED", "")
        return not sys.flags.hash_randomization or seed not in ("", "random")

    def check(self) -> Run:
        """Return the run itself.

        Raises:
            AlarmError: the program ended with an alarm, or in a deadlock.
        """
        if self.alarms:
            alarm = self.alarms[-1]
            raise AlarmError(alarm, self.unit.source.where(alarm.line, alarm.column))
        return self

    def find(self, event: Warned | DeviceNoted | Alarm) -> None:
        """Count a warning or alarm among `findings`."""
        if self._found is None:
            # Imported late: many runs find nothing.
            from elitescript.findings.found import Found

            self._found = Found()
        self._found.take(event, self.start_tick)

    def add(self, event: Event, *, is_sum: bool = False) -> None:
        """Record an event of this run.

        Args:
            event: the event.
            is_sum: it only says how many findings have no event.
        """
        self.record.add(event)
        if type(event) not in _WITH_TEXT:
            return
        if isinstance(event, FINDINGS) and not is_sum:
            self.find(event)
        if isinstance(event, TextMessage):
            self._keep(self.log, 0, event.text)
        elif isinstance(event, Printed):
            self._keep(self.printed, 1, event.text)
        elif isinstance(event, Warned):
            self._keep(self.warnings, 2, event.text)
            if event.code == UNDELIVERED:
                _keep(self.undelivered, event.text.removeprefix(NOT_DELIVERED.partition("{")[0]))
        elif isinstance(event, DeviceNoted) and event.is_warning:
            self._keep(self.warnings, 2, said("{device}: {text}", device=event.device, text=event.text))
        elif isinstance(event, Alarm):
            self.alarms.append(event)
        self.record.weigh(_text_of(event))

    def _keep(self, texts: list[str], kind: int, text: str) -> None:
        """Append to a list that is bounded by number and by characters."""
        _keep(texts, text)
        self._texts[kind] += len(text)
        if self._texts[kind] > TEXT_MAX:
            self._texts[kind], _ = _lighten(texts)

    def _repr_html_(self) -> str:
        """Return what notebooks show: verdict, findings, and a picture of its time; with a trace of its joints too."""
        # Imported late: it is for notebooks alone.
        from elitescript.run.html import Shown, html_of

        return html_of(
            Shown(
                self.unit.source.name,
                self.verdict,
                self.is_clean,
                self.state in ("alarm", "stuck"),
                self.why or "",
                self.time_s,
                self.start_tick,
                self.findings,
                self.events,
                self.trace,
            )
        )

    def __repr__(self) -> str:
        return f"<Run {self.verdict}, {self.time_s:.3f} s>"


_WITH_TEXT: Final = frozenset({TextMessage, Printed, Popup, Warned, DeviceNoted, Alarm})
"""Events with a text of any length; most have a list of their own in a run."""


FINDINGS: Final = (Warned, DeviceNoted, Alarm)
"""Events that can be findings."""


_SURPLUS_FROM: Final = RECORDS_MAX + RECORDS_MAX // 10
"""A list is shortened by a tenth at a time: what is taken from its front costs its length."""


def _keep(records: list[_Record], record: _Record) -> None:
    """Append to a bounded list."""
    records.append(record)
    if len(records) > _SURPLUS_FROM:
        _trim(records)


def _trim(records: list[_Record]) -> int:
    """Drop the oldest records beyond the bound; return how many."""
    surplus = len(records) - RECORDS_MAX
    del records[:surplus]
    return surplus


def _lighten(records: list[Any]) -> tuple[int, int]:
    """Drop the oldest records until a tenth of the characters is free, but never the last one.

    Returns:
        how many characters are left, and how many records have gone.
    """
    sizes = [len(record) if isinstance(record, str) else _text_of(record) for record in records]
    left, gone = sum(sizes), 0
    while left > TEXT_MAX - TEXT_MAX // 10 and gone < len(records) - 1:
        left -= sizes[gone]
        gone += 1
    del records[:gone]
    return left, gone


def _text_of(event: Any) -> int:
    """Return how many characters the text of an event has; 0 if it has none."""
    if type(event) not in _WITH_TEXT:
        return 0
    return len(event.text) + (len(event.title) if isinstance(event, Popup) else 0)
