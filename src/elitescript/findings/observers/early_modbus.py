"""Finds readings of MODBUS signals before their first answer, which are zeros."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import ModbusReadAgain, ModbusReadEarly
from elitescript.messages.timing import seconds
from elitescript.said import said


class EarlyModbus(Observer):
    """Tells of each line that has read a signal too early and never again; one that reads it again is a note.

    A line that reads a signal again and again gets its value in the end; its first readings were no values.
    """

    __slots__ = ("_early",)

    def __init__(self) -> None:
        self._early: dict[tuple[str, int], tuple[ModbusReadEarly, int]] = {}

    def see(self, seen: ModbusReadEarly | ModbusReadAgain) -> Iterable[Finding]:
        """Keep an early reading."""
        key = seen.signal, seen.line
        if isinstance(seen, ModbusReadEarly):
            first, count = self._early.get(key, (seen, 0))
            self._early[key] = first, count + 1
        elif key in self._early:
            yield _told("N284", *self._early.pop(key))

    def end(self, ending: str) -> Iterable[Finding]:
        """Tell of what was not read again."""
        for first, count in self._early.values():
            yield _told("W285", first, count)


def _told(code: str, first: ModbusReadEarly, count: int) -> Finding:
    age_s = seconds(first.age_ticks)
    times = "" if count == 1 else said(", in {count} readings", count=count)
    text = said(
        "the MODBUS signal {signal!r} had no value yet{times}, it was added {age_s:g} s before: "
        "the {value} that was read is no answer of the device",
        signal=first.signal,
        times=times,
        age_s=age_s,
        value=first.value,
    )
    hint = "add signals once, at the begin, and wait until modbus_get_error gives [0, 0], or for sleep(0.5)"
    return found(code, text, line=first.line, thread=first.thread, hint=hint)
