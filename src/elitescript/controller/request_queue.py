"""Queues requests from outside by tick.

They take effect at tick boundaries, so a run is a function of its program and of this queue.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from typing import Final

from elitescript.controller.refusals import refusal_text
from elitescript.errors import ScriptError, UsageError
from elitescript.messages.events import Warned
from elitescript.messages.machine import MachineRequest, WriteSignal

CAPACITY: Final = 1_000_000
"""Most entries that may wait; a full queue raises `UsageError`."""


class RequestQueue:
    """Requests that wait for their tick."""

    __slots__ = ("_heap", "_sequence")

    def __init__(self) -> None:
        self._heap: list[tuple[int, int, str, MachineRequest]] = []
        self._sequence = 0

    def put(self, tick: int, request: MachineRequest, by: str = "client") -> None:
        """Queue a request for `tick`, after those for the same tick that were put before it.

        Args:
            tick: at which it is carried out.
            request: the request.
            by: its origin, as `events.SignalChanged.by`.

        Raises:
            UsageError: the queue is full.
        """
        if len(self._heap) >= CAPACITY:
            raise UsageError(f"the controller's inbox is full: {CAPACITY} requests wait already")
        self._sequence += 1
        heappush(self._heap, (tick, self._sequence, by, request))

    def deliver(
        self, tick: int, handle: Callable[[MachineRequest, str], None], refuse: Callable[[Warned], None]
    ) -> None:
        """Hand over the requests due at `tick`, each with its origin; a refusal becomes a warning."""
        while self._heap and self._heap[0][0] <= tick:
            _, _, by, request = heappop(self._heap)
            try:
                handle(request, by)
            except ScriptError as error:
                refuse(Warned(tick, refusal_text(request, error)))

    def next_write(self, family: str, index: int) -> int | None:
        """Return the earliest tick at which a point of the signal image is set; None if none is."""
        waiting = (
            tick
            for tick, _, _, request in self._heap
            if isinstance(request, WriteSignal) and (request.name, request.index) == (family, index)
        )
        return min(waiting, default=None)

    @property
    def next_tick(self) -> int | None:
        """Tick of the earliest entry."""
        return self._heap[0][0] if self._heap else None
