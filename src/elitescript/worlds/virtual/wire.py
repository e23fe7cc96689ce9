"""One direction of a virtual connection: bytes that are on their way."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import Final

from elitescript.messages.timing import TICKS_PER_S, ticks_for
from elitescript.worlds.virtual.agenda import Agenda

_ROUNDING: Final = 1e-6
"""A byte that is there so few ticks after a tick is there in it: that is rounding, not time."""


class Wire:
    """Bytes that take their time.

    Args:
        agenda: of the world.
        deliver: called with the bytes that arrive together.
        byte_s: time that each byte takes, one after the other; fractions of a tick are carried over to the next byte.
        latency_s: time that all of them take besides.
        chunk: most bytes that arrive in one tick; 0 for any number.
        delay: ticks that one call's bytes take besides, drawn for each call.

    Attributes:
        owner: whose code `deliver` is.
    """

    __slots__ = (
        "_agenda",
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
        "owner",
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
        self._queue = bytearray()
        self._is_due = False
        self._then: Callable[[], None] | None = None
        self.owner = owner

    @property
    def waiting(self) -> int:
        """Bytes that have not begun to arrive."""
        return len(self._queue)

    def send(self, data: bytes) -> None:
        """Put bytes on the way."""
        now = self._agenda.tick
        ticks = self._ticks + (self._delay() if self._delay else 0)
        if not self._byte_ticks and not self._chunk:
            self._last = max(now + ticks, self._last)  # nothing overtakes
            self._agenda.put(self._last - now, lambda: self._deliver(data), self.owner)
            return
        self._queue += data
        if not self._is_due and self._queue:
            self._free = max(self._free, now + (ticks - 1 if self._byte_ticks else ticks))
            self._plan()

    def finish(self, then: Callable[[], None]) -> None:
        """Have something called when all that was sent has arrived, not sooner than bytes that are sent now would."""
        if self._is_due:
            self._then = then
            return
        now = self._agenda.tick
        self._last = max(now + self._ticks, self._last)
        self._agenda.put(self._last - now, then, self.owner)

    # ---------------------------------------------------------------- one byte after the other

    def _plan(self) -> None:
        """See to it that the next bytes are delivered."""
        now = self._agenda.tick
        self._is_due = True
        at = max(ceil(self._free + self._byte_ticks - _ROUNDING), now + 1)
        self._agenda.put(at - now, self._arrive, self.owner)

    def _arrive(self) -> None:
        self._is_due = False
        size = len(self._queue)
        if self._byte_ticks:
            size = min(size, int((self._agenda.tick - self._free) / self._byte_ticks + _ROUNDING))
        if self._chunk:
            size = min(size, self._chunk)
        self._free += size * self._byte_ticks
        data = bytes(self._queue[:size])
        del self._queue[:size]
        if self._queue:
            self._plan()
        if data:
            self._deliver(data)
        if not self._queue and self._then is not None:
            then, self._then = self._then, None
            then()
