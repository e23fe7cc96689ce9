"""Bytes between one client and its connection without a socket, in ticks.

Bytes of the client are taken in before a tick, those for it are there after one. While the connection is busy, bytes of
the client wait, as in a socket that is not read.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.protocol.connection import BrowserError, Connection, ProtocolError

READ_MAX: Final = 65_536
"""Limit of bytes that a connection gets at once."""


class MemoryTransport:
    """Buffers between one client and its connection.

    Args:
        connection: the robot's side.

    Attributes:
        is_open: whether neither side has ended the connection.
        is_closing: whether the client has closed.
        received: bytes for the client.
        error: why the robot has closed; empty if it has not, or at the request of the client.
    """

    __slots__ = ("_unread", "connection", "error", "is_closing", "is_open", "received")

    def __init__(self, connection: Connection) -> None:
        self.connection = connection
        self.is_open = True
        self.error = ""
        self.is_closing = False
        self._unread = bytearray()
        self.received = bytearray()
        self._collect()

    # ---------------------------------------------------------------- the client's side

    def send(self, data: bytes) -> None:
        """Send bytes, which the connection takes in the next tick, or later if it is busy."""
        self._unread += data

    def receive(self, size: int | None = None) -> bytes:
        """Return received bytes that were not returned yet, `size` at most."""
        data = bytes(self.received if size is None else self.received[:size])
        del self.received[: len(data)]
        return data

    def close(self) -> None:
        """Close, once the connection has taken the sent bytes."""
        self.is_closing = True

    # ---------------------------------------------------------------- the robot's side

    @property
    def has_sent(self) -> bool:
        """Whether the connection has not taken bytes or the end of the client yet."""
        return self.is_open and (bool(self._unread) or self.is_closing)

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must run for the client although nothing happens in it."""
        if not self.is_open:
            return None
        return tick + 1 if self.has_sent else self.connection.next_tick(tick)

    def take_in(self, tick: int, output: Output) -> list[Input]:
        """Pass the bytes of the client to the connection; return the inputs for a tick.

        Args:
            tick: the one that is about to run.
            output: of the one before.
        """
        connection, inputs = self.connection, list[Input]()
        try:
            while self._unread and not connection.is_busy and not connection.is_over:
                piece = bytes(self._unread[:READ_MAX])
                del self._unread[:READ_MAX]
                if found := connection.take_in(piece, output):
                    connection.posted(tick)
                    inputs += found
        except BrowserError as error:
            self.error = str(error)
            self.end()
            return []
        except ProtocolError as error:
            self.error = str(error)
        return inputs + self._settled()

    def publish(self, output: Output) -> list[Input]:
        """Publish a tick to the client; return the inputs for the next one."""
        try:
            self.connection.publish(output)
        except ProtocolError as error:
            self.error = str(error)
        return self.connection.due() + self._settled()

    def end(self) -> list[Input]:
        """Close at once, without the bytes that wait; return the inputs to the robot."""
        if not self.is_open:
            return []
        self._collect()
        self.is_open = False
        inputs = self.connection.closed()
        self._collect()
        return inputs

    def _settled(self) -> list[Input]:
        self._collect()
        is_over = self.error or self.connection.is_over or (self.is_closing and not self._unread)
        return self.end() if is_over else []

    def _collect(self) -> None:
        for message in self.connection.take():
            self.received += message
