"""Hands what happens in a program to the observers that take it; each is one file of `findings/observers`.

To write an observer:

1. A file in `findings/observers/` with one class, derived from `Observer`: a function of what it is given, with a
   little state of one program. `see` takes an event or an observation, `end` the end of the program; both yield
   findings. It reads no clock and asks the machine nothing.
2. A row of `OBSERVERS`: the file, the class, and the types that it takes.
3. What it takes is an event of `messages.events` (then its type is named in `OBSERVED` there too, so that other events
   cost nothing), or an observation of `messages.observations`, made by the place that knows the fact, and only when
   the fact is there: `machine.observe(ChannelLeft(...))`.
4. Its code is a row of `errors.CODES` (`W2xx`, or `N2xx` for a note: what sound programs may have), explained in
   `lint/explanations.py`; found at the end of the program, it has a row in `messages.events.SOURCES`.

A file is imported when the first event or observation that it takes has come, and its class is made anew for each
program: where nothing happens, nothing costs.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from typing import Any, Final

from elitescript.errors import CODES
from elitescript.messages.events import Event
from elitescript.messages.findings import Finding
from elitescript.messages.observations import (
    ChannelLeft,
    CommandRefused,
    EncoderStill,
    ForceMetNothing,
    InputMissed,
    ModbusReadAgain,
    ModbusReadEarly,
    ModbusReplaced,
    MotionLeft,
    NumbersDropped,
    Observation,
    OddAnswer,
    OtherServer,
    OutputBeforePoint,
    PeerClosed,
    ReadingEnded,
    ReadingResumed,
    RegisterCut,
    ServoStarved,
    SignalPulsed,
    StoppedAgain,
    TextBeyondAscii,
)
from elitescript.records import NamedTuple


class Observer:
    """Base of observers: one is made for each program in which something happens that it takes."""

    __slots__ = ()

    def see(self, seen: Any) -> Iterable[Finding]:
        """Take what has happened, one of the types of its row; return what is found by that."""
        return ()

    def end(self, ending: str) -> Iterable[Finding]:
        """Return what is found at the end of the program, `finished`, `alarm` or `stopped`."""
        return ()


class Row(NamedTuple):
    """One observer."""

    file: str
    """In `findings/observers`, without `.py`."""
    name: str
    """Of its class."""
    takes: tuple[type, ...]
    """Types of events and observations."""


OBSERVERS: Final = (
    Row("unread_data", "UnreadData", (ChannelLeft,)),
    Row("end_under_way", "EndUnderWay", (MotionLeft,)),
    Row("odd_answers", "OddAnswers", (OddAnswer,)),
    Row("dropped_numbers", "DroppedNumbers", (NumbersDropped,)),
    Row("unfinished_readings", "UnfinishedReadings", (ReadingEnded, ReadingResumed)),
    Row("closed_peers", "ClosedPeers", (PeerClosed,)),
    Row("other_servers", "OtherServers", (OtherServer,)),
    Row("beyond_ascii", "BeyondAscii", (TextBeyondAscii,)),
    Row("early_modbus", "EarlyModbus", (ModbusReadEarly, ModbusReadAgain)),
    Row("replaced_modbus", "ReplacedModbus", (ModbusReplaced,)),
    Row("cut_registers", "CutRegisters", (RegisterCut,)),
    Row("pulses_in_a_tick", "PulsesInATick", (SignalPulsed,)),
    Row("missed_inputs", "MissedInputs", (InputMissed,)),
    Row("starved_servo", "StarvedServo", (ServoStarved,)),
    Row("still_encoders", "StillEncoders", (EncoderStill,)),
    Row("free_force", "FreeForce", (ForceMetNothing,)),
    Row("swallowed_refusals", "SwallowedRefusals", (CommandRefused,)),
    Row("short_stops", "ShortStops", (StoppedAgain,)),
    Row("outputs_before_points", "OutputsBeforePoints", (OutputBeforePoint,)),
)
"""All observers, in the order in which they see what they share."""


class Observers:
    """The observers of one program."""

    __slots__ = ("_begun", "_by_type")

    def __init__(self) -> None:
        self._begun: dict[Row, Observer] = {}
        self._by_type: dict[type, tuple[Observer, ...]] = {}

    def see(self, seen: Event | Observation) -> list[Finding]:
        """Return what observers find by what has happened."""
        kind = type(seen)
        observers = self._by_type.get(kind)
        if observers is None:
            observers = self._by_type[kind] = tuple(self._of(row) for row in OBSERVERS if kind in row.takes)
        return [finding for observer in observers for finding in observer.see(seen)]

    def end(self, ending: str) -> list[Finding]:
        """Return what those find at the end of the program that have seen anything."""
        return [finding for row in OBSERVERS if row in self._begun for finding in self._begun[row].end(ending)]

    def _of(self, row: Row) -> Observer:
        if row not in self._begun:
            made: Observer = getattr(import_module(f"elitescript.findings.observers.{row.file}"), row.name)()
            self._begun[row] = made
        return self._begun[row]


def found(code: str, text: str, *, line: int = 0, column: int = 0, hint: str = "", thread: str = "") -> Finding:
    """Make the finding of an observer; its severity is that of its code."""
    return Finding(code, CODES[code].default_severity, line, column, text, hint, thread=thread)
