"""The end of the time that a command may take."""

from __future__ import annotations

from elitescript.messages.timing import ticks_for
from elitescript.runtime.scheduler import Scheduler


class Deadline:
    """Until when a command waits. A pause of the program puts it off, as it does every wait.

    Args:
        scheduler: of the thread that waits.
        timeout_s: longest time to wait, from now on; 0 and less wait for ever.
    """

    __slots__ = ("_held", "_scheduler", "_tick")

    def __init__(self, scheduler: Scheduler, timeout_s: float) -> None:
        self._scheduler = scheduler
        self._tick = scheduler.now + max(1, ticks_for(timeout_s)) if timeout_s > 0.0 else None
        self._held = scheduler.timers.held_ticks

    @property
    def tick(self) -> int | None:
        """The tick, as far as it is known by now; None for ever."""
        return None if self._tick is None else self._tick + self._scheduler.timers.held_ticks - self._held

    @property
    def is_over(self) -> bool:
        """Whether time is up."""
        tick = self.tick
        return tick is not None and self._scheduler.now >= tick
