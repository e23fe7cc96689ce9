"""What a robot in a child is told next: inputs in their order, as many in a tick as it can do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from elitescript.messages.inputs import ChannelClosed, Input
from elitescript.messages.outputs import ChannelRequest, CloseChannel, OpenChannel, OpenLine
from elitescript.services.clients.input_queue import CHANNEL_EVENTS, WORK_NS, price_ns

HELD_MAX: Final = 50_000
"""Inputs of clients that wait while there is no child; more are refused. Who looks at `room` never gets there."""
PORTION_NS: Final = 10 * WORK_NS
"""Price of what a child gets in a tick; more than an inbox gives, so that only what has piled up is spread."""
BEHIND_TICKS: Final = 3
"""Ticks behind which no output is waited for."""
BUSY_TICKS: Final = 10
"""Ticks behind which a child gets hardly anything that is much work until it has caught up."""
ROOM_MIN: Final = 0.05
"""Share of a tick's work for clients that is left then: one that never catches up can be given another program."""


def room_for(late_ticks: int) -> float:
    """Share of a tick's work for clients that a child can do, 0 to 1: less, the more ticks it is behind."""
    return 1.0 if late_ticks <= BEHIND_TICKS else max(ROOM_MIN, 1.0 - late_ticks / BUSY_TICKS)


class PendingInputs:
    """Inputs on their way to a child, which may be replaced; nothing of its connections goes to the next one."""

    __slots__ = ("_channels", "_inputs", "_refused")

    def __init__(self) -> None:
        self._inputs: list[Input] = []
        self._channels: set[int] = set()
        self._refused = 0

    def __len__(self) -> int:
        return len(self._inputs)

    def add(self, inputs: Sequence[Input]) -> None:
        """Take inputs; what comes of connections that the child does not have is left out."""
        for item in inputs:
            if isinstance(item, CHANNEL_EVENTS):
                if item.channel not in self._channels:
                    continue
                if isinstance(item, ChannelClosed):
                    self._channels.discard(item.channel)
            elif len(self._inputs) >= HELD_MAX:
                self._refused += 1
                continue
            self._inputs.append(item)

    def put_first(self, inputs: Iterable[Input]) -> None:
        """These come before all that wait, apart from those of connections."""
        self._inputs[:0] = [item for item in inputs if not isinstance(item, CHANNEL_EVENTS)]

    def portion(self) -> list[Input]:
        """As much of what waits as a child can do in a tick."""
        if price_ns(self._inputs) <= PORTION_NS:
            portion, self._inputs = self._inputs, []
            return portion
        price, count = 0, 0
        while count < len(self._inputs) and price < PORTION_NS:
            price += price_ns((self._inputs[count],))
            count += 1
        portion = self._inputs[:count]
        del self._inputs[:count]
        return portion

    def take_refused(self) -> int:
        """How many inputs found no room since the last call."""
        refused, self._refused = self._refused, 0
        return refused

    def note(self, requests: Iterable[ChannelRequest]) -> None:
        """The child opens and closes connections."""
        for request in requests:
            if isinstance(request, OpenChannel | OpenLine):
                self._channels.add(request.channel)
            elif isinstance(request, CloseChannel):
                self._channels.discard(request.channel)

    def end_connections(self) -> tuple[ChannelRequest, ...]:
        """The child is gone; what closes its connections."""
        requests = tuple(CloseChannel(channel) for channel in sorted(self._channels))
        self._channels.clear()
        self._inputs = [item for item in self._inputs if not isinstance(item, CHANNEL_EVENTS)]
        return requests
