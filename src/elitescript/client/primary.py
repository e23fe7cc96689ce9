"""A client of the primary port: reads states and messages, and sends programs if it may."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Final

from elitescript.client.connecting import CommandError, LinkError, connected, read_some
from elitescript.client.primary_messages import MessageReader, RobotState, RobotText

SILENCE_S: Final = 3.0
"""Longest time without a message: a controller sends ten states a second."""
SEND_S: Final = 3.0


class PrimaryClient:
    """One connection; `primary_client` opens it.

    Args:
        reader: from the controller.
        writer: to it.
        may_command: whether programs may be sent.
    """

    __slots__ = ("_may_command", "_messages", "_reader", "_writer")

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, may_command: bool) -> None:
        self._reader = reader
        self._writer = writer
        self._may_command = may_command
        self._messages = MessageReader()

    async def messages(self, timeout_s: float = SILENCE_S) -> list[RobotState | RobotText]:
        """Return the messages that have arrived; none if only a part of one has.

        Raises:
            LinkError: nothing came within the time, or the connection has ended.
            PeerError: bytes that cannot be a message.
        """
        return self._messages.feed(await read_some(self._reader, timeout_s, "primary port, states"))

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
