"""Queues the timeouts of waits, which can be held during a pause."""

from __future__ import annotations

from heapq import heapify, heappop, heappush

from elitescript.runtime.threads.strand import WAITING, Strand

_Timer = tuple[int, int, int, Strand]
"""Tick (or ticks left, while held), sequence number, ticket of the wait, strand."""


class Timers:
    """Timeouts of strands, earliest first; equal ones in the order in which they were set.

    A timeout whose strand has gone on is stale: its ticket differs from the strand's. Stale ones are dropped when they
    are due.

    Attributes:
        held_ticks: sum of the times from each `hold` to its `release`.
    """

    __slots__ = ("_held", "_hold_tick", "_queue", "_sequence", "held_ticks")

    def __init__(self) -> None:
        self.held_ticks = 0
        self._hold_tick = 0
        self._queue: list[_Timer] = []
        self._held: list[_Timer] = []
        self._sequence = 0

    def set(self, strand: Strand, until: int) -> None:
        """Let the present wait of a strand end at a tick."""
        self._sequence += 1
        heappush(self._queue, (until, self._sequence, strand.ticket, strand))

    def set_held(self, strand: Strand, ticks_left: int) -> None:
        """Let the present wait of a strand end `ticks_left` after `release`."""
        self._sequence += 1
        self._held.append((max(0, ticks_left), self._sequence, strand.ticket, strand))

    def due(self, tick: int) -> list[Strand]:
        """Remove the timeouts that are due at a tick; return their strands, in order."""
        queue = self._queue
        found = []
        while queue and queue[0][0] <= tick:
            _, _, ticket, strand = heappop(queue)
            if strand.ticket == ticket and strand.state is WAITING:
                found.append(strand)
        return found

    def next_tick(self) -> int | None:
        """Return the earliest tick at which a wait ends; None if there is none."""
        queue = self._queue
        while queue:
            if _is_live(queue[0]):
                return queue[0][0]
            heappop(queue)
        return None

    def hold(self, now: int) -> None:
        """Hold the waits of all strands but secondary programs; the rest of each is kept."""
        live = [timer for timer in self._queue if _is_live(timer)]
        self._held += [
            (max(0, until - now), sequence, ticket, strand)
            for until, sequence, ticket, strand in live
            if not strand.is_secondary
        ]
        self._hold_tick = now
        self._queue = [timer for timer in live if timer[3].is_secondary]
        heapify(self._queue)

    def release(self, now: int) -> None:
        """Let the held waits go on."""
        self.held_ticks += now - self._hold_tick
        for ticks_left, sequence, ticket, strand in self._held:
            if strand.ticket == ticket and strand.state is WAITING:
                strand.until = now + ticks_left
                heappush(self._queue, (now + ticks_left, sequence, ticket, strand))
        self._held.clear()

    def forget_held(self) -> None:
        """Drop the held waits: their strands have ended."""
        self._held.clear()


def _is_live(timer: _Timer) -> bool:
    _, _, ticket, strand = timer
    return strand.ticket == ticket and strand.state is WAITING
