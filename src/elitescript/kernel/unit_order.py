"""Keeps units of clients in their order, so that each that begins has its share of a tick before another replaces it.

Lines and programs replace the program that runs. Of two that begin in one tick the first would never run a statement.
*Assumed*, since the manual is silent: a unit that has begun runs to its first wait or to the end of its share of the
tick, whichever comes first, before the next one takes its place. So one begins in a tick, and what else a client has
sent behind a unit waits behind it; what other clients ask of the machine, a stop above all, does not.
"""

from __future__ import annotations

from collections import deque
from typing import Final

from elitescript.language.options import SECONDARY
from elitescript.messages.inputs import Do, RunUnit

WAITING_MAX: Final = 1000
"""Inputs that may wait."""
WAITING_CHARACTERS_MAX: Final = 32 * 1024 * 1024
"""Limit of the texts that wait."""


class UnitOrder:
    """What waits for the share of a unit that has begun."""

    __slots__ = ("_begun_tick", "_characters", "_origin", "_waiting")

    def __init__(self) -> None:
        self._begun_tick = -1
        self._origin = ""
        self._waiting: deque[RunUnit | Do] = deque()
        self._characters = 0

    @property
    def is_waiting(self) -> bool:
        """Whether something waits for the next tick."""
        return bool(self._waiting)

    def begins(self, item: RunUnit, tick: int) -> None:
        """Note that a unit begins in a tick."""
        self._begun_tick, self._origin = tick, item.origin

    def must_wait(self, item: RunUnit | Do, tick: int) -> bool:
        """Return whether an input of a client waits for another tick.

        What replaces a program waits for everything that replaces one and has come before; a secondary program and a
        request only for what their own client has sent before.
        """
        if self._is_held(item, tick):
            return True
        if _replaces(item):
            return any(map(_replaces, self._waiting))
        return any(item.origin == other.origin for other in self._waiting)

    def put(self, item: RunUnit | Do) -> bool:
        """Let an input wait; return whether there is room for it."""
        size = len(item.text) if isinstance(item, RunUnit) else 0
        if len(self._waiting) >= WAITING_MAX or self._characters + size > WAITING_CHARACTERS_MAX:
            return False
        self._waiting.append(item)
        self._characters += size
        return True

    def take(self, tick: int) -> RunUnit | Do | None:
        """Return the next input that waits no longer; None if there is none in this tick."""
        if not self._waiting:
            return None
        item = self._waiting[0]
        if self._is_held(item, tick):
            return None
        self._waiting.popleft()
        self._characters -= len(item.text) if isinstance(item, RunUnit) else 0
        return item

    def clear(self) -> list[RunUnit]:
        """Drop everything that waits; return the units."""
        units = [item for item in self._waiting if isinstance(item, RunUnit)]
        self._waiting.clear()
        self._characters = 0
        return units

    def _is_held(self, item: RunUnit | Do, tick: int) -> bool:
        """Return whether the unit that has begun in this tick holds an input up."""
        if self._begun_tick != tick:
            return False
        return _replaces(item) or (isinstance(item, Do) and item.origin == self._origin)


def _replaces(item: RunUnit | Do) -> bool:
    return isinstance(item, RunUnit) and item.kind != SECONDARY
