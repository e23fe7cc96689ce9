"""The end of a run: whether all that a program gave away has arrived, and for how long to wait for it."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Final

from elitescript.messages.timing import ticks_for

if TYPE_CHECKING:
    from elitescript.devices.surroundings import Surroundings
    from elitescript.runtime.connections.background import Background
    from elitescript.runtime.environment import Channels

DRAIN_S: Final = 2.0
"""What has not moved for so long is given up (*assumed*): as long as an attempt to connect may take."""

DRAIN_MAX_S: Final = 60.0
"""All of it may take so long at most, however steadily it moves (*assumed*)."""

REACTION_TICKS: Final = 10
"""How long devices may act in every tick, once they have everything, before the run ends nevertheless (*assumed*)."""


Ask = Callable[[Collection[int]], tuple[str, ...]]


def _nothing(_ignoring: Collection[int]) -> tuple[str, ...]:
    return ()


class Drain:
    """Watches bytes and requests of a program that is over, tick by tick.

    Args:
        tick: the one in which program and arm came to rest.
        channels: carry the bytes.
        background: holds MODBUS requests, and bytes that wait for room.
        surroundings: devices that may react; None without any.
        drain_s: how long to wait for what does not move.
    """

    __slots__ = (
        "_background",
        "_begin_tick",
        "_busy_tick",
        "_drain_ticks",
        "_give_up_channels",
        "_moved_tick",
        "_pending",
        "_pending_channels",
        "_surroundings",
    )

    def __init__(
        self,
        tick: int,
        channels: Channels,
        background: Background,
        surroundings: Surroundings | None,
        drain_s: float,
    ) -> None:
        # A network that a caller of the library has made need not report what is under way.
        self._pending_channels: Ask = getattr(channels, "pending", _nothing)
        self._give_up_channels: Ask = getattr(channels, "give_up", _nothing)
        self._background = background
        self._surroundings = surroundings
        self._drain_ticks = ticks_for(drain_s)
        self._pending: tuple[str, ...] = ()
        self._begin_tick = self._moved_tick = self._busy_tick = tick

    @property
    def end_tick(self) -> int:
        """The tick in which `is_over` must be asked at the latest."""
        return min(self._moved_tick + self._drain_ticks, self._begin_tick + ticks_for(DRAIN_MAX_S))

    def is_over(self, tick: int) -> bool:
        """Return whether everything has arrived and no device is due in the next tick, or the time is up.

        Args:
            tick: the one that has run.
        """
        if self._pending:
            # Nothing changes in ticks that are leapt over: what was under way then, was so until now.
            self._busy_tick = max(self._busy_tick, tick - 1)
        pending = (*self._pending_channels(self._background.channels), *self._background.pending())
        if pending != self._pending:
            # The texts hold how many bytes there are: another text is progress.
            self._pending, self._moved_tick = pending, tick
        if pending:
            self._busy_tick = tick
            return tick >= self.end_tick
        if self._surroundings is None or tick - self._busy_tick >= REACTION_TICKS:
            return True
        return self._surroundings.next_tick(tick) != tick + 1

    def give_up(self) -> tuple[str, ...]:
        """Forget what has not arrived; return it in words."""
        return (*self._give_up_channels(self._background.channels), *self._background.give_up())
