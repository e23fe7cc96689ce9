"""Finds outputs, registers and flags that go to a level and on from it in one tick."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import SignalPulsed
from elitescript.said import said


class PulsesInATick(Observer):
    """Tells of each signal and line once: of one that comes back, as a pulse does; a note of any other.

    One that comes back in a block of `except` or `finally` is a note too.
    """

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[tuple[str, int]] = set()

    def see(self, seen: SignalPulsed) -> Iterable[Finding]:
        """Tell which level nothing outside has seen."""
        key = seen.signal, seen.line
        if key in self._told:
            return
        self._told.add(key)
        where = (
            "" if seen.first_line in (0, seen.line) else said(" (set in line {first_line})", first_line=seen.first_line)
        )
        text = said(
            "{signal} was {unseen}{where} and became {value} in the same tick of 4 ms: nothing "
            "outside has seen {unseen}",
            signal=seen.signal,
            unseen=seen.unseen,
            where=where,
            value=seen.value,
        )
        code = "W288" if seen.is_back and not seen.is_cleanup else "N285"
        yield found(code, text, line=seen.line, thread=seen.thread, hint="wait between both, such as sleep(0.1)")
