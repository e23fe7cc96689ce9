"""Deadlines of commands that wait for events from outside."""

from __future__ import annotations

from elitescript.messages.timing import ticks_for
from elitescript.runtime.threads.scheduler import Scheduler


class Deadline:
    """The end of a wait for an event from outside. A pause of the program extends it, as every wait.

    It is not over earlier by the wall clock than by robot time: while robot time catches up, only the lag of the
    beginning counts, because everything that arrived in the missed ticks arrived at once.

    Args:
        scheduler: of the thread that waits.
        timeout_s: longest time to wait, from now on; 0 and less wait for ever.
    """

    __slots__ = ("_held", "_lag", "_scheduler", "_tick")

    def __init__(self, scheduler: Scheduler, timeout_s: float) -> None:
        self._scheduler = scheduler
        self._tick = scheduler.now + max(1, ticks_for(timeout_s)) if timeout_s > 0.0 else None
        self._held = scheduler.timers.held_ticks
        self._lag = scheduler.lag_ticks

    @property
    def tick(self) -> int | None:
        """The tick, as known now; None for ever."""
        if self._tick is None:
            return None
        scheduler = self._scheduler
        return self._tick + scheduler.timers.held_ticks - self._held + max(0, self._lag - scheduler.lag_ticks)

    @property
    def is_over(self) -> bool:
        """Whether time is up."""
        tick = self.tick
        return tick is not None and self._scheduler.now >= tick
