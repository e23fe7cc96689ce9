"""Finds paths of many short moves that stop at each point."""

from __future__ import annotations

from collections.abc import Iterable

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import StoppedAgain
from elitescript.said import said


class ShortStops(Observer):
    """Tells of each line at the end of the program, with the number of stops."""

    __slots__ = ("_most",)

    def __init__(self) -> None:
        self._most: dict[int, StoppedAgain] = {}

    def see(self, seen: StoppedAgain) -> Iterable[Finding]:
        """Keep the longest path."""
        if seen.line not in self._most or self._most[seen.line].stops < seen.stops:
            self._most[seen.line] = seen
        return ()

    def end(self, ending: str) -> Iterable[Finding]:
        """Tell of each line."""
        for seen in self._most.values():
            text = said(
                "a path of short moves, the last of {way_mm:.3g} mm, came to rest at {stops} points in a row",
                way_mm=1000 * seen.way_m,
                stops=seen.stops,
            )
            hint = (
                "a blend radius r lets the arm go on through the points; servoj or a micro-segment file follow a path"
            )
            yield found("N224", text, line=seen.line, thread=seen.thread, hint=hint)
