"""Clients of a robot's ports in memory and virtual time, without a socket."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from elitescript.kernel.kernel import Kernel
from elitescript.kernel.options import given_ticks
from elitescript.messages.events import DeviceNoted
from elitescript.protocol.transport import MemoryTransport
from elitescript.said import said

EXPECT_S: Final = 1.0
"""How long `Client.expect` waits by default, s of robot time."""
_SHOWN: Final = 200
"""Bytes that the text of an error shows."""


class Client:
    """A client of one port, as `VirtualRobot.connect` makes it.

    Bytes that are sent are taken in by the next tick that runs; what the robot sends in a tick can be received after
    it. Nothing waits for wall time, and nothing is lost: what is not received stays.

    Attributes:
        name: the client in warnings and in the log, such as `dashboard#1`.
    """

    __slots__ = ("_step", "_transport", "name")

    def __init__(self, transport: MemoryTransport, step: Callable[[], None]) -> None:
        self.name = transport.connection.origin
        self._transport = transport
        self._step = step

    @property
    def is_open(self) -> bool:
        """Whether neither side has closed the connection."""
        return self._transport.is_open and not self._transport.is_closing

    @property
    def error(self) -> str:
        """Why the robot has closed the connection: what the client sent that makes no sense; else empty."""
        return self._transport.error

    def send(self, data: bytes) -> None:
        """Send bytes.

        Raises:
            TypeError: no bytes.
            ConnectionError: the connection is closed.
        """
        if not isinstance(data, bytes | bytearray | memoryview):
            raise TypeError(f"{self.name}: bytes are sent, not {type(data).__name__}; a text needs .encode()")
        if not self.is_open:
            raise ConnectionError(self._closed_text())
        self._transport.send(data)

    def receive(self, size: int | None = None) -> bytes:
        """Return what has come and was not received yet; nothing if nothing has.

        Args:
            size: so many bytes at most; all of them if None.
        """
        return self._transport.receive(size)

    def expect(self, data: bytes, within_s: float = EXPECT_S) -> bytes:
        """Let robot time go by until some bytes have come.

        Args:
            data: what is to come, after what was received already.
            within_s: so much robot time at most.

        Returns:
            Everything up to the end of `data`; what has come behind it is received next.

        Raises:
            TimeoutError: it has not come within that time.
            ConnectionError: the connection is closed, and it has not come before.
            UsageError: robot time goes by already: `expect` is called from `watch` or `on_event`.
        """
        transport = self._transport
        left = given_ticks(within_s, "within_s")
        while (end := transport.received.find(data)) < 0:
            what = f"{data!r} has not come; instead: {_tail(transport.received)}"
            if not transport.is_open:
                raise ConnectionError(f"{self._closed_text()}; {what}")
            if left <= 0:
                raise TimeoutError(f"{self.name}: after {within_s:g} s of robot time, {what}")
            self._step()
            left -= 1
        return transport.receive(end + len(data))

    def close(self) -> None:
        """Close the connection; what was sent still arrives."""
        self._transport.close()

    def _closed_text(self) -> str:
        why = f"by the robot: {self.error}" if self.error else "already"
        return f"{self.name}: the connection is closed {why}"


class Clients:
    """Holds the clients of one robot that are in memory.

    Args:
        robot: the robot.
    """

    __slots__ = ("_count", "_open", "_robot")

    def __init__(self, robot: Kernel) -> None:
        self._robot = robot
        self._count: dict[str, int] = {}
        self._open: list[MemoryTransport] = []

    @property
    def are_open(self) -> bool:
        """Whether there is one."""
        return bool(self._open)

    def connect(self, service: str, step: Callable[[], None]) -> Client:
        """Connect a client to a port.

        Args:
            service: name of the port.
            step: lets one tick go by.

        Raises:
            UsageError: there is no such port.
        """
        number = self._count.get(service, 0) + 1
        transport = MemoryTransport(self._robot.connect(service, f"{service}#{number}"))
        self._count[service] = number
        self._open.append(transport)
        return Client(transport, step)

    def take_in(self) -> None:
        """Give the robot what the clients have sent, before a tick."""
        robot = self._robot
        senders = [transport for transport in self._open if transport.has_sent]
        if senders:
            output = robot.output()
            for transport in senders:
                robot.post(transport.take_in(robot.present_tick, output))
                self._report(transport)

    def publish(self) -> None:
        """Give a tick that has run to the clients."""
        robot = self._robot
        tick, has_news = robot.present_tick, robot.has_news
        for transport in self._open:
            if transport.is_open and (has_news or transport.connection.next_tick(tick - 1) == tick):
                robot.post(transport.publish(robot.output()))
                self._report(transport)
        self._open = [transport for transport in self._open if transport.is_open]

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that matters to a client; None if none does by itself."""
        if self._open and self._robot.has_news:
            return tick + 1
        return min(
            (at for at in (transport.next_tick(tick) for transport in self._open) if at is not None), default=None
        )

    def _report(self, transport: MemoryTransport) -> None:
        if transport.error:
            text = said("closed: {reason}", reason=transport.error)
            self._robot.emit(DeviceNoted(self._robot.present_tick, transport.connection.origin, text, True))


def _tail(received: bytearray) -> str:
    if not received:
        return "nothing"
    tail = bytes(received[-_SHOWN:])
    return repr(tail) if len(received) <= _SHOWN else f"... {tail!r}"
