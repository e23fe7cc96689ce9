"""One direction of a virtual connection: bytes that are on their way."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from math import ceil
from typing import Final

from elitescript.devices.agenda import Agenda
from elitescript.messages.timing import TICKS_PER_S, ticks_for

_ROUNDING: Final = 1e-6
"""A byte that is there so few ticks after a tick is there in it: that is rounding, not time."""


class DelayLine:
    """Bytes that take their time.

    Args:
        agenda: of the world.
        deliver: called with the bytes that arrive together.
        byte_s: time that each byte takes, one after the other; fractions of a tick are carried over to the next byte.
        latency_s: time that all of them take besides.
        chunk: most bytes that arrive in one tick; 0 for any number.
        delay: ticks that one call's bytes take besides, drawn for each call.

    Attributes:
        owner: device that `deliver` belongs to.
        under_way: bytes that were sent and have not arrived.
        is_ending: whether `finish` was called and its call has not come.
    """

    __slots__ = (
        "_agenda",
        "_batch",
        "_byte_ticks",
        "_chunk",
        "_delay",
        "_deliver",
        "_free",
        "_is_due",
        "_last",
        "_queue",
        "_then",
        "_ticks",
        "is_ending",
        "owner",
        "under_way",
    )

    def __init__(
        self,
        agenda: Agenda,
        deliver: Callable[[bytes], None],
        *,
        byte_s: float = 0.0,
        latency_s: float = 0.0,
        chunk: int = 0,
        delay: Callable[[], int] | None = None,
        owner: object = None,
    ) -> None:
        self._agenda = agenda
        self._deliver = deliver
        self._byte_ticks = byte_s * TICKS_PER_S
        self._ticks = max(1, ticks_for(latency_s))
        self._chunk = chunk
        self._delay = delay
        self._free = 0.0
        """When the last byte that has arrived was through, in ticks; from then on the next one is under way."""
        self._last = 0
        self._queue: deque[tuple[float, bytearray]] = deque()
        """For each call, when its first byte is under way at the earliest, in ticks, and what has not arrived of it."""
        self._is_due = False
        self._then: Callable[[], None] | None = None
        self._batch = 0
        """Counts what was dropped: bytes of an earlier batch do not arrive any more."""
        self.owner = owner
        self.under_way = 0
        self.is_ending = False

    @property
    def waiting(self) -> int:
        """Bytes that have not begun to arrive."""
        return sum(len(rest) for _, rest in self._queue)

    def send(self, data: bytes) -> None:
        """Put bytes on the way."""
        now = self._agenda.tick
        ticks = self._ticks + (self._delay() if self._delay else 0)
        self.under_way += len(data)
        if not self._byte_ticks and not self._chunk:
            self._last = max(now + ticks, self._last)  # nothing overtakes
            batch = self._batch
            self._agenda.put(self._last - now, lambda: self._hand(data, batch), self.owner)
            return
        if data:
            self._queue.append((now + (ticks - 1 if self._byte_ticks else ticks), bytearray(data)))
            if not self._is_due:
                self._plan()

    def finish(self, then: Callable[[], None]) -> None:
        """Have something called when all that was sent has arrived, not sooner than bytes that are sent now would."""
        self.is_ending = True
        self._then = then
        if self._is_due:
            return
        now, batch = self._agenda.tick, self._batch
        self._last = max(now + self._ticks, self._last)
        self._agenda.put(self._last - now, lambda: self._end(batch), self.owner)

    def drop(self) -> int:
        """Forget what is under way, the call of `finish` too; return how many bytes that were."""
        dropped, self.under_way = self.under_way, 0
        self._batch += 1
        self._queue.clear()
        self.is_ending, self._then = False, None
        return dropped

    def _hand(self, data: bytes, batch: int) -> None:
        if batch == self._batch:
            self.under_way -= len(data)
            self._deliver(data)

    def _end(self, batch: int) -> None:
        if batch == self._batch and self._then is not None:
            then, self._then = self._then, None
            self.is_ending = False
            then()

    # ---------------------------------------------------------------- one byte after the other

    def _plan(self) -> None:
        """See to it that the next bytes are delivered."""
        now = self._agenda.tick
        self._is_due = True
        self._free = max(self._free, self._queue[0][0])
        at = max(ceil(self._free + self._byte_ticks - _ROUNDING), now + 1)
        self._agenda.put(at - now, self._arrive, self.owner)

    def _arrive(self) -> None:
        self._is_due = False
        data = self._arrived()
        if self._queue:
            self._plan()
        if data:
            self._hand(data, self._batch)
        if not self._queue:
            self._end(self._batch)

    def _arrived(self) -> bytes:
        """Take out of the queue what has arrived by now."""
        data = bytearray()
        while self._queue:
            begin, rest = self._queue[0]
            self._free = max(self._free, begin)
            size = self._through(len(rest), len(data))
            self._free += size * self._byte_ticks
            data += rest[:size]
            del rest[:size]
            if rest:
                break
            self._queue.popleft()
        return bytes(data)

    def _through(self, size: int, before: int) -> int:
        """Return how many of `size` bytes are through by now, after `before` bytes earlier in this tick."""
        passed = self._agenda.tick - self._free
        if self._byte_ticks:
            size = min(size, int(passed / self._byte_ticks + _ROUNDING))
        elif passed < 0:
            size = 0
        if self._chunk:
            size = min(size, self._chunk - before)
        return max(0, size)
