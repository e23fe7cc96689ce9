"""The pump of every TCP service: sockets on one side, sans-I/O connections on the other.

What arrives is decoded at once, what a tick gives leaves at once; each message is one write. A client harms nobody:

- of what it sends, as much is read in a tick as takes `SLICE_NS`; the rest stays in its socket, and a connection
  that has enough to work on (`is_busy`) is not read at all;
- one that reads slower than its stream misses samples of the stream (they are counted); one that lets `BACKLOG_MAX`
  bytes pile up, or takes nothing for `STALLED_TICKS`, is cut off;
- one that sends what cannot be is closed;
- one that ends its own half is answered what it asked, and gets the stream where the service is one.
"""

from __future__ import annotations

import asyncio
import socket
import time
import traceback
from typing import Any, Final, Protocol

from elitescript.messages.inputs import Input, VariablesArrived
from elitescript.messages.outputs import Output
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.connection import Connection, ProtocolError
from elitescript.services.table import Connect, Service

READ_BYTES: Final = 4096
"""Taken from a socket at once."""
SLICE_NS: Final = 300_000
"""Of every tick, for what one client sends; processor time."""
SLICES_NS: Final = 1_500_000
"""Of every tick, for what all clients of a robot send; beyond it each is read once."""
SAMPLE_BACKLOG: Final = 64 * 1024
"""Bytes that wait for a client, besides what the operating system holds, from which on samples are left out."""
BACKLOG_MAX: Final = 1024 * 1024
STALLED_TICKS: Final = 30 * TICKS_PER_S
LINGER_TICKS: Final = 5 * TICKS_PER_S
"""How long a client that has ended its half, or is to be closed, has to take what it asked for."""
CLIENTS_MAX: Final = 64
"""Of one service."""
LEAVING_MAX: Final = 1024
"""Of one service, with those who are about to leave."""


class Hub(Protocol):
    """The robot's side of the pump."""

    output: Output
    """Of the last tick."""
    reading_ns: int
    """Time that has gone into reading since then."""

    def post(self, inputs: list[Input]) -> None:
        """Take inputs for the next tick."""

    def wake(self) -> None:
        """A client has sent an input package, has read, or has gone: time may go on, if it waited."""

    def note(self, kind: str, text: str, *, is_problem: bool = False, **details: Any) -> None:
        """Something worth a line in the log."""


