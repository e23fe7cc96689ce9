"""Inputs that wait for the robot: as much goes in at a tick as the robot can do in one.

What a client asks for keeps its order, and what one read of it has brought goes in together, so that no package of
variables is torn apart. Between clients the queue is fair: when more waits than fits, those that ask for little come
first, and the others take turns. What peers of a program's connections send is not held up; it has windows of its own.
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
    Debug,
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

WORK_NS: Final = 2_000_000
"""Price of the inputs of one tick: half of the tick."""
DEBT_MAX_NS: Final = 100 * WORK_NS
"""What goes in beyond that is paid by the next ticks, this much at most."""
WAITING_MAX: Final = 50_000
"""Inputs that wait; a client that sends more than the robot does is slowed down long before."""
PRICES_NS: Final[dict[type, int]] = {
    RunUnit: 500_000,
    Interpret: 250_000,
    # The robot evaluates about one in a tick.
    Query: 2_000_000,
    PlayTask: 500_000,
    LoadTask: 250_000,
    LoadConfiguration: 250_000,
    SetVariable: 50_000,
    GetVariable: 50_000,
    Debug: 250_000,
}
"""What an input costs the robot, about (*measured*): compiling is dear."""
PRICE_NS: Final = 10_000
"""Of every other input."""
DEAR_NS: Final = 100_000
"""What costs as much goes in by itself; clients that wait with less than this in all come before the others."""
BYTE_PRICE_NS: Final = 50
"""Additional price of each byte of a program."""

CHANNEL_EVENTS: Final = (ChannelOpened, ChannelData, ChannelCredit, ChannelClosed)


def price_ns(inputs: Iterable[Input]) -> int:
    """Return what inputs cost the robot, ns."""
    price = 0
    for item in inputs:
        price += PRICES_NS.get(type(item), PRICE_NS)
        if type(item) is RunUnit:
            price += BYTE_PRICE_NS * len(item.text)
    return price


class InputQueue:
    """Inputs that wait for a tick.

    Args:
        work_ns: price of the inputs of one tick; what has begun to go in is not interrupted.

    Attributes:
        refused: inputs that found no room since this was last set to 0.
    """

    __slots__ = ("_count", "_debt_ns", "_held", "_new", "_work_ns", "refused")

    def __init__(self, work_ns: float = WORK_NS) -> None:
        self._work_ns = work_ns
        self._new: list[list[Input]] = []
        self._debt_ns = 0.0
        self._held: dict[str, deque[list[Input]]] = {}
        """By client; only while more waits than fits into a tick."""
        self._count = 0
        self.refused = 0

    def __len__(self) -> int:
        return self._count

    @property
    def is_settled(self) -> bool:
        """Whether nothing waits, and nothing of earlier ticks is to be paid."""
        return not self._count and not self._debt_ns

    def waiting_of(self, client: str) -> int:
        """Return how many inputs of a client could not go in at the last tick."""
        return sum(map(len, self._held[client])) if client in self._held else 0

    def post(self, inputs: list[Input]) -> None:
        """Take inputs of one client, or of one connection of a program; what does not fit is refused, and counted."""
        if not inputs:
            return
        if self._count + len(inputs) > WAITING_MAX and not isinstance(inputs[0], CHANNEL_EVENTS):
            self.refused += len(inputs)
            return
        self._new.append(inputs)
        self._count += len(inputs)

    def take(self, room: float | None = 1.0) -> list[Input]:
        """Return what goes in at the next tick.

        Args:
            room: share of a tick's work that the robot can do, 0 to 1; None if it can do nothing at all just now.
        """
        new, self._new = self._new, []
        taken: list[Input] = []
        if room == 1.0 and not self._held and not self._debt_ns and sum(map(price_ns, new)) <= self._work_ns:
            for inputs in new:
                taken += inputs
        else:
            for inputs in new:
                if isinstance(inputs[0], CHANNEL_EVENTS):
                    taken += inputs
                else:
                    # Every question of a client has an origin of its own behind the name of the client.
                    self._hold(inputs[0].origin.partition("/")[0], inputs)
            if room is not None:
                self._take_small(taken)
                self._take_in_turns(taken, room)
        self._count -= len(taken)
        return taken

    def _hold(self, client: str, inputs: list[Input]) -> None:
        queue = self._held.setdefault(client, deque())
        together: list[Input] = []
        for item in inputs:
            if price_ns((item,)) < DEAR_NS:
                together.append(item)
                continue
            if together:
                queue.append(together)
                together = []
            queue.append([item])
        if together:
            queue.append(together)

    def _take_small(self, taken: list[Input]) -> None:
        """Take the inputs of clients that ask for little, of which nothing else waits."""
        for client, queue in list(self._held.items()):
            if len(queue) == 1 and price_ns(queue[0]) < DEAR_NS:
                taken += queue[0]
                del self._held[client]

    def _take_in_turns(self, taken: list[Input], room: float) -> None:
        left_ns = self._work_ns * room - self._debt_ns
        while left_ns > 0 and self._held:
            client = next(iter(self._held))
            queue = self._held.pop(client)
            inputs = queue.popleft()
            taken += inputs
            left_ns -= price_ns(inputs)
            if queue:
                self._held[client] = queue
        self._debt_ns = min(max(-left_ns, 0.0), DEBT_MAX_NS)
