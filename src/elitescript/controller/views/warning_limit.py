"""The limit of warnings of one kind in one run of a program.

A program with a thousand short blends would give a thousand warnings that say the same. The first ten of each kind are
events; the others are counted, and the count is an event at the end of the run. What people, JSON and `run.events` get
is the same.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from elitescript.messages.events import DeviceNoted, Event, Warned

MOST: Final = 10
"""Warnings of one kind in a run."""
_KINDS_MAX: Final = 1000
"""Kinds that are counted; a program that makes more of them has texts of its own."""
_NUMBERS: Final = r"[-+]?\d[\d.]*(?:e[-+]?\d+)?"

_Warning = Warned | DeviceNoted


class WarningLimit:
    """Counts the warnings of a run by kind: by code, or by text without its numbers."""

    __slots__ = ("_counts", "_first")

    def __init__(self) -> None:
        self._counts: dict[tuple[str, str], int] = {}
        self._first: dict[tuple[str, str], _Warning] = {}

    def takes(self, event: Event) -> bool:
        """Return whether an event is to be passed on; one that is not is counted."""
        if not (isinstance(event, Warned) or (isinstance(event, DeviceNoted) and event.is_warning)):
            return True
        kind = _kind(event)
        if kind not in self._counts and len(self._counts) >= _KINDS_MAX:
            return True
        self._first.setdefault(kind, event)
        self._counts[kind] = count = self._counts.get(kind, 0) + 1
        return count <= MOST

    def rest(self, tick: int) -> list[Event]:
        """Return how many of each kind were left out, as warnings; the next run begins with none."""
        told: list[Event] = []
        for kind, count in self._counts.items():
            if count > MOST:
                first = self._first[kind]
                text = f"… {count - MOST:,} more of this kind: {first.text}"
                told.append(replace(first, tick=tick, text=text))
        self._counts.clear()
        self._first.clear()
        return told


def _kind(event: _Warning) -> tuple[str, str]:
    if isinstance(event, DeviceNoted):
        return event.device, re.sub(_NUMBERS, "#", event.text)
    return "", event.code or re.sub(_NUMBERS, "#", event.text)
