"""Whose turn it is to use something that one thread at a time may use."""

from __future__ import annotations

from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import ENDED, Strand


class Turns:
    """Threads that take turns, in the order in which they came.

    Args:
        scheduler: runs the threads.
    """

    __slots__ = ("_holder", "_queue", "_scheduler")

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._holder: Strand | None = None
        self._queue: list[Strand] = []

    def take(self, reason: str, until: int | None) -> bool:
        """Let the calling thread wait for its turn; whether it has come. A secondary program does not wait.

        Args:
            reason: what it waits for.
            until: tick at which it gives up.

        Raises:
            Stopped: the thread was stopped.
        """
        strand = self._scheduler.current
        assert strand is not None
        # One that did not let itself be stopped never gives its turn away.
        if self._holder is None or self._holder.state is ENDED:
            self._holder = strand
            return True
        if strand.is_secondary:
            return False
        self._queue.append(strand)
        try:
            while self._is_waiting(strand):
                if not self._scheduler.wait(reason, until) and self._is_waiting(strand):
                    return False
        except BaseException:
            if not self._is_waiting(strand):
                self.give()
            raise
        finally:
            if self._is_waiting(strand):
                self._queue.remove(strand)
        return True

    def _is_waiting(self, strand: Strand) -> bool:
        return strand in self._queue

    def give(self) -> None:
        """The turn of whoever has it is over."""
        self._holder = self._queue.pop(0) if self._queue else None
        if self._holder is not None:
            self._scheduler.wake(self._holder)
