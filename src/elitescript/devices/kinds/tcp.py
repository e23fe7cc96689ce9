"""TCP servers beside the robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from elitescript.devices.channels.network import DeviceLink, Endpoint, Peer
from elitescript.devices.device import Device, DeviceContext, TakenError, check_number, check_text
from elitescript.devices.kinds.lines import Answer, LineBuffer, check_lines, encoded
from elitescript.errors import UsageError
from elitescript.messages.timing import ticks_for
from elitescript.said import said

LATENCY_MAX_S: Final = 3600.0
CONNECTIONS_MAX: Final = 64
INCOMPLETE_S: Final = 1.0
"""A line that has begun and does not end for so long is worth a warning."""


class TcpConnection(Peer):
    """A program's connection to a `TcpServer`. A server may keep attributes of its own here.

    Attributes:
        number: counts the connections of the server, from 1.
        server: the device.
    """

    def __init__(self, server: TcpServer, link: DeviceLink, number: int) -> None:
        super().__init__(link)
        self.server = server
        self.number = number
        self._lines = LineBuffer(server.line_end, server.encoding)

    @property
    def is_open(self) -> bool:
        """Whether neither side has closed."""
        return self.link.is_open

    def send(self, data: str | bytes) -> None:
        """Send bytes or a text, as they are."""
        self.link.send(encoded(data, "", self.server.encoding))

    def send_line(self, text: str) -> None:
        """Send a text and the server's line end."""
        self.link.send(encoded(text, self.server.line_end, self.server.encoding))

    def after(self, delay_s: float, call: Callable[..., Any], *arguments: Any) -> None:
        """Have something called when so much time has passed, if the connection still stands then."""
        self.link.later(delay_s, lambda: call(*arguments))

    def close(self) -> None:
        """Close the connection, once the program has what was sent."""
        if self.link.is_open:
            self.link.close()
            self.server.forget(self)

    # ---------------------------------------------------------------- called by the network

    def answer(self, answer: Answer) -> None:
        """Send what a method of the server has returned."""
        if answer is None:
            return
        if not isinstance(answer, str | bytes | bytearray):
            raise TypeError(f"a device returns a str, bytes or None to have it sent, not {answer!r}")
        self.link.send(encoded(answer, self.server.line_end, self.server.encoding))

    def opened(self) -> None:
        self.answer(self.server.opened(self))

    def received(self, data: bytes) -> None:
        self.answer(self.server.received(self, data))

    def closed(self) -> None:
        self._complain(self._lines.rest)
        self.server.forget(self)
        self.server.closed(self)

    def given_up(self) -> None:
        self.server.forget(self)

    def lines(self, data: bytes) -> list[str]:
        """Return lines that are complete by these bytes."""
        found = self._lines.receive(data)
        rest = self._lines.rest
        if rest and not self.server.has_complained:
            self.link.later(INCOMPLETE_S, lambda: self._complain(rest))
        return found

    def _complain(self, rest: bytes) -> None:
        if rest and self._lines.rest == rest and not self.server.has_complained:
            self.server.has_complained = True
            self.server.warn(
                said(
                    "waits for the end of the line {rest!r}: socket_send_line sends {line_end!r} at its end; "
                    'a device with line_end = "" takes whatever arrives together',
                    rest=rest[:60],
                    line_end=self.server.line_end,
                )
            )


