"""Buffers between a server and a child that is late, or not there: inputs on their way down, outputs on their way up.

Inputs keep their order; as many go down in a tick as the child can do. Outputs leave one for each tick, though they
come in uneven steps: while the child keeps up, the output of a tick leaves in that tick; once it has been late, its
outputs leave a tick or two later, so that the next time does not show. When that has not been needed for a second, it
is undone. Each output is a row for clients once, whenever it leaves (`Output.rows`). While there is none for long,
streams repeat the last one (`Output.repeats`).
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from typing import Final

from elitescript.messages.events import Event
from elitescript.messages.inputs import ChannelClosed, Input
from elitescript.messages.outputs import (
    REPEAT_AFTER_S,
    ChannelRequest,
    CloseChannel,
    OpenChannel,
    OpenLine,
    Output,
    TickResult,
)
from elitescript.messages.snapshot import Snapshot
from elitescript.messages.timing import TICKS_PER_S, ticks_for
from elitescript.services.clients.input_queue import CHANNEL_EVENTS, WORK_NS, price_ns

WAITING_MAX: Final = 50_000
"""Inputs of clients that wait while there is no child; more are refused. A caller that heeds `room` stays below."""
PORTION_NS: Final = 10 * WORK_NS
"""Price of what a child gets in a tick; more than an input queue gives, so that only what has piled up is spread."""
BEHIND_TICKS: Final = 3
"""Ticks behind which no output is waited for."""
BUSY_TICKS: Final = 10
"""Ticks behind which a child gets hardly anything that is much work until it has caught up."""
ROOM_MIN: Final = 0.05
"""Share of a tick's work for clients that is left then, so that a child that never catches up can be given another
program."""
DELAY_MAX_TICKS: Final = 2
"""Outputs that may wait; what comes beyond that leaves together."""
REPEAT_AFTER_TICKS: Final = ticks_for(REPEAT_AFTER_S)


def room_for(late_ticks: int) -> float:
    """Return the share of a tick's work for clients that a child can do, 0 to 1: less, the more ticks it is behind."""
    return 1.0 if late_ticks <= BEHIND_TICKS else max(ROOM_MIN, 1.0 - late_ticks / BUSY_TICKS)


class PendingInputs:
    """Keeps inputs for a child, which may be replaced; nothing of its connections goes to the next one."""

    __slots__ = ("_channels", "_inputs", "_refused")

    def __init__(self) -> None:
        self._inputs: list[Input] = []
        self._channels: set[int] = set()
        self._refused = 0

    def __len__(self) -> int:
        return len(self._inputs)

    def __iter__(self) -> Iterator[Input]:
        return iter(self._inputs)

    @property
    def is_full(self) -> bool:
        """Whether more waits than goes down in a tick."""
        return bool(self._inputs) and price_ns(self._inputs) >= PORTION_NS

    def add(self, inputs: Sequence[Input]) -> None:
        """Take inputs; what comes of connections that the child does not have is left out."""
        for item in inputs:
            if isinstance(item, CHANNEL_EVENTS):
                if item.channel not in self._channels:
                    continue
                if isinstance(item, ChannelClosed):
                    self._channels.discard(item.channel)
            elif len(self._inputs) >= WAITING_MAX:
                self._refused += 1
                continue
            self._inputs.append(item)

    def put_first(self, inputs: Iterable[Input]) -> None:
        """Take inputs that come before all that wait; those of connections are left out."""
        self._inputs[:0] = [item for item in inputs if not isinstance(item, CHANNEL_EVENTS)]

    def portion(self) -> list[Input]:
        """Return as much of what waits as a child can do in a tick."""
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
        """Return how many inputs found no room since the last call."""
        refused, self._refused = self._refused, 0
        return refused

    def note(self, requests: Iterable[ChannelRequest]) -> None:
        """Note which connections the child opens and closes."""
        for request in requests:
            if isinstance(request, OpenChannel | OpenLine):
                self._channels.add(request.channel)
            elif isinstance(request, CloseChannel):
                self._channels.discard(request.channel)

    def end_connections(self) -> tuple[ChannelRequest, ...]:
        """Return what closes the connections of a child that is gone."""
        requests = tuple(CloseChannel(channel) for channel in sorted(self._channels))
        self._channels.clear()
        self._inputs = [item for item in self._inputs if not isinstance(item, CHANNEL_EVENTS)]
        return requests


