"""Runs secondary programs (`sec`) beside the program, one after the other."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final, Generic, TypeVar

from elitescript.errors import ScriptStateError
from elitescript.messages.timing import TICKS_PER_S, seconds
from elitescript.runtime.program import Program
from elitescript.runtime.threads.scheduler import DEBUGGER, Scheduler
from elitescript.runtime.threads.strand import Strand
from elitescript.said import said

LIMIT_TICKS: Final = TICKS_PER_S
"""Virtual time that a secondary program may take (*assumed*: the manual says not to run it for long)."""

QUEUE_MAX: Final = 64
"""Secondary programs that may wait."""

Item = TypeVar("Item")


class Secondaries(Generic[Item]):
    """Runs secondary programs, or queries, beside the program of a host, one after the other.

    Args:
        scheduler: runs them.
        begin: starts one; returns its strand, and the program that was made for it alone, if no program runs.
        warn: reports an error of one.
        limit_ticks: longest virtual time of one.
        queue_max: most that wait.
    """

    __slots__ = (
        "_begin",
        "_deadline",
        "_limit_ticks",
        "_own_program",
        "_queue",
        "_queue_max",
        "_scheduler",
        "_strand",
        "_warn",
    )

    def __init__(
        self,
        scheduler: Scheduler,
        begin: Callable[[Item], tuple[Strand, Program | None]],
        warn: Callable[[str, Strand], None],
        *,
        limit_ticks: int = LIMIT_TICKS,
        queue_max: int = QUEUE_MAX,
    ) -> None:
        self._scheduler = scheduler
        self._begin = begin
        self._warn = warn
        self._limit_ticks = limit_ticks
        self._queue_max = queue_max
        self._queue: deque[Item] = deque()
        self._strand: Strand | None = None
        self._own_program: Program | None = None
        self._deadline = 0

    @property
    def is_idle(self) -> bool:
        """Whether none runs and none waits."""
        return self._strand is None and not self._queue

    def put(self, item: Item) -> None:
        """Queue one.

        Raises:
            ScriptStateError: too many wait.
        """
        if len(self._queue) >= self._queue_max:
            raise ScriptStateError(said("{count} secondary programs wait already", count=self._queue_max))
        self._queue.append(item)

    def next_tick(self, tick: int) -> int | None:
        """Return the earliest tick after `tick` at which one begins or has run too long."""
        if self._strand is None:
            return tick + 1 if self._queue else None
        if self._strand.waits_for == DEBUGGER:
            return None
        return max(self._deadline, tick + 1)

    def settle(self) -> bool:
        """End the one that has run too long, begin the next one; return whether anything was done."""
        has_changed = False
        strand = self._strand
        if strand is not None and self._scheduler.now >= self._deadline and strand.waits_for != DEBUGGER:
            self._warn(
                said("TimeoutError: stopped after {seconds:g} s, it must be short", seconds=seconds(self._limit_ticks)),
                strand,
            )
            self._scheduler.kill(strand)
            has_changed = True
        if self._strand is None and self._queue:
            self._strand, self._own_program = self._begin(self._queue.popleft())
            self._set_deadline(self._scheduler.now + self._limit_ticks)
            has_changed = True
        return has_changed

    def prolong(self, ticks: int) -> None:
        """Let the one that runs take so much longer."""
        self._set_deadline(self._deadline + ticks)

    def _set_deadline(self, tick: int) -> None:
        self._deadline = tick
        if self._strand is not None:
            self._strand.until_tick = tick

    def ended(self, strand: Strand) -> None:
        """Note the end of a strand; after the running one the next can begin."""
        if strand is self._strand:
            self._strand = None
            if self._own_program is not None:
                self._own_program.close()
                self._own_program = None
            self._scheduler.call_attention()