class TcpServer(Device):
    r"""A device that programs connect to, such as a camera.

    Override what it needs. A text that `opened`, `received` or `line_received` returns is sent as a line, bytes are
    sent as they are, and None sends nothing. Everything takes one control period at least: a request there, an answer
    back.

    Attributes:
        port: where it listens.
        address: under which alone it is reached; any address leads to it if empty.
        latency_s: time that what it sends takes to arrive.
        jitter_s: further time of up to this, drawn for each sending; nothing overtakes.
        chunk: most bytes that arrive in one control period; 0 for any number.
        line_end: ends the lines of both sides. If empty, whatever arrives together counts as a line.
        encoding: of texts.
        is_listening: whether it accepts connections; may change at any time.
        connections_max: connections that it accepts at a time.
        connections: those that stand.

    Example:
        A camera that answers where the next part is, 80 ms after the question.

        >>> from elitescript import VirtualRobot
        >>> from elitescript.testing.world import TcpServer, World
        >>> class Camera(TcpServer):
        ...     port = 5000
        ...     latency_s = 0.08
        ...     def line_received(self, connection, line):
        ...         if line == "where?":
        ...             return "(0.41, -0.12, 0.08)"
        >>> robot = VirtualRobot("CS66", world=World(devices=[Camera()]))
        >>> run = robot.run('''
        ... def pick():
        ...   socket_open("192.168.1.20", 5000)
        ...   socket_send_line("where?")
        ...   textmsg(socket_read_ascii_float(3))
        ... end
        ... ''')
        >>> run.log
        ['[3, 0.41, -0.12, 0.08]']
    """

    port: int = 0
    address: str = ""
    latency_s: float = 0.0
    jitter_s: float = 0.0
    chunk: int = 0
    line_end: str = "\n"
    encoding: str = "utf-8"
    is_listening: bool = True
    connections_max: int = CONNECTIONS_MAX

    _kept = ("has_complained",)
    _connections: list[TcpConnection] | None = None
    _count: int = 0
    has_complained: bool = False

    # ---------------------------------------------------------------- what a subclass may override

    def opened(self, connection: TcpConnection) -> Answer:
        """Act on a program that has connected."""
        return None

    def received(self, connection: TcpConnection, data: bytes) -> Answer:
        """Take bytes; without an override they are cut into lines for `line_received`."""
        for line in connection.lines(data):
            connection.answer(self.line_received(connection, line))
        return None

    def line_received(self, connection: TcpConnection, line: str) -> Answer:
        """Take a line, without its end."""
        self.miss_method("line_received(self, connection, line)", line)
        return None

    def closed(self, connection: TcpConnection) -> None:
        """Act on the end: the program has closed the connection, or has ended."""

    # ---------------------------------------------------------------- what a subclass may use

    @property
    def connections(self) -> tuple[TcpConnection, ...]:
        """Connections that stand, in the order in which they were made."""
        return tuple(self._connections or ())

    def send_to_all(self, data: str | bytes) -> None:
        """Send to every connection; a text goes out as a line."""
        for connection in self.connections:
            connection.answer(data)

    def disconnect(self) -> None:
        """Close every connection; new ones are accepted."""
        for connection in self.connections:
            connection.close()

    # ---------------------------------------------------------------- called by the world

    def check(self) -> None:
        if not self.port:
            raise UsageError("port: is missing: where it listens")
        check_number("port", self.port, 1, 65535, is_whole=True)
        check_text("address", self.address)
        check_number("latency_s", self.latency_s, 0.0, LATENCY_MAX_S, "s")
        check_number("jitter_s", self.jitter_s, 0.0, LATENCY_MAX_S, "s")
        check_number("chunk", self.chunk, 0, 65536, "bytes", is_whole=True)
        check_number("connections_max", self.connections_max, 0, CONNECTIONS_MAX, is_whole=True)
        check_lines(self.line_end, self.encoding)

    @property
    def endpoint(self) -> Endpoint:
        """Where it listens."""
        return (self.address, self.port) if self.address else self.port

    def join(self, context: DeviceContext) -> None:
        super().join(context)
        taken = context.network.servers.get(self.endpoint)
        if taken is not None:
            other = getattr(taken, "__self__", None)
            text = said(
                "port: {port} is taken by {owner} already",
                port=self.port,
                owner=getattr(other, "title", "another server"),
            )
            raise TakenError(text, other)
        context.network.servers[self.endpoint] = self.accept
        self._connections = []

    def accept(self, link: DeviceLink) -> Peer | None:
        """Accept a connection of a program; None refuses."""
        assert self._connections is not None
        if not self.is_listening or len(self._connections) >= self.connections_max:
            return None
        link.shape(
            latency_s=self.latency_s, chunk=self.chunk, delay=self._jitter if self.jitter_s else None, owner=self
        )
        self._count += 1
        connection = self.connect(link, self._count)
        self._connections.append(connection)
        return connection

    def connect(self, link: DeviceLink, number: int) -> TcpConnection:
        """Make the object of a connection."""
        return TcpConnection(self, link, number)

    def forget(self, connection: TcpConnection) -> None:
        """Forget a connection that is over."""
        if self._connections is not None and connection in self._connections:
            self._connections.remove(connection)

    def _jitter(self) -> int:
        return ticks_for(self.random.random() * self.jitter_s)
