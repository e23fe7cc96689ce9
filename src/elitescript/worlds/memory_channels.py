"""TCP servers in memory, in virtual time: what a program connects to in a test.

A server is a class or function that makes a `Peer` for each connection. What a peer does takes effect one tick later at
the earliest, so that the order in which threads run in a tick does not matter, and every run is the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from heapq import heappop, heappush
from typing import Any, Final

from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.messages.timing import seconds, ticks_for

REFUSED: Final = "connection refused"


class Link:
    """One connection, as the server sees it.

    Attributes:
        is_open: whether the program has not closed it, and neither has the server.
    """

    __slots__ = ("_channels", "_outgoing", "_room", "channel", "is_open")

    def __init__(self, channels: MemoryChannels, channel: int) -> None:
        self._channels = channels
        self._outgoing = bytearray()
        self._room = CHANNEL_WINDOW
        self.channel = channel
        self.is_open = True

    @property
    def time_s(self) -> float:
        """Virtual time."""
        return seconds(self._channels.tick)

    def send(self, data: bytes) -> None:
        """Send to the program; what it has no room for waits here."""
        self._outgoing += data
        self._push()

    def later(self, after_s: float, call: Callable[[], Any]) -> None:
        """Have something called when so much time has passed, if the connection still stands then."""
        self._channels.call(max(1, ticks_for(after_s)), lambda: call() if self.is_open else None)

    def close(self) -> None:
        """Close the connection from this side."""
        if self.is_open:
            self.is_open = False
            self._channels.forget(self.channel)
            self._channels.tell(ChannelClosed(self.channel))

    def credit(self, size: int) -> None:
        """The program has taken so many bytes."""
        self._room += size
        self._push()

    def _push(self) -> None:
        size = min(self._room, len(self._outgoing))
        if size and self.is_open:
            self._channels.tell(ChannelData(self.channel, bytes(self._outgoing[:size])))
            del self._outgoing[:size]
            self._room -= size


class Peer:
    """A server's side of one connection; a test overrides what it needs.

    Args:
        link: the connection.
    """

    def __init__(self, link: Link) -> None:
        self.link = link

    def opened(self) -> None:
        """The connection stands."""

    def received(self, data: bytes) -> None:
        """The program has sent something."""

    def closed(self) -> None:
        """The program has closed."""


Server = Callable[[Link], Peer]


class MemoryChannels:
    """Implements `runtime.world.Channels` with servers in memory.

    Args:
        servers: by port; any address leads to them, and a port without one refuses.

    Attributes:
        servers: may change while a program runs.
        tick: the tick that runs, or ran last.
    """

    __slots__ = ("_due", "_last", "_links", "_sequence", "servers", "tick")

    is_real: Final = False

    def __init__(self, servers: Mapping[int, Server] | None = None) -> None:
        self.servers = dict(servers or {})
        self.tick = 0
        self._last = 0
        self._sequence = 0
        self._links: dict[int, tuple[Link, Peer]] = {}
        self._due: list[tuple[int, int, ChannelEvent | Callable[[], None]]] = []

    # ---------------------------------------------------------------- the program's side

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Connect to the server of a port."""
        self._last += 1
        server = self.servers.get(port)
        if server is None:
            self.tell(ChannelOpened(self._last, False, REFUSED))
            return self._last
        link = Link(self, self._last)
        peer = server(link)
        self._links[self._last] = link, peer
        self.tell(ChannelOpened(self._last, True))
        self.call(1, peer.opened)
        return self._last

    def open_line(self, device: str, settings: LineSettings) -> int:
        """There are no lines here."""
        return 0

    def send(self, channel: int, data: bytes) -> None:
        """Bytes for the server, which has them in the next tick."""
        if channel in self._links:
            _, peer = self._links[channel]
            self.call(1, lambda: peer.received(data))
            self.tell(ChannelCredit(channel, len(data)))

    def credit(self, channel: int, size: int) -> None:
        """See `runtime.world.Channels.credit`."""
        if channel in self._links:
            self._links[channel][0].credit(size)

    def close(self, channel: int) -> None:
        """See `runtime.world.Channels.close`."""
        if channel in self._links:
            link, peer = self._links.pop(channel)
            link.is_open = False
            self.call(1, peer.closed)

    def forget(self, channel: int) -> None:
        """The server has closed."""
        self._links.pop(channel, None)

    # ---------------------------------------------------------------- time

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        """What has happened up to a tick, in order; the servers act in it."""
        self.tick = tick
        events = []
        while self._due and self._due[0][0] <= tick:
            what = heappop(self._due)[2]
            if callable(what):
                what()
            else:
                events.append(what)
        return events

    def next_tick(self, tick: int) -> int | None:
        """The next tick at which a server does something."""
        return max(self._due[0][0], tick + 1) if self._due else None

    def call(self, after_ticks: int, call: Callable[[], Any]) -> None:
        """Have something called after so many ticks."""
        self._put(after_ticks, call)

    def tell(self, event: ChannelEvent) -> None:
        """Let the program hear of something in the next tick."""
        self._put(1, event)

    def _put(self, after_ticks: int, what: ChannelEvent | Callable[[], Any]) -> None:
        self._sequence += 1
        heappush(self._due, (self.tick + after_ticks, self._sequence, what))
