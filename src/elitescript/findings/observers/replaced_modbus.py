"""Finds values of MODBUS signals that were replaced before they were sent."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import ModbusReplaced
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.said import said

FEW_SETS: Final = 20
"""A signal that is set more often, and faster than it is sent, carries a stream (*assumed*)."""


class ReplacedModbus(Observer):
    """Tells of each signal at the end of the program how many values the device has never got.

    A stream of values, such as a beat counter, is a note: of that only the last one matters.
    """

    __slots__ = ("_replaced",)

    def __init__(self) -> None:
        self._replaced: dict[str, list[ModbusReplaced]] = {}

    def see(self, seen: ModbusReplaced) -> Iterable[Finding]:
        """Keep the first and the last one."""
        known = self._replaced.setdefault(seen.signal, [])
        known[1:] = [seen]
        return ()

    def end(self, ending: str) -> Iterable[Finding]:
        """Tell of each signal."""
        for first, *others in self._replaced.values():
            last = others[-1] if others else first
            # A signal without a frequency is sent once for each set, as soon as there is room.
            period_ticks = TICKS_PER_S / (first.frequency_hz or TICKS_PER_S)
            is_stream = last.sets > FEW_SETS and last.span_ticks < 2 * period_ticks * last.sets
            rate = (
                said("the signal has {frequency_hz} Hz", frequency_hz=first.frequency_hz)
                if first.frequency_hz
                else said("it waits for the device")
            )
            text = said(
                "{unsent} in the MODBUS signal {signal!r} was replaced by {value} after {held_s:g} s, "
                "before it was sent: {rate}",
                unsent=first.unsent,
                signal=first.signal,
                value=first.value,
                held_s=seconds(first.held_ticks),
                rate=rate,
            )
            if others:
                text = said("{text}; others were too, up to line {line}", text=text, line=last.line)
            hint = "hold each value for longer than a period, or raise modbus_set_signal_update_frequency"
            code = "N286" if is_stream else "W286"
            yield found(code, text, line=first.line, thread=first.thread, hint=hint)
