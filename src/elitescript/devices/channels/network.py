"""A network in memory, in virtual time: TCP servers by port and serial lines by name.

A server is a class or function that makes a `Peer` for each connection. What a peer does takes effect one tick later at
the earliest, so that the order in which threads run in a tick does not matter, and every run is the same. The public
classes of devices (`elitescript.testing.world`) are made of these.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Final

from elitescript.devices.agenda import Agenda, DeviceError
from elitescript.devices.channels.delay_line import DelayLine
from elitescript.devices.channels.faults import LINE
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.messages.timing import ticks_for
from elitescript.records import replace
from elitescript.runtime.environment import Channels

REFUSED: Final = "connection refused"
NO_LINE: Final = "no device is on this line"

UNSENT_MAX: Final = 16 * 1024 * 1024
"""Bytes that a device may have sent and that are not taken."""


class DeviceLink:
    """One connection or serial line, as the device sees it.

    Attributes:
        channel: number of the channel.
        is_open: whether the program has not closed it, and neither has the device.
        owner: the device; for messages about it.
        place: address and port, or name of the serial line; for messages about it.
        line: name of the serial line; empty for a connection.
        settings: of a serial line; None of a connection.
    """

    __slots__ = (
        "_has_stood",
        "_is_closing",
        "_network",
        "_outgoing",
        "_room",
        "_to_device",
        "_to_program",
        "channel",
        "is_open",
        "line",
        "owner",
        "peer",
        "place",
        "settings",
    )

    def __init__(
        self,
        network: VirtualNetwork,
        channel: int,
        line: str = "",
        settings: LineSettings | None = None,
        *,
        place: str = "",
    ) -> None:
        self._network = network
        self._outgoing = bytearray()
        self._room = CHANNEL_WINDOW
        self._is_closing = False
        self._has_stood = False
        self.channel = channel
        self.line = line
        self.place = place or line
        self.settings = settings
        self.is_open = True
        self.owner: object = None
        self.peer: Peer
        self.shape()

    def shape(
        self, *, latency_s: float = 0.0, chunk: int = 0, delay: Callable[[], int] | None = None, owner: object = None
    ) -> None:
        """Say how bytes go over it, before any has.

        Args:
            latency_s: time that bytes of the device take, besides that of a serial line's characters.
            chunk: most bytes of the device that arrive in one tick; 0 for any number.
            delay: further ticks, drawn for each sending.
            owner: the device.
        """
        agenda, self.owner = self._network.agenda, owner
        character_s = 0.0 if self.settings is None else self.settings.character_s
        self._to_device = DelayLine(agenda, self._hand_to_device, byte_s=character_s, owner=owner)
        self._to_program = DelayLine(
            agenda,
            self._hand_to_program,
            byte_s=character_s,
            latency_s=latency_s,
            chunk=chunk,
            delay=delay,
            owner=owner,
        )

    @property
    def time_s(self) -> float:
        """Virtual time."""
        return self._network.agenda.time_s

    # ---------------------------------------------------------------- called by the device

    def send(self, data: bytes) -> None:
        """Send to the program; what it has no room for waits here.

        Raises:
            DeviceError: more than `UNSENT_MAX` bytes wait.
        """
        if not self.is_open:
            return
        self._outgoing += data
        if len(self._outgoing) > UNSENT_MAX:
            raise DeviceError(f"more than {UNSENT_MAX} bytes were sent that the program does not read")
        self._push()

    def later(self, after_s: float, call: Callable[[], Any]) -> None:
        """Make a call when so much time has passed, if the connection still stands then."""
        act = lambda: call() if self.is_open else None  # noqa: E731
        self._network.agenda.put(max(1, ticks_for(after_s)), act, self.owner)

    def close(self) -> None:
        """Close it from this side, once the program has what was sent."""
        if self.is_open:
            self.is_open = False
            self._is_closing = True
            self._push()

    # ---------------------------------------------------------------- called for the program

    def take(self, data: bytes) -> None:
        """Take bytes of the program."""
        if self.is_open:
            self._to_device.send(data)

    def credit(self, size: int) -> None:
        """Send on: the program has taken so many bytes."""
        self._room += size
        self._push()

    def leave(self) -> None:
        """Close from the program's side; the device gets what was sent before."""
        self.is_open = False
        self._outgoing.clear()
        if self._has_stood:
            self._to_device.finish(self.peer.closed)
        else:
            self.peer.given_up()

    @property
    def pending(self) -> str:
        """What the program has given away and the device does not have; empty if it has everything."""
        wire = self._to_device
        if wire.under_way:
            return f"{wire.under_way} bytes to {self.place}"
        return f"the end of the connection to {self.place}" if wire.is_ending else ""

    def drop(self) -> None:
        """Forget what is on its way to the device, and bring the end of the connection that waits behind it."""
        is_ending = self._to_device.is_ending
        dropped = self._to_device.drop()
        if is_ending:
            self._network.agenda.attempt(self.peer.closed, self.owner)
        else:
            self._network.tell(ChannelCredit(self.channel, dropped))

    def stand(self) -> None:
        """Let the connection stand from now on."""
        if self.is_open:
            self._has_stood = True
            self._network.tell(ChannelOpened(self.channel, True))
            self.peer.opened()

    def _push(self) -> None:
        size = min(self._room, len(self._outgoing))
        if size:
            self._to_program.send(bytes(self._outgoing[:size]))
            del self._outgoing[:size]
            self._room -= size
        if self._is_closing and not self._outgoing:
            self._is_closing = False
            self._to_program.finish(lambda: self._network.end(self.channel))

    def _hand_to_program(self, data: bytes) -> None:
        self._network.tell(ChannelData(self.channel, data))

    def _hand_to_device(self, data: bytes) -> None:
        self._network.tell(ChannelCredit(self.channel, len(data)))
        self.peer.received(data)


