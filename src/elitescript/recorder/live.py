"""The rows and messages of a session as they come, for what follows an arm live."""

from __future__ import annotations

import asyncio
from collections import ChainMap, deque
from collections.abc import Mapping
from typing import Any, Final

from elitescript.client.rtsi_messages import OutputLayout
from elitescript.protocol.binary import Number, WireValue
from elitescript.recorder.channels import CHANGES, SLOW, TALKING, TIME
from elitescript.recorder.recording import Message
from elitescript.records import NamedTuple

WAITING_MAX: Final = 15_000
"""Rows and messages that wait to be taken; a minute. Of more the oldest go, and are counted."""


class LiveRow(NamedTuple):
    """One row."""

    t: float
    """Time of the controller, s."""
    arrived_s: float
    """Since the first thing that was heard."""
    values: ChainMap[str, WireValue]
    """By the name of the variable in RTSI, vectors as tuples: those of the row, then the newest of all others,
    which are the same object as long as nothing of them changes."""


class LiveSink:
    """Keeps what a session hears until it is taken.

    Attributes:
        left_out: rows and messages that were not taken in time.
    """

    __slots__ = ("_begin_ns", "_came", "_layout", "_t", "_values", "_waiting", "left_out")

    def __init__(self) -> None:
        self._waiting: deque[LiveRow | Message] = deque()
        self._came = asyncio.Event()
        self._layout: OutputLayout | None = None
        self._values: dict[str, WireValue] = {}
        """Of the variables that are not in the rows, the newest."""
        self._begin_ns: int | None = None
        self._t = 0.0
        self.left_out = 0

    async def take(self) -> list[LiveRow | Message]:
        """Return what has come since the last call, in its order; wait until there is something."""
        await self._came.wait()
        self._came.clear()
        found = list(self._waiting)
        self._waiting.clear()
        return found

    def begin_rows(self, layout: OutputLayout) -> None:
        """See `Sink`."""
        self._layout = layout
        self._values = {}

    def row(self, t: float, flat: tuple[Number, ...], arrived_ns: int) -> None:
        """See `Sink`."""
        assert self._layout is not None
        self._t = t
        self._put(LiveRow(t, self._arrived_s(arrived_ns), ChainMap(self._layout.values(flat), self._values)))

    def message(self, channel: str, data: Mapping[str, Any], arrived_ns: int) -> None:
        """See `Sink`."""
        if channel in (CHANGES, SLOW):
            # Another mapping: rows that were given away keep what held then.
            self._values = {**self._values, **{name: value for name, value in data.items() if name != TIME}}
        else:
            self._put(Message(self._t, self._arrived_s(arrived_ns), TALKING[channel], data))

    def tick(self, now_ns: int) -> None:
        """See `Sink`; there is nothing to do."""

    def _arrived_s(self, arrived_ns: int) -> float:
        if self._begin_ns is None:
            self._begin_ns = arrived_ns
        return (arrived_ns - self._begin_ns) * 1e-9

    def _put(self, item: LiveRow | Message) -> None:
        if len(self._waiting) >= WAITING_MAX:
            self._waiting.popleft()
            self.left_out += 1
        self._waiting.append(item)
        self._came.set()
