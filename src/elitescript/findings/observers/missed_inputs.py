"""Finds inputs that change to and fro between two looks of a line that polls them."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import InputMissed
from elitescript.messages.timing import seconds
from elitescript.said import said


class MissedInputs(Observer):
    """Tells of each input and line once when it happens, and at the end how often it was."""

    __slots__ = ("_missed",)

    def __init__(self) -> None:
        self._missed: dict[tuple[str, int], list[InputMissed]] = {}

    def see(self, seen: InputMissed) -> Iterable[Finding]:
        """Tell of the first time."""
        known = self._missed.setdefault((seen.signal, seen.line), [])
        known.append(seen)
        if len(known) > 1:
            return
        step_s = seconds(seen.step_ticks)
        changes = said(
            "{signal} changed {changes} times between two looks of this line", signal=seen.signal, changes=seen.changes
        )
        text = said(
            "{changes}, which looks every {step_s:g} s: the program has missed a pulse", changes=changes, step_s=step_s
        )
        hint = "look more often, with sync() in the loop, or let the sender hold the level for longer"
        yield found("W289", text, line=seen.line, thread=seen.thread, hint=hint)
