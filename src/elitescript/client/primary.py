"""A client of the primary port: reads states and messages, and sends programs if it may."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Final

from elitescript.client.connecting import CommandError, Inflow, LinkError, connected, read_some
from elitescript.client.primary_messages import MessageReader, RobotState, RobotText

SILENCE_S: Final = 3.0
"""Longest time without a message: a controller sends ten states a second."""
SEND_S: Final = 3.0
MESSAGES_PER_S: Final = 4000.0
BYTES_PER_S: Final = 4e6
"""What a controller may send; ten states a second have 12 kB."""


class PrimaryClient:
    """One connection; `primary_client` opens it.

    Args:
        reader: from the controller.
        writer: to it.
        may_command: whether programs may be sent.
    """

    __slots__ = ("_inflow", "_may_command", "_messages", "_reader", "_silent_s", "_writer")

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, may_command: bool) -> None:
        self._reader = reader
        self._writer = writer
        self._may_command = may_command
        self._messages = MessageReader()
        self._inflow = Inflow("primary port", MESSAGES_PER_S, BYTES_PER_S)
        self._silent_s = 0.0
        """How long it was waited since the last message that was complete, s."""

    async def messages(self, timeout_s: float = SILENCE_S) -> list[RobotState | RobotText]:
        """Return the messages that have arrived; none if only a part of one has.

        Raises:
            LinkError: no message was complete within the time, or the connection has ended.
            PeerError: bytes that cannot be a message, or too many.
        """
        loop = asyncio.get_running_loop()
        began = loop.time()
        left_s = max(0.0, timeout_s - self._silent_s)
        data = await read_some(self._reader, left_s, "primary port, states")
        before = self._messages.count
        found = self._messages.feed(data)
        new, now = self._messages.count - before, loop.time()
        self._inflow.take(new, len(data), now)
        self._silent_s = 0.0 if new else self._silent_s + now - began
        return found

    async def send_script(self, text: str) -> None:
        """Send a program or a command; the controller does not answer but with messages about what is wrong.

        Raises:
            CommandError: this connection only reads.
            LinkError: the connection has ended, or takes nothing.
        """
        if not self._may_command:
            raise CommandError("this connection only reads: it may not send programs")
        self._writer.write(text.encode() + b"\n")
        try:
            async with asyncio.timeout(SEND_S):
                await self._writer.drain()
        except TimeoutError:
            raise LinkError(f"primary port: the controller takes nothing for {SEND_S:g} s") from None


@contextlib.asynccontextmanager
async def primary_client(host: str, port: int, *, may_command: bool = False) -> AsyncIterator[PrimaryClient]:
    """Connect to the primary port; hang up at the end of the block.

    Raises:
        LinkError: there is no connection, it has ended, or the controller does not keep the protocol.
    """
    async with connected(host, port, "primary") as (reader, writer):
        yield PrimaryClient(reader, writer, may_command=may_command)