class OutputBuffer:
    """Keeps outputs until their tick.

    Attributes:
        newest: the last snapshot that has come in.
    """

    __slots__ = (
        "_events",
        "_fewest",
        "_is_flushed",
        "_lacking_since_s",
        "_lacking_ticks",
        "_parts",
        "_requests",
        "_shown",
        "_ticks",
        "_waiting",
        "newest",
    )

    def __init__(self) -> None:
        self._waiting: deque[Output | TickResult] = deque()
        self._events: list[Event] = []
        self._requests: list[ChannelRequest] = []
        self._shown: Snapshot | None = None
        self._parts = 0
        self._fewest = DELAY_MAX_TICKS
        self._ticks = 0
        self._is_flushed = False
        self._lacking_since_s: float | None = None
        """Since when the output of the tick that is next is not there; None if it is."""
        self._lacking_ticks = 0
        """Ticks that have left without one."""
        self.newest: Snapshot | None = None

    @property
    def is_empty(self) -> bool:
        """Whether no output waits: the next tick would have none of its own."""
        return not self._waiting

    @property
    def is_settled(self) -> bool:
        """Whether nothing waits to leave with the next tick."""
        return not (self._waiting or self._events or self._requests)

    def add(self, output: Output | TickResult) -> None:
        """Take an output that has come in, with a snapshot or without."""
        self._waiting.append(output)
        if isinstance(output, Output):
            self.newest = output.snapshot

    def add_own(self, *events: Event, requests: tuple[ChannelRequest, ...] = ()) -> None:
        """Add what does not come from the child; it leaves after what waits already, with the next tick."""
        self._events += events
        self._requests += requests

    def note_lack(self) -> None:
        """Note that the output of the tick that is to leave is waited for from now on, if it was not before."""
        if self._lacking_since_s is None:
            self._lacking_since_s = time.monotonic()

    def stand_for(self, snapshot: Snapshot) -> None:
        """Let a snapshot of ours leave as the output of its tick: no child is there to give one."""
        self.add(Output(snapshot.robot.tick, (), (), (), snapshot))

    def flush(self) -> None:
        """Let everything that waits leave with the next tick."""
        self._is_flushed = True

    def pass_on(self, output: Output) -> None:
        """Note an output that leaves in its own tick, past the buffer: nothing waits in it (`is_settled`)."""
        self.newest = self._shown = output.snapshot
        self._parts = output.parts
        self._lacking_since_s, self._lacking_ticks = None, 0
        self._surplus()

    def take(self, tick: int) -> Output:
        """Return what leaves in a tick; there must have been a snapshot.

        It has the number of that tick, all that is new, and the newest snapshot; outputs of other ticks are its `rows`.
        """
        count = min(len(self._waiting), 1 + self._surplus())
        taken = [self._own(self._waiting.popleft()) for _ in range(count)]
        if taken:
            self._lacking_since_s, self._lacking_ticks = None, 0
        is_own = count == 1 and taken[0].tick == tick
        if is_own and not self._events and not self._requests:
            # As it is while the child keeps up.
            return taken[0]
        assert self._shown is not None, "there is no snapshot yet"
        events = [*chain.from_iterable(output.events for output in taken), *self._events]
        requests = [*chain.from_iterable(output.requests for output in taken), *self._requests]
        replies = tuple(chain.from_iterable(output.replies for output in taken))
        self._events.clear()
        self._requests.clear()
        rows, repeats = None if is_own else tuple(taken), not taken and self._lacks_for_long()
        return Output(tick, tuple(events), tuple(requests), replies, self._shown, self._parts, rows, repeats)

    def _lacks_for_long(self) -> bool:
        """Count a tick without an output; return whether streams are to repeat their last row.

        Ticks that are made up for follow one another at once: they say nothing about how late the child is.
        """
        self.note_lack()
        assert self._lacking_since_s is not None
        self._lacking_ticks += 1
        if self._lacking_ticks <= REPEAT_AFTER_TICKS:
            return False
        return time.monotonic() - self._lacking_since_s >= REPEAT_AFTER_S

    def _own(self, output: Output | TickResult) -> Output:
        """Return an output with its snapshot, or the one before if it has none."""
        if isinstance(output, Output):
            self._shown, self._parts = output.snapshot, output.parts
            return output
        assert self._shown is not None, "there is no snapshot yet"
        return output.with_snapshot(self._shown, self._parts)

    def _surplus(self) -> int:
        """Return how many outputs need not wait any longer."""
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
