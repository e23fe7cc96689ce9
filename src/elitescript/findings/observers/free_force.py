"""Finds force modes that press and meet nothing."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import ForceMetNothing
from elitescript.messages.timing import seconds
from elitescript.said import said


class FreeForce(Observer):
    """Tells of each line once."""

    __slots__ = ("_told",)

    def __init__(self) -> None:
        self._told: set[int] = set()

    def see(self, seen: ForceMetNothing) -> Iterable[Finding]:
        """Tell for how long, and what was wanted."""
        if seen.line in self._told:
            return
        self._told.add(seen.line)
        wanted = ", ".join(f"{value:g}" for value in seen.target)
        text = said(
            "force mode was on for {duration_s:g} s with a target of [{wanted}] N, N m, and nothing has "
            "pressed against the tool: the arm moved freely, at its largest speed in that mode",
            duration_s=seconds(seen.duration_ticks),
            wanted=wanted,
        )
        hint = "give the run something to touch (contact in the world, --contact), or move nearer first"
        yield found("N288", text, line=seen.line, thread=seen.thread, hint=hint)
