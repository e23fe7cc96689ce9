"""What a program did: the record that a run leaves behind."""

from __future__ import annotations

import os
import sys
from typing import Any, Final, Literal, TypeVar

from elitescript.controller.trace import TraceRow
from elitescript.errors import AlarmError
from elitescript.language.compiler import CompiledUnit
from elitescript.messages.events import Alarm, DeviceNoted, Event, Printed, TextMessage, Warned
from elitescript.messages.motion import Six
from elitescript.messages.signals import Value, parse_signal_name

RECORDS_MAX: Final = 50_000
"""Events, and texts of each kind, that a run keeps at least."""

_Record = TypeVar("_Record")

EndState = Literal["finished", "alarm", "stopped", "time_limit", "stuck"]


class SignalRecord(dict[str, Value]):
    """Signals that are not at their default, by name; any other signal that exists reads as its default."""

    def __missing__(self, name: str) -> Value:
        signal, _ = parse_signal_name(name)
        return signal.default


class Run:
    """What a program did.

    Attributes:
        state: `finished`, `alarm`, `stopped`, `time_limit` or `stuck`; empty while it runs.
        time_s: virtual time at the end, since the program began.
        globals: the variable monitor at the end: names declared `global` and their values.
        log: texts of `textmsg`, in order.
        printed: texts of `print`, in order.
        warnings: texts of warnings, those of the compiler and of virtual devices included. Of one kind there are at
            most ten, and then their number, here and in `events`.
        alarms: what stopped the program.
        events: everything that happened, in order; of a very long run the last `RECORDS_MAX`. So it is with the texts.
        events_dropped: how many events have gone, so that a run of days does not fill the memory.
        trace: rows, if a trace was asked for.
        joints: target joint positions at the end, rad.
        tcp_pose: target TCP pose at the end, base frame, m and rad.
        signals: every output and register that is not at its default; asked for any other, it gives the default.
        threads: script threads at the end of a program that did not end by itself: where each was.
        is_paced: whether a connection to the outside held virtual time back to the wall clock.
    """

    __slots__ = (
        "alarms",
        "events",
        "events_dropped",
        "globals",
        "is_paced",
        "joints",
        "log",
        "printed",
        "signals",
        "start_tick",
        "state",
        "tcp_pose",
        "threads",
        "time_s",
        "trace",
        "unit",
        "warnings",
    )

    def __init__(self, unit: CompiledUnit, start_tick: int) -> None:
        self.unit = unit
        self.start_tick = start_tick
        self.state: EndState | Literal[""] = ""
        self.time_s = 0.0
        self.globals: dict[str, Any] = {}
        self.log: list[str] = []
        self.printed: list[str] = []
        self.warnings: list[str] = [str(problem) for problem in unit.diagnostics]
        self.alarms: list[Alarm] = []
        self.events: list[Event] = []
        self.events_dropped = 0
        self.trace: list[TraceRow] = []
        self.joints: Six | tuple[()] = ()
        self.tcp_pose: Six | tuple[()] = ()
        self.signals = SignalRecord()
        self.threads: tuple[Any, ...] = ()
        self.is_paced = False

    @property
    def is_over(self) -> bool:
        """Whether program and arm have come to rest."""
        return bool(self.joints)

    @property
    def is_reproducible(self) -> bool:
        """Whether another process gives the same bytes: Python's string hashing has a fixed seed in this one.

        Without it, only what depends on the order of a set of strings can differ.
        """
        return not sys.flags.hash_randomization or os.environ.get("PYTHONHASHSEED", "random") != "random"

    def check(self) -> Run:
        """Return the run itself.

        Raises:
            AlarmError: the program ended with an alarm, or nothing could ever happen again.
        """
        if self.alarms:
            raise AlarmError(self.alarms[-1], self.unit.source.name)
        return self

    def add(self, event: Event) -> None:
        """Note an event of this run."""
        self.events_dropped += _keep(self.events, event)
        if isinstance(event, TextMessage):
            _keep(self.log, event.text)
        elif isinstance(event, Printed):
            _keep(self.printed, event.text)
        elif isinstance(event, Warned):
            _keep(self.warnings, event.text)
        elif isinstance(event, DeviceNoted) and event.is_warning:
            _keep(self.warnings, f"{event.device}: {event.text}")
        elif isinstance(event, Alarm):
            self.alarms.append(event)

    def __repr__(self) -> str:
        return f"<Run {self.state or 'running'} after {self.time_s:.3f} s>"


def _keep(records: list[_Record], record: _Record) -> int:
    """Append to a list that stays bounded; return how many old ones had to go."""
    records.append(record)
    surplus = len(records) - RECORDS_MAX
    # A tenth at a time: what is taken from the front of a list costs its length.
    if surplus <= RECORDS_MAX // 10:
        return 0
    del records[:surplus]
    return surplus
