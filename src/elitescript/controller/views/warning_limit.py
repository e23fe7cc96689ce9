"""Limits the warnings of one kind in one run of a program.

A program with a thousand short blends would give a thousand equal warnings. The first ten of each kind are events; the
others are counted, and the count is an event at the end of the run, at the place of the first that is no event.
"""

from __future__ import annotations

import re
from typing import Final

from elitescript.messages.events import DeviceNoted, Event, Warned
from elitescript.records import replace

MOST: Final = 10
"""Warnings of one kind in a run."""
_KINDS_MAX: Final = 1000
"""Most kinds that are counted; warnings of further kinds all pass."""
_NUMBERS: Final = r"[-+]?\d[\d.]*(?:e[-+]?\d+)?"

LIMITED: Final = frozenset({Warned, DeviceNoted})
"""Events that can be warnings; all others pass."""
_Warning = Warned | DeviceNoted


class WarningLimit:
    """Counts the warnings of a run by kind: by code, or by text without its numbers."""

    __slots__ = ("_counts", "_left_out")

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], int] = {}
        self._left_out: dict[tuple[str, str], _Warning] = {}
        """The first of each kind that has not passed."""

    def takes(self, event: Event) -> bool:
        """Return whether an event passes; a warning that does not is counted."""
        if not (isinstance(event, Warned) or (isinstance(event, DeviceNoted) and event.is_warning)):
            return True
        kind = _kind(event)
        if kind not in self._counts and len(self._counts) >= _KINDS_MAX:
            return True
        self._counts[kind] = count = self._counts.get(kind, 0) + 1
        if count == MOST + 1:
            self._left_out[kind] = event
        return count <= MOST

    def rest(self, tick: int) -> list[Event]:
        """Return the numbers of warnings left out as warnings, and begin to count anew."""
        left_out: list[Event] = []
        for kind, first in self._left_out.items():
            text = f"… {self._counts[kind] - MOST:,} more of this kind, beginning with: {first.text}"
            left_out.append(replace(first, tick=tick, text=text))
        self._counts.clear()
        self._left_out.clear()
        return left_out


def _kind(event: _Warning) -> tuple[str, str]:
    if isinstance(event, DeviceNoted):
        return event.device, re.sub(_NUMBERS, "#", event.text)
    return "", event.code or re.sub(_NUMBERS, "#", event.text)