class Peer:
    """A device's side of one connection; a test overrides what it needs.

    Args:
        link: the connection.
    """

    def __init__(self, link: DeviceLink) -> None:
        self.link = link

    def opened(self) -> None:
        """Act on a connection that stands."""

    def received(self, data: bytes) -> None:
        """Take bytes of the program."""

    def closed(self) -> None:
        """Act on the end: the program has closed."""

    def given_up(self) -> None:
        """Act on a program that has closed before the connection stood; nothing else is called."""


Server = Callable[[DeviceLink], Peer | None]
"""Makes what is at the other end of a new connection; None refuses it."""

Endpoint = int | tuple[str, int]
"""A port of any address, or of one."""


class VirtualNetwork:
    """Implements `runtime.environment.Channels` with servers and lines in memory.

    Args:
        servers: by port, or by address and port; a port without one refuses.
        lines: what is on serial lines, by device name.
        agenda: of the world, if there is more in it than this.
        outside: where everything leads that is not declared here; nowhere if None.

    Attributes:
        servers: may change while a program runs.
        lines: may change as well.
        agenda: what happens when.
        outside: see above.
    """

    __slots__ = ("_events", "_inner", "_last", "_leaving", "_links", "_outer", "agenda", "lines", "outside", "servers")

    def __init__(
        self,
        servers: Mapping[int, Server] | Mapping[Endpoint, Server] | None = None,
        lines: Mapping[str, Server] | None = None,
        *,
        agenda: Agenda | None = None,
        outside: Channels | None = None,
    ) -> None:
        self.servers: dict[Endpoint, Server] = {}
        for endpoint, server in (servers or {}).items():
            self.servers[endpoint] = server
        self.lines: dict[str, Server] = dict(lines or {})
        self.agenda = Agenda() if agenda is None else agenda
        self.outside = outside
        self._last = 0
        self._links: dict[int, DeviceLink] = {}
        self._leaving: list[DeviceLink] = []
        """Links that the program has closed and whose device does not have everything yet."""
        self._events: list[ChannelEvent] = []
        self._inner: dict[int, int] = {}
        """Channels that lead outside: number here, number there; and the other way round."""
        self._outer: dict[int, int] = {}

    @property
    def is_real(self) -> bool:
        """Whether a channel leads to a peer that lives in wall-clock time."""
        return self.outside is not None and self.outside.is_real

    @property
    def tick(self) -> int:
        """The tick that runs, or ran last."""
        return self.agenda.tick

    # ---------------------------------------------------------------- servers and lines

    def server(self, address: str, port: int) -> Server | None:
        """Return the server that listens there."""
        return self.servers.get((address, port)) or self.servers.get(port)

    def _hosts(self) -> set[str]:
        """Return the addresses at which devices are, which have no other ports than theirs."""
        return {endpoint[0] for endpoint in self.servers if isinstance(endpoint, tuple)}

    def owners(self, kind: str, address: str, port: int) -> list[object]:
        """Return what is at the place of a fault, see `faults.place_of`."""
        if kind == LINE:
            found = [self.lines.get(address)]
        elif address:
            found = [self.server(address, port)]
        else:
            found = [server for endpoint, server in self.servers.items() if endpoint == port or _is_on(endpoint, port)]
        return [owner for server in found if server is not None and (owner := _owner(server)) is not None]

    def places(self, owner: object) -> list[int | str]:
        """Return ports and lines that a device has, as the places of faults."""
        found: list[int | str] = []
        for endpoint, server in self.servers.items():
            if _owner(server) is owner:
                found.append(endpoint if isinstance(endpoint, int) else f"{endpoint[0]}:{endpoint[1]}")
        return [*found, *(line for line, server in self.lines.items() if _owner(server) is owner)]

    def connect(self, channel: int, address: str, port: int) -> None:
        """Connect a channel to the server of a port, or refuse."""
        server = self.server(address, port)
        self._begin(DeviceLink(self, channel, place=f"{address}:{port}"), server, REFUSED, ChannelError.REFUSED)

    def connect_line(self, channel: int, device: str, settings: LineSettings) -> None:
        """Connect a channel to what is on a serial line, or refuse. The channel that had the line before loses it."""
        for link in [link for link in self._links.values() if link.line == device]:
            self.close(link.channel)
        self._begin(DeviceLink(self, channel, device, settings), self.lines.get(device), NO_LINE, ChannelError.OTHER)

    def _begin(self, link: DeviceLink, server: Server | None, refusal: str, error: ChannelError) -> None:
        peer = None if server is None else server(link)
        if peer is None:
            self.agenda.put(1, lambda: self.tell(ChannelOpened(link.channel, False, refusal, error)))
            return
        link.peer = peer
        self._links[link.channel] = link
        self.agenda.put(1, link.stand, link.owner)

    # ---------------------------------------------------------------- called for the program

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Connect to the server of a port."""
        if self.outside is not None and self.server(address, port) is None and address not in self._hosts():
            return self._lead_outside(self.outside.open(address, port, timeout_s))
        self._last += 1
        self.connect(self._last, address, port)
        return self._last

    def open_line(self, device: str, settings: LineSettings) -> int:
        """Connect to what is on a serial line; 0 if nothing is."""
        if device in self.lines:
            self._last += 1
            self.connect_line(self._last, device, settings)
            return self._last
        return 0 if self.outside is None else self._lead_outside(self.outside.open_line(device, settings))

    def _lead_outside(self, inner: int) -> int:
        if not inner:
            return 0
        self._last += 1
        self._inner[self._last] = inner
        self._outer[inner] = self._last
        return self._last

    def send(self, channel: int, data: bytes) -> None:
        """Send bytes to the device, which has them in the next tick, or later at the speed of a line."""
        if channel in self._links:
            self._links[channel].take(data)
        elif self.outside is not None and channel in self._inner:
            self.outside.send(self._inner[channel], data)

    def credit(self, channel: int, size: int) -> None:
        if channel in self._links:
            self._links[channel].credit(size)
        elif self.outside is not None and channel in self._inner:
            self.outside.credit(self._inner[channel], size)

    def close(self, channel: int) -> None:
        if channel in self._links:
            link = self._links.pop(channel)
            link.leave()
            self._leaving = [one for one in (*self._leaving, link) if one.pending]
        elif self.outside is not None and channel in self._inner:
            inner = self._inner.pop(channel)
            del self._outer[inner]
            self.outside.close(inner)

    # ---------------------------------------------------------------- the devices' side

    def tell(self, event: ChannelEvent) -> None:
        """Give the program an event in this tick, unless it has closed the channel."""
        if isinstance(event, ChannelOpened) or event.channel in self._links:
            self._events.append(event)

    def end(self, channel: int, reason: str = "") -> None:
        """Close a channel from the device's side; the program gets the event in this tick."""
        self.tell(ChannelClosed(channel, reason, ChannelError.OTHER if reason else ChannelError.RESET))
        self._links.pop(channel, None)

    def drop(self, owner: object, reason: str) -> None:
        """Take a device away: its channels break, its ports and lines refuse."""
        for link in [link for link in self._links.values() if link.owner is owner]:
            link.is_open = False
            self.end(link.channel, reason)
        for endpoint in [endpoint for endpoint, server in self.servers.items() if _owner(server) is owner]:
            self.servers[endpoint] = _nobody
        for line in [line for line, server in self.lines.items() if _owner(server) is owner]:
            self.lines[line] = _nobody

    @property
    def open_channels(self) -> int:
        """How many channels are open or about to be."""
        return len(self._links)

    # ---------------------------------------------------------------- time

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        """Return what has happened up to a tick, in order; the devices act in it."""
        self.agenda.run(tick)
        events, self._events = self._events, []
        if self.outside is not None:
            for event in self.outside.arrivals(tick):
                channel = self._outer.get(event.channel)
                if channel is not None:
                    events.append(replace(event, channel=channel))
                    if isinstance(event, ChannelClosed) or (isinstance(event, ChannelOpened) and not event.is_open):
                        del self._inner[channel], self._outer[event.channel]
        return events

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        own = tuple(text for link in self._pending(ignoring) if (text := link.pending))
        return own if self.outside is None else (*own, *self.outside.pending(self._led_outside(ignoring)))

    def give_up(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        given_up = []
        for link in self._pending(ignoring):
            if text := link.pending:
                given_up.append(text)
                link.drop()
        self._leaving.clear()
        if self.outside is not None:
            given_up += self.outside.give_up(self._led_outside(ignoring))
        return tuple(given_up)

    def _pending(self, ignoring: Collection[int]) -> list[DeviceLink]:
        return [*self._leaving, *(link for channel, link in self._links.items() if channel not in ignoring)]

    def _led_outside(self, channels: Collection[int]) -> list[int]:
        return [self._inner[channel] for channel in channels if channel in self._inner]

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick at which a device does something."""
        due = self.agenda.next_tick(tick)
        other = None if self.outside is None else self.outside.next_tick(tick)
        return due if other is None else other if due is None else min(due, other)


def _is_on(endpoint: Endpoint, port: int) -> bool:
    return isinstance(endpoint, tuple) and endpoint[1] == port


def _owner(server: Server) -> object:
    return getattr(server, "__self__", None)


def _nobody(link: DeviceLink) -> None:
    """Refuse."""