class Client(asyncio.BufferedProtocol):
    """One client: its socket and its connection.

    Args:
        listener: where it came in.
    """

    __slots__ = (
        "_buffer",
        "_deadline",
        "_is_paused",
        "_is_silent",
        "_listener",
        "_spent_ns",
        "_stalled_since",
        "_transport",
        "connection",
        "dropped",
        "origin",
        "owes_input",
        "peer",
    )

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self._buffer = bytearray(READ_BYTES)
        self._transport: asyncio.Transport | None = None
        self.connection: Connection | None = None
        self.origin = ""
        self.peer = ""
        self.dropped = 0
        """Samples that this client has missed."""
        self.owes_input = False
        """Whether it has got a sample since its last input package."""
        self._is_silent = False
        self._is_paused = False
        self._spent_ns = 0
        self._stalled_since: int | None = None
        self._deadline: int | None = None

    # ---------------------------------------------------------------- what the event loop calls

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        listener = self._listener
        address = transport.get_extra_info("peername")
        self.peer = f"{address[0]}:{address[1]}" if address else "?"
        if listener.count >= CLIENTS_MAX or len(listener.clients) >= LEAVING_MAX:
            text = f"refused {self.peer}: {CLIENTS_MAX} clients are connected"
            listener.hub.note("refused", f"{listener.service.name}: {text}", is_problem=True, peer=self.peer)
            transport.abort()
            return
        raw = transport.get_extra_info("socket")
        if raw is not None:
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        transport.set_write_buffer_limits(high=SAMPLE_BACKLOG, low=SAMPLE_BACKLOG // 4)
        self.origin = listener.next_origin()
        self.connection = listener.connect(self.origin)
        listener.clients[self.origin] = self
        listener.hub.note("connected", f"{self.origin}: connected from {self.peer}", origin=self.origin, peer=self.peer)
        self._write()

    def get_buffer(self, sizehint: int) -> bytearray:
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        connection, hub = self.connection, self._listener.hub
        if connection is None or self._deadline is not None:
            return
        start_ns = time.thread_time_ns()
        try:
            inputs = connection.receive(bytes(self._buffer[:nbytes]), hub.output)
        except ProtocolError as error:
            self._offend(str(error))
            return
        except Exception:
            self._fail()
            return
        has_answered = False
        if inputs:
            hub.post(inputs)
            if self.owes_input and any(isinstance(item, VariablesArrived) for item in inputs):
                self.owes_input = False
                has_answered = True
        self._write()
        spent_ns = time.thread_time_ns() - start_ns
        self._spent_ns += spent_ns
        hub.reading_ns += spent_ns
        if connection.is_over:
            self._finish()
        elif connection.is_busy or self._has_spent_enough(nbytes):
            self._pause()
        if has_answered:
            hub.wake()

    def _has_spent_enough(self, size: int) -> bool:
        """Whether the rest must wait for the next tick.

        Who is not read is not seen to go either, so that a client that has sent little, and has nothing more to send
        for the moment, may take longer.
        """
        patience = 1 if size == READ_BYTES else 4
        return self._spent_ns > patience * SLICE_NS or self._listener.hub.reading_ns > patience * SLICES_NS

    def eof_received(self) -> bool:
        self._end_of_input()
        if not self._listener.service.outlives_silence and self._deadline is None:
            self._deadline = self._listener.hub.output.tick + LINGER_TICKS
            self._close_unless_expecting()
        return True

    def connection_lost(self, exc: Exception | None) -> None:
        if self.connection is None:
            return
        self._end_of_input()
        if self._listener.clients.pop(self.origin, None) is not None:
            reason = f": {exc}" if exc else ""
            self._listener.hub.note("gone", f"{self.origin}: gone{reason}", origin=self.origin, dropped=self.dropped)
        self._listener.hub.wake()

    def pause_writing(self) -> None:
        self._stalled_since = self._listener.hub.output.tick

    def resume_writing(self) -> None:
        self._stalled_since = None
        self._listener.hub.wake()

    # ---------------------------------------------------------------- what a tick calls

    @property
    def is_behind(self) -> bool:
        """Whether so much waits for it that it misses samples."""
        return self._stalled_since is not None

    @property
    def is_leaving(self) -> bool:
        """Whether it has said that it sends nothing more, or is to be closed."""
        return self._deadline is not None

    def publish(self, output: Output) -> None:
        """Give the client a tick."""
        connection = self.connection
        if connection is None:
            return
        try:
            connection.publish(output)
            inputs = connection.due()
        except ProtocolError as error:
            self._offend(str(error))
            return
        except Exception:
            self._fail()
            return
        if inputs:
            self._listener.hub.post(inputs)
        self._write()
        if self._deadline is not None:
            if output.tick >= self._deadline:
                self.abort()
            else:
                self._close_unless_expecting()
        elif connection.is_over:
            self._finish()
        elif self._stalled_since is not None and output.tick - self._stalled_since > STALLED_TICKS:
            self._cut_off(f"has read nothing for {STALLED_TICKS // TICKS_PER_S} s")
        else:
            self.read_on()

    def relieve(self) -> None:
        """No tick comes: go on with what does not need one."""
        connection = self.connection
        if connection is None:
            return
        try:
            inputs = connection.read_on(self._listener.hub.output)
        except ProtocolError as error:
            self._offend(str(error))
            return
        except Exception:
            self._fail()
            return
        if inputs:
            self._listener.hub.post(inputs)
        self._write()
        if connection.is_over and self._deadline is None:
            self._finish()
        else:
            self.read_on()

    def read_on(self) -> None:
        """A new slice of time for what the client sends."""
        self._spent_ns = 0
        if self._is_paused and self.connection is not None and not self.connection.is_busy and not self.is_behind:
            self._is_paused = False
            if self._transport is not None and not self._transport.is_closing():
                self._transport.resume_reading()

    def close(self) -> None:
        """End the connection once what waits has been sent."""
        if self._transport is not None:
            self._transport.close()

    def abort(self) -> None:
        """End the connection at once."""
        if self._transport is not None:
            self._transport.abort()

    # ---------------------------------------------------------------- inside

    def _write(self) -> None:
        connection, transport = self.connection, self._transport
        if connection is None or transport is None:
            return
        is_sample = self._listener.service.is_sample
        for message in connection.take():
            if transport.is_closing():
                return
            backlog = transport.get_write_buffer_size()
            if is_sample(message):
                if backlog > SAMPLE_BACKLOG:
                    self._miss()
                    continue
                self.owes_input = True
            elif backlog > BACKLOG_MAX:
                self._cut_off(f"does not read: {backlog} bytes wait for it")
                return
            transport.write(message)
        if self.is_behind:
            self._pause()

    def _miss(self) -> None:
        if not self.dropped:
            text = f"{self.origin}: reads too slowly and misses packages"
            self._listener.hub.note("slow", text, is_problem=True, origin=self.origin)
        self.dropped += 1

    def _pause(self) -> None:
        if not self._is_paused and self._transport is not None and not self._transport.is_closing():
            self._is_paused = True
            self._transport.pause_reading()

    def _end_of_input(self) -> None:
        if self._is_silent or self.connection is None:
            return
        self._is_silent = True
        self.owes_input = False
        inputs = self.connection.closed()
        if inputs:
            self._listener.hub.post(inputs)
        self._write()

    def _offend(self, why: str) -> None:
        self._listener.hub.note("offence", f"{self.origin}: closed: {why}", is_problem=True, origin=self.origin)
        self._finish()

    def _cut_off(self, why: str) -> None:
        text = f"{self.origin}: cut off: it {why}"
        self._listener.hub.note("cut_off", text, is_problem=True, origin=self.origin)
        self.abort()

    def _fail(self) -> None:
        """A mistake of ours: this client pays for it, the others go on."""
        text = f"{self.origin}: internal error, please report it:\n{traceback.format_exc()}"
        self._listener.hub.note("bug", text, is_problem=True, origin=self.origin)
        self.abort()

    def _close_unless_expecting(self) -> None:
        if self.connection is None or not self.connection.is_expecting:
            self.close()

    def _finish(self) -> None:
        """Send what is left, then close."""
        self._write()
        if self._deadline is None:
            self._deadline = self._listener.hub.output.tick + LINGER_TICKS
        self.close()


class Listener:
    """One service of one robot on one port.

    Args:
        service: its row of the table.
        hub: the robot.
        connect: makes connections.
        bound: a socket that listens; the listener closes it.
    """

    __slots__ = ("_bound", "_count", "_server", "clients", "connect", "hub", "number", "service")

    def __init__(self, service: Service, hub: Hub, connect: Connect, bound: socket.socket) -> None:
        self.service = service
        self.hub = hub
        self.connect = connect
        self.clients: dict[str, Client] = {}
        self.number: int = bound.getsockname()[1]
        self._bound = bound
        self._count = 0
        self._server: asyncio.Server | None = None

    def next_origin(self) -> str:
        """A name that no client of this service has had."""
        self._count += 1
        return f"{self.service.name}#{self._count}"

    async def open(self) -> None:
        """Accept clients from now on."""
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(lambda: Client(self), sock=self._bound, backlog=CLIENTS_MAX)

    def publish(self, output: Output) -> None:
        """Give every client a tick."""
        for client in list(self.clients.values()):
            client.publish(output)

    @property
    def count(self) -> int:
        """Clients that are not about to leave."""
        return sum(not client.is_leaving for client in self.clients.values())

    def release(self) -> None:
        """Give the port back without having accepted anybody."""
        self._bound.close()

    async def close(self) -> None:
        """Accept nobody, and let everybody go."""
        if self._server is not None:
            self._server.close()
        self._bound.close()
        for client in list(self.clients.values()):
            client.close()
        # One turn for the loop to close sockets that have nothing left to send; the others do not hold us up.
        await asyncio.sleep(0)
        for client in list(self.clients.values()):
            client.abort()
        await asyncio.sleep(0)


def bind(host: str, number: int) -> socket.socket:
    """A socket that listens at a port; 0 is a free one.

    Raises:
        OSError: somebody has it, or may not be had; the host is none of ours.
    """
    found = socket.getaddrinfo(host, number, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    family, kind, protocol, _, address = next((row for row in found if row[0] == socket.AF_INET), found[0])
    bound = socket.socket(family, kind, protocol)
    try:
        if hasattr(socket, "SO_EXCLUSIVEADDRUSE"):
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        else:
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bound.bind(address)
        # Of two who bind the same port at the same moment, only one may listen.
        bound.listen(CLIENTS_MAX)
        bound.setblocking(False)
    except OSError:
        bound.close()
        raise
    return bound
