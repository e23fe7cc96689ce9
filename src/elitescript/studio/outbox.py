"""Keeps the messages to one page in order, and the memory of a page that does not read within bounds."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, Final

from elitescript.codec.json_text import to_text

BUFFERED_BYTES: Final = 1 << 20
"""Bytes that may wait in the socket; from there on messages wait here, the newest of `NEWEST_ONLY` alone."""

ROOM_BYTES: Final = 4 << 20
"""Bytes that wait here before a source that can wait is held back."""

WAITING_BYTES_MAX: Final = 64 << 20
"""Bytes that may wait here; a page that is so far behind is disconnected, and begins anew."""

NEWEST_ONLY: Final = frozenset(("progress", "moment"))
"""Types of messages of which only the newest is worth sending."""


class Outbox:
    """A queue of messages, sent one after the other.

    Args:
        send: sends one; returns when the next one may be sent.
        overflow: called once when too much waits; nothing is queued from then on.
    """

    __slots__ = ("_bytes", "_is_open", "_overflow", "_room", "_rows", "_send", "_wake")

    def __init__(self, send: Callable[[str | bytes], Awaitable[None]], overflow: Callable[[], None]) -> None:
        self._send = send
        self._overflow = overflow
        self._rows: deque[tuple[str, str | bytes]] = deque()
        self._bytes = 0
        self._is_open = True
        self._wake = asyncio.Event()
        self._room = asyncio.Event()
        self._room.set()

    def put(self, message: Mapping[str, Any] | bytes) -> None:
        """Queue a message: a record of the conversation, or rows as bytes."""
        if not self._is_open:
            return
        kind, data = ("", message) if isinstance(message, bytes) else (message["type"], to_text(message))
        if kind in NEWEST_ONLY:
            self._drop(kind)
        self._rows.append((kind, data))
        self._add(len(data))
        self._wake.set()
        if self._bytes > WAITING_BYTES_MAX:
            self._is_open = False
            self._rows.clear()
            self._overflow()

    async def room(self) -> None:
        """Return when a source may put more; messages that cannot wait are put at any time."""
        await self._room.wait()

    async def run(self) -> None:
        """Send until it is cancelled, or until `send` fails."""
        while True:
            while self._rows:
                _, data = self._rows.popleft()
                self._add(-len(data))
                await self._send(data)
            self._wake.clear()
            await self._wake.wait()

    def _drop(self, kind: str) -> None:
        for row in [row for row in self._rows if row[0] == kind]:
            self._rows.remove(row)
            self._add(-len(row[1]))

    def _add(self, size: int) -> None:
        self._bytes += size
        if self._bytes > ROOM_BYTES:
            self._room.clear()
        else:
            self._room.set()
