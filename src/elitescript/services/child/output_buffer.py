"""Outputs of a child on their way to clients: one for each tick, though they do not come in even steps.

While the child keeps up, the output of a tick leaves in that tick. Once it has been late, its outputs leave a tick or
two later, so that the next time nobody notices. When that has not been needed for a second, it is undone.
"""

from __future__ import annotations

from collections import deque
from typing import Final

from elitescript.messages.events import Event
from elitescript.messages.outputs import ChannelRequest, Output, Reply, TickResult
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.timing import TICKS_PER_S

DELAY_MAX_TICKS: Final = 2
"""Outputs that may wait; what comes beyond that is put together."""


class OutputBuffer:
    """Outputs that wait.

    Attributes:
        newest: the last snapshot that has come in.
    """

    __slots__ = ("_events", "_fewest", "_is_flushed", "_requests", "_shown", "_ticks", "_waiting", "newest")

    def __init__(self) -> None:
        self._waiting: deque[Output | TickResult] = deque()
        self._events: list[Event] = []
        self._requests: list[ChannelRequest] = []
        self._shown: Snapshot | None = None
        self._fewest = DELAY_MAX_TICKS
        self._ticks = 0
        self._is_flushed = False
        self.newest: Snapshot | None = None

    @property
    def is_empty(self) -> bool:
        """Whether no output waits: the next tick would have none of its own."""
        return not self._waiting

    def add(self, output: Output | TickResult) -> None:
        """Take an output that has come in, with a snapshot or without."""
        self._waiting.append(output)
        if isinstance(output, Output):
            self.newest = output.snapshot

    def add_own(self, *events: Event, requests: tuple[ChannelRequest, ...] = ()) -> None:
        """Something that the child has not said; it leaves after what waits already, with the next tick."""
        self._events += events
        self._requests += requests

    def flush(self) -> None:
        """Let everything that waits leave with the next tick."""
        self._is_flushed = True

    def take(self, tick: int) -> Output:
        """What leaves in a tick; there must have been an output."""
        count = min(len(self._waiting), 1 + self._surplus())
        taken = [self._waiting.popleft() for _ in range(count)]
        events: list[Event] = []
        requests: list[ChannelRequest] = []
        replies: list[Reply] = []
        for output in taken:
            if isinstance(output, Output):
                self._shown = output.snapshot
            events += output.events
            requests += output.requests
            replies += output.replies
        assert self._shown is not None, "there is no snapshot yet"
        events += self._events
        requests += self._requests
        self._events.clear()
        self._requests.clear()
        return Output(tick, tuple(events), tuple(requests), tuple(replies), self._shown)

    def _surplus(self) -> int:
        """Outputs that need not wait any longer."""
        left = max(len(self._waiting) - 1, 0)
        if self._is_flushed:
            self._is_flushed = False
            return left
        surplus = max(left - DELAY_MAX_TICKS, 0)
        self._fewest = min(self._fewest, left if self._waiting else 0)
        self._ticks += 1
        if self._ticks >= TICKS_PER_S:
            surplus = max(surplus, 1 if self._fewest else 0)
            self._ticks, self._fewest = 0, DELAY_MAX_TICKS
        return surplus
