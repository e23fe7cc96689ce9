"""The interface of every connection that the controller serves: bytes in, inputs out; what a tick gives in, bytes out.

A connection is sans-I/O: it knows no socket and no clock, only ticks. The pump (`services.clients.tcp`) calls
`receive` with whatever has arrived, hands the inputs to the robot, calls `publish` after every tick, and writes what
`take` returns with one call each. Buffers are bounded; a client that sends what cannot be meets `ProtocolError`: its
connection is closed, nobody else's.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

from elitescript.messages.inputs import Input
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription


class ProtocolError(Exception):
    """The peer sent what cannot be; the text says what, where and what was expected."""


class Connection(ABC):
    """One client of one port.

    Args:
        origin: names the client in inputs and logs, such as `rtsi#2`.
        description: the robot.
    """

    __slots__ = ("_out", "description", "is_over", "origin")

    def __init__(self, origin: str, description: RobotDescription) -> None:
        self.origin = origin
        self.description = description
        self.is_over = False
        """Whether the connection is to be closed once what it has to say is sent."""
        self._out: list[bytes] = []

    @abstractmethod
    def receive(self, data: bytes, output: Output) -> list[Input]:
        """Take bytes that have arrived; return what they ask for.

        Args:
            data: any part of the stream.
            output: of the last tick, for what is answered at once.

        Raises:
            ProtocolError: the stream makes no sense; the connection is to be closed.
        """

    def posted(self, tick: int) -> None:
        """The inputs that `receive` has just returned go in at that tick, or later if many wait."""
        return

    @abstractmethod
    def publish(self, output: Output) -> None:
        """Take note of a tick: queue what this client is to hear of it."""

    def reads_snapshot(self, tick: int) -> bool:
        """Whether it reads more of the snapshot of a tick than the discrete state: joints, poses, forces, times.

        Asked before the tick runs; what `receive` and `publish` get else may be an older snapshot, of which only the
        discrete state (levels, modes, tool, task) is that of the tick. See `messages.outputs.Output`.
        """
        return False

    @property
    def is_busy(self) -> bool:
        """Whether it has enough to work on: leave what the peer sends in the socket until this is over."""
        return False

    @property
    def is_expecting(self) -> bool:
        """Whether an answer to what the peer has asked is still to come."""
        return False

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must be published although nothing happens in it; None if none must.

        A tick in which there are events or replies must be published in any case.
        """
        return tick + 1 if self.is_busy or self.is_expecting else None

    def due(self) -> list[Input]:
        """Return what time alone has made of bytes that came before; to be asked after every `publish`."""
        return []

    def read_on(self, output: Output) -> list[Input]:
        """While no tick comes, answer what needs none and was left for the next; return what it asks for.

        Args:
            output: of the last tick.

        Raises:
            ProtocolError: see `receive`.
        """
        return []

    def closed(self) -> list[Input]:
        """The client has gone; return what that means for the robot."""
        return []

    def take(self) -> list[bytes]:
        """Return the messages that are to be sent, in order; each is one write."""
        out, self._out = self._out, []
        return out

    def send(self, message: bytes) -> None:
        """Queue one message."""
        self._out.append(message)
