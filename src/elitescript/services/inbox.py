"""What waits for the robot: as much of it goes in at a tick as the robot can do in one.

What a client asks for keeps its order. Between clients the inbox is fair: when more waits than fits, each client in
turn gets one thing done. What peers of a program's connections send is not held up; it has windows of its own.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import Final

from elitescript.messages.inputs import (
    ChannelClosed,
    ChannelCredit,
    ChannelData,
    ChannelOpened,
    GetVariable,
    Input,
    Interpret,
    LoadConfiguration,
    LoadTask,
    PlayTask,
    Query,
    RunUnit,
    SetVariable,
)

WORK_NS: Final = 4_000_000
"""Price of the inputs of one tick."""
WAITING_MAX: Final = 50_000
"""Inputs that wait; who sends more than the robot does is slowed down long before."""
PRICES_NS: Final[dict[type, int]] = {
    RunUnit: 500_000,
    Interpret: 100_000,
    Query: 100_000,
    PlayTask: 500_000,
    LoadTask: 250_000,
    LoadConfiguration: 250_000,
    SetVariable: 50_000,
    GetVariable: 50_000,
}
"""What an input costs the robot, about (*measured*): compiling is dear."""
PRICE_NS: Final = 10_000
"""Of every other input."""
BYTE_PRICE_NS: Final = 50
"""Of every byte of a program, besides."""

_CHANNEL_EVENTS: Final = (ChannelOpened, ChannelData, ChannelCredit, ChannelClosed)


def price_ns(inputs: Iterable[Input]) -> int:
    """What inputs cost the robot."""
    price = 0
    for item in inputs:
        price += PRICES_NS.get(type(item), PRICE_NS)
        if type(item) is RunUnit:
            price += BYTE_PRICE_NS * len(item.text)
    return price


class Inbox:
    """Inputs that wait for a tick.

    Attributes:
        refused: inputs that found no room since the last time anybody asked.
    """

    __slots__ = ("_held", "_new", "_waiting", "refused")

    def __init__(self) -> None:
        self._new: list[Input] = []
        self._held: dict[str, deque[Input]] = {}
        """By client; only while more waits than fits into a tick."""
        self._waiting = 0
        self.refused = 0

    def __len__(self) -> int:
        return len(self._new) + self._waiting

    def waiting_of(self, client: str) -> int:
        """How much of a client could not go in at the last tick."""
        return len(self._held.get(client, ()))

    def post(self, inputs: list[Input]) -> None:
        """Take inputs; what does not fit is refused, and counted."""
        room = WAITING_MAX - len(self)
        if len(inputs) > room:
            kept = [item for item in inputs if isinstance(item, _CHANNEL_EVENTS)]
            others = [item for item in inputs if not isinstance(item, _CHANNEL_EVENTS)]
            self.refused += max(len(others) - max(room, 0), 0)
            inputs = kept + others[: max(room, 0)]
        self._new += inputs

    def take(self, *, is_ready: bool = True) -> list[Input]:
        """What goes in at the next tick.

        Args:
            is_ready: whether the robot can do anything for clients just now.
        """
        new, self._new = self._new, []
        if is_ready and not self._waiting and price_ns(new) <= WORK_NS:
            return new
        taken: list[Input] = []
        for item in new:
            if isinstance(item, _CHANNEL_EVENTS):
                taken.append(item)
            else:
                # Every question of a client has an origin of its own behind the name of the client.
                self._held.setdefault(item.origin.partition("/")[0], deque()).append(item)
                self._waiting += 1
        left_ns = WORK_NS if is_ready else 0
        while left_ns > 0 and self._held:
            client = next(iter(self._held))
            queue = self._held.pop(client)
            item = queue.popleft()
            taken.append(item)
            self._waiting -= 1
            left_ns -= price_ns((item,))
            if queue:
                self._held[client] = queue
        return taken
