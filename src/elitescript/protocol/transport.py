"""Bytes between one client and its connection without a socket, in ticks.

What a client sends is taken in before a tick, what it gets is there after one. A client that sends faster than its
connection can work on it waits, as one does whose socket is not read.
"""

from __future__ import annotations

from typing import Final

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.protocol.connection import Connection, ProtocolError

READ_MAX: Final = 65_536
"""Bytes that a connection gets at once."""


class MemoryTransport:
    """The way between one client and its connection.

    Args:
        connection: the robot's side.

    Attributes:
        connection: see above.
        is_open: whether both sides know each other still.
        is_closing: whether the client has closed.
        received: what has come for the client.
        error: why the robot has closed; empty if it has not, or if the client asked for it.
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
        """Send bytes; the connection has them in the next tick, or later if it is busy."""
        self._unread += data

    def receive(self, size: int | None = None) -> bytes:
        """Return what has come and was not returned yet, `size` bytes at most."""
        data = bytes(self.received if size is None else self.received[:size])
        del self.received[: len(data)]
        return data

    def close(self) -> None:
        """Close, once the connection has what was sent."""
        self.is_closing = True

    # ---------------------------------------------------------------- the robot's side

    @property
    def has_sent(self) -> bool:
        """Whether the client has sent or closed something that the connection does not know yet."""
        return self.is_open and (bool(self._unread) or self.is_closing)

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that matters to the client although nothing happens in it."""
        if not self.is_open:
            return None
        return tick + 1 if self.has_sent else self.connection.next_tick(tick)

    def take_in(self, tick: int, output: Output) -> list[Input]:
        """Give the connection what the client has sent; return what it asks for in a tick.

        Args:
            tick: the one that is about to run.
            output: of the one before.
        """
        connection, inputs = self.connection, list[Input]()
        try:
            while self._unread and not connection.is_busy and not connection.is_over:
                piece = bytes(self._unread[:READ_MAX])
                del self._unread[:READ_MAX]
                if found := connection.receive(piece, output):
                    connection.posted(tick)
                    inputs += found
        except ProtocolError as error:
            self.error = str(error)
        return inputs + self._settled()

    def publish(self, output: Output) -> list[Input]:
        """Give the client a tick; return what the connection asks for in the next one."""
        try:
            self.connection.publish(output)
        except ProtocolError as error:
            self.error = str(error)
        return self.connection.due() + self._settled()

    def end(self) -> list[Input]:
        """Close at once, whatever has been sent; return what that means for the robot."""
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
