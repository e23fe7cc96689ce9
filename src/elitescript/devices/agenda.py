"""What is to happen at which tick in the surroundings of a robot.

Everything that a device does happens in a call of the agenda, in the order of ticks and, within a tick, in the order in
which it was put there. So two runs are the same, and time may leap to the next entry.
"""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from typing import Any, Final

from elitescript.errors import ElitescriptError
from elitescript.messages.timing import seconds
from elitescript.said import said

CAPACITY: Final = 200_000
"""Most entries that may wait."""

Act = Callable[[], Any]


class DeviceError(ElitescriptError):
    """The code of a device failed; the text names the device, file and line, and what was raised there."""


class Agenda:
    """Calls by tick.

    Attributes:
        clock: gives the present tick; it may be beyond the last tick that was run.
        on_failure: called with the owner of a call that raised, and the exception. As long as it is None, what was
            raised goes on to the caller of `run`.
    """

    __slots__ = ("_due", "_sequence", "_tick", "clock", "on_failure")

    def __init__(self) -> None:
        self._tick = 0
        self.clock: Callable[[], int] | None = None
        self.on_failure: Callable[[object, Exception], None] | None = None
        self._sequence = 0
        self._due: list[tuple[int, int, Act, object]] = []

    @property
    def tick(self) -> int:
        """The present tick."""
        return self._tick if self.clock is None else max(self._tick, self.clock())

    @property
    def time_s(self) -> float:
        """Time of the tick."""
        return seconds(self.tick)

    def put(self, after_ticks: int, act: Act, owner: object = None) -> None:
        """Make a call after so many ticks; 0 is this tick, or the next one if this one has run already.

        Args:
            after_ticks: counted from the present tick.
            act: the call.
            owner: device that the call belongs to.

        Raises:
            DeviceError: too much waits already.
        """
        if len(self._due) >= CAPACITY:
            raise DeviceError(
                said(
                    "{capacity} things wait to happen in the virtual world, and one more was asked for",
                    capacity=CAPACITY,
                )
            )
        self._sequence += 1
        heappush(self._due, (self.tick + after_ticks, self._sequence, act, owner))

    def run(self, tick: int) -> None:
        """Make every call that is due up to a tick."""
        self._tick = max(tick, self._tick)
        while self._due and self._due[0][0] <= tick:
            _, _, act, owner = heappop(self._due)
            self.attempt(act, owner)

    def attempt(self, act: Act, owner: object) -> None:
        """Make one call, unless its owner has failed before; what it raises goes to `on_failure`."""
        if getattr(owner, "is_gone", False):
            return
        if self.on_failure is None:
            act()
            return
        try:
            act()
        except Exception as error:
            self.on_failure(owner, error)

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` at which a call is due."""
        return max(self._due[0][0], tick + 1) if self._due else None
