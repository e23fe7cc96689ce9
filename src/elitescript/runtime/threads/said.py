"""Bounds what programs say: so much in a tick, and so much at once.

A text reaches every client, the log and the journal. A program that says more than they take in a tick waits before it
says the next one, in virtual time, so that a run and a served robot do the same.
"""

from __future__ import annotations

from typing import Final

TEXT_MAX: Final = 1_000_000
"""Most characters of one text (*assumed*); a program that says a longer one gets an alarm."""
TEXT_PER_TICK: Final = 4_000
"""Characters that leave in a tick, 1 MB a second (*assumed*)."""
TEXT_AHEAD: Final = 100_000
"""Most characters that may be waiting to leave while a program goes on: no program prints so much by the line."""


class SaidText:
    """Counts the characters that have been said and have not left."""

    __slots__ = ("_count", "_tick")

    def __init__(self) -> None:
        self._count = self._tick = 0

    def wait_ticks(self, tick: int) -> int:
        """Return for how many ticks from this one on nothing is to be said."""
        count = self._left(tick)
        return 0 if count <= TEXT_AHEAD else -((TEXT_AHEAD - count) // TEXT_PER_TICK)

    def add(self, size: int, tick: int) -> None:
        """Count a text."""
        self._count, self._tick = self._left(tick) + size, tick

    def _left(self, tick: int) -> int:
        return max(self._count - (tick - self._tick) * TEXT_PER_TICK, 0) if self._count else 0
