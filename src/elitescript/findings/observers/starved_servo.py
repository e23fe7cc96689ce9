"""Finds streams of servoj that stop the arm at each target, as the next one comes too late."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from elitescript.findings.observing import Observer, found
from elitescript.messages.findings import Finding
from elitescript.messages.observations import ServoStarved
from elitescript.messages.timing import seconds
from elitescript.said import said

IN_A_ROW: Final = 3
"""Stops at one line from which on they are no chance."""


class StarvedServo(Observer):
    """Tells of each line once, at the third stop."""

    __slots__ = ("_stops",)

    def __init__(self) -> None:
        self._stops: dict[int, int] = {}

    def see(self, seen: ServoStarved) -> Iterable[Finding]:
        """Count the stops of a line."""
        stops = self._stops[seen.line] = self._stops.get(seen.line, 0) + 1
        if stops == IN_A_ROW:
            step_s = seconds(seen.step_ticks)
            text = said(
                "servoj has t={t_s:g} s and gets a target every {step_s:g} s: the arm comes to rest at "
                "each of them and starts anew",
                t_s=seen.t_s,
                step_s=step_s,
            )
            hint = said(
                "send a target every {t_s:g} s, or give t={step_s:g} and do not sleep between",
                t_s=seen.t_s,
                step_s=step_s,
            )
            yield found("W290", text, line=seen.line, thread=seen.thread, hint=hint)
