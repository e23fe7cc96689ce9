"""Locks a resource that one thread at a time may use."""

from __future__ import annotations

from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.strand import ENDED, Strand


class Turns:
    """A lock that threads get in the order in which they came.

    Args:
        scheduler: runs the threads.
    """

    __slots__ = ("_holder", "_queue", "_scheduler")

    def __init__(self, scheduler: Scheduler) -> None:
        self._scheduler = scheduler
        self._holder: Strand | None = None
        self._queue: list[Strand] = []

    def take(self, reason: str, until: int | None, *, waits: bool | None = None) -> bool:
        """Take the lock, waiting for it; return whether it was taken.

        Args:
            reason: of the wait.
            until: tick of the timeout.
            waits: whether the caller waits; if None, all but secondary programs do.

        Raises:
            Stopped: the thread was stopped.
        """
        strand = self._scheduler.current
        assert strand is not None
        # An abandoned strand never releases it.
        if self._holder is None or self._holder.state is ENDED:
            self._holder = strand
            return True
        if not waits and (waits is not None or strand.is_secondary):
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
        """Release the lock to the next thread."""
        self._holder = self._queue.pop(0) if self._queue else None
        if self._holder is not None:
            self._scheduler.wake(self._holder)
