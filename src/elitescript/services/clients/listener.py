"""A port of a robot: it accepts clients at a pace that leaves the others their time.

A client that finds no room is refused: its connection is accepted and ended at once. How many were refused,
or were web browsers, is written once at the begin of a burst and once at its end.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import socket
import time
from typing import Final

from elitescript.messages.outputs import Output
from elitescript.messages.timing import TICKS_PER_S
from elitescript.protocol.ports import Connect, Service
from elitescript.services.clients.liveness import watch_peer
from elitescript.services.clients.tcp import Client, Hub

CLIENTS_MAX: Final = 64
"""Of one service."""
LEAVING_MAX: Final = 256
"""Of one service, with those that are about to leave."""
GUESTS_MAX: Final = 32
"""Clients of one service that have not logged in, where that is asked for; the next one takes a place of theirs."""
ACCEPTS_PER_TICK: Final = 8
"""Of one service: two thousand a second, as long as there is time for it."""
BURST_TICKS: Final = TICKS_PER_S
"""Without a refusal, after which a burst of them is over."""
REPORT_TICKS: Final = 10 * TICKS_PER_S
"""A burst that goes on is written again so often."""
NO_ROOM_S: Final = 0.25
"""How long to wait when this process can have no more sockets."""


class RefusalBurst:
    """Writes of refusals that come without a pause the first, and at the end how many there were.

    Args:
        hub: the robot.
        head: what the lines begin with.
        more: what the refused are called.

    Attributes:
        count: of all refusals.
    """

    __slots__ = ("_head", "_hub", "_last_tick", "_more", "_reported", "_reported_tick", "count")

    def __init__(self, hub: Hub, head: str, more: str) -> None:
        self.count = 0
        self._hub = hub
        self._head = head
        self._more = more
        self._reported = self._reported_tick = self._last_tick = 0

    def add(self, why: str) -> None:
        """Count another one."""
        self.count += 1
        tick = self._hub.output.tick
        is_first = self._reported == self.count - 1 and (not self._reported or tick - self._last_tick >= BURST_TICKS)
        self._last_tick = tick
        if is_first:
            self._report(why)

    @property
    def is_reported(self) -> bool:
        """Whether the log has all of them."""
        return self._reported >= self.count

    def report_due(self) -> None:
        """Write how many there were if the burst is over, or lasts long."""
        if not self.is_reported:
            tick = self._hub.output.tick
            if tick - self._last_tick >= BURST_TICKS or tick - self._reported_tick >= REPORT_TICKS:
                self._report(f"refused {self.count - self._reported} more {self._more}")

    def _report(self, text: str) -> None:
        count, self._reported, self._reported_tick = self.count - self._reported, self.count, self._hub.output.tick
        self._hub.note("refused", f"{self._head}: {text}", is_problem=True, count=count)


class Listener:
    """Accepts the clients of one service of one robot on one port.

    Args:
        service: its row of the table.
        hub: the robot.
        connect: makes connections.
        bound: a socket that listens; the listener closes it.
        accepts_per_tick: clients that are accepted in a tick at most.

    Attributes:
        clients: by origin.
        host: address that it listens at.
        number: of the port.
        expected_ns: what accepting takes, see `shares.Waiting`.
        is_restless: whether `begin_tick` is to be called: clients were accepted or refused.
    """

    __slots__ = (
        "_accepted",
        "_accepts_per_tick",
        "_bound",
        "_browsers",
        "_count",
        "_crowd",
        "_hub",
        "_task",
        "_turn",
        "clients",
        "connect",
        "expected_ns",
        "host",
        "is_restless",
        "number",
        "service",
    )

    def __init__(
        self,
        service: Service,
        hub: Hub,
        connect: Connect,
        bound: socket.socket,
        *,
        accepts_per_tick: int = ACCEPTS_PER_TICK,
    ) -> None:
        self.service = service
        self.clients: dict[str, Client] = {}
        self.host: str
        self.number: int
        self.host, self.number = bound.getsockname()[:2]
        self.expected_ns = 0
        self.is_restless = False
        self._hub = hub
        self._crowd = RefusalBurst(hub, service.name, "clients")
        """Clients that found no room."""
        self._browsers = RefusalBurst(hub, service.name, "web browsers")
        self.connect = connect
        self._bound = bound
        self._count = 0
        self._accepted = 0
        self._accepts_per_tick = accepts_per_tick
        self._turn: asyncio.Future[None] | None = None
        self._task: asyncio.Task[None] | None = None

    async def open(self) -> None:
        """Accept clients from now on."""
        self._task = asyncio.get_running_loop().create_task(self._accept())

    def reads(self, tick: int) -> int:
        """Return the parts of the snapshot of a tick that its clients read, as bits."""
        parts = 0
        for client in self.clients.values():
            parts |= client.connection.reads(tick)
        return parts

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that must run though nothing happens in it; None if none must."""
        if self.is_restless:
            return tick + 1
        due: int | None = None
        for client in self.clients.values():
            at = client.next_tick(tick)
            if at is not None and (due is None or at < due):
                due = at
                if due <= tick + 1:
                    break
        return due

    def publish(self, output: Output) -> None:
        """Give every client the output of a tick."""
        for client in tuple(self.clients.values()):
            client.publish(output)

    @property
    def count(self) -> int:
        """Clients that are not about to leave."""
        return sum(not client.is_leaving for client in self.clients.values())

    def _make_room(self) -> None:
        """End the client that has come furthest the least of those that have not logged in, if they are many."""
        guests = [
            client for client in self.clients.values() if not (client.is_leaving or client.connection.is_admitted)
        ]
        if len(guests) >= GUESTS_MAX:
            # Of equals the oldest comes first.
            chosen = min(guests, key=lambda client: client.connection.progress)
            self._crowd.add(f"closed {chosen.origin} from {chosen.peer}: {GUESTS_MAX} clients have not logged in")
            chosen.abort()
            self._forget(chosen.origin)

    def begin_tick(self) -> None:
        """Accept on, and write how many clients were refused if that is due; while `is_restless`."""
        if self._accepted:
            self._accepted = 0
            if self._turn is not None:
                self._hub.shares.wait(self, is_light=True)
        self._crowd.report_due()
        self._browsers.report_due()
        self.is_restless = not (self._crowd.is_reported and self._browsers.is_reported)

    @property
    def refused(self) -> int:
        """Clients that found no room."""
        return self._crowd.count

    def go_on(self) -> None:
        """Accept on now."""
        if self._turn is not None and not self._turn.done():
            self._turn.set_result(None)

    def release(self) -> None:
        """Give the port back without having accepted a client."""
        self._bound.close()

    async def close(self) -> None:
        """Accept no clients any more, and end those that are connected."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        self._bound.close()
        for client in list(self.clients.values()):
            client.close()
        # One turn for the loop to close sockets that have nothing left to send; the others do not hold us up.
        await asyncio.sleep(0)
        for client in list(self.clients.values()):
            client.abort()
        await asyncio.sleep(0)

    # ---------------------------------------------------------------- accepting

    async def _accept(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                raw, address = await loop.sock_accept(self._bound)
            except OSError as error:
                if error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM):
                    self._crowd.add(f"this process can have no more sockets ({error.strerror})")
                    self._stir()
                    await asyncio.sleep(NO_ROOM_S)
                # Any other error is of the client that was to be accepted: it has gone already.
                continue
            start_ns = time.thread_time_ns()
            self._make_room()
            if self.count >= CLIENTS_MAX or len(self.clients) >= LEAVING_MAX:
                raw.close()
                self._crowd.add(f"refused {_host_of(address)}: {CLIENTS_MAX} clients are connected")
            else:
                await self._welcome(raw)
            self.expected_ns = time.thread_time_ns() - start_ns
            self._hub.shares.charge(self.expected_ns)
            self._accepted += 1
            self._stir()
            if self._accepted >= self._accepts_per_tick or self._hub.shares.is_used_up(0):
                self._turn = loop.create_future()
                try:
                    await self._turn
                finally:
                    self._turn = None

    async def _welcome(self, raw: socket.socket) -> None:
        self._count += 1
        origin = f"{self.service.name}#{self._count}"
        client = Client(self._hub, self.service, self.connect(origin), self._forget, self._refuse)
        self.clients[origin] = client
        with contextlib.suppress(OSError):
            # It may have gone already; what it sent before counts.
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            watch_peer(raw)
        try:
            await asyncio.get_running_loop().connect_accepted_socket(lambda: client, raw)
        except OSError:
            # It has gone already.
            raw.close()
            self._forget(origin)

    def _refuse(self, why: str) -> None:
        """Write that a client was a web browser."""
        self._browsers.add(why)
        self._stir()

    def _stir(self) -> None:
        """Have the next tick run."""
        self.is_restless = True
        self._hub.make_due()

    def _forget(self, origin: str) -> None:
        self.clients.pop(origin, None)


def _host_of(address: object) -> str:
    return f"{address[0]}:{address[1]}" if isinstance(address, tuple) and len(address) >= 2 else "a client"
