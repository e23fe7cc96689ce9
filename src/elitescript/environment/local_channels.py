"""TCP connections and serial ports of this computer, looked at between two ticks.

Where they lead is decided by the option `network` of the robot; see `reach`. What it does not let through is as an
address without a host: there is an event that says so, and no answer. It costs no time of the wall clock.

While one is open, ticks are held back to the wall clock, so that time-outs and polling are what the peer expects.
So they are for a while after a connection was lost, and after each try to make it anew: a peer that comes back after a
second has to find a program that is still waiting for it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from time import perf_counter, sleep
from typing import TYPE_CHECKING, Final

from elitescript.messages.timing import PERIOD_S, TICKS_PER_S
from elitescript.said import Said, counted, joined, said

if TYPE_CHECKING:
    from elitescript.environment.network_option import Way
    from elitescript.environment.reach import Decision, Reach
    from elitescript.environment.serial_channel import SerialChannel
    from elitescript.environment.tcp_channel import TcpChannel
    from elitescript.messages.inputs import ChannelEvent
    from elitescript.messages.line import LineSettings

HOPE_TICKS: Final = 6 * TICKS_PER_S
"""How long a lost connection holds time back; longer than MODBUS signals ever wait before they try again."""


LINGER_S: Final = 0.1
"""How long, at the end of a run, peers that have everything may take to end their side (*assumed*)."""

LOST_MAX: Final = 100
"""Losses on closed channels that are remembered."""

PEERS_MAX: Final = 100
"""Peers that are named, each once, before they are connected to; so many others are named as refused."""

NETWORK_DEFAULT: Final = "local"
NONE: Final = "none"
"""Values of the option; see `reach`."""
NOT_COUNTED: Final = "others"
"""Name of the peers beyond `PEERS_MAX`."""

_LOOK_S: Final = 0.001


def print_error(text: str) -> None:
    """Print a text on the error output."""
    from elitescript.shown import shown

    print(f"elitescript: {shown(text)}", file=sys.stderr, flush=True)


class LocalChannels:
    """Implements `runtime.environment.Channels` with the network and the serial ports of this computer.

    Args:
        lines: what is on the robot's serial ports; see `line_bindings`. They are reached whatever `network` is.
        network: what programs reach; see `reach`.
        is_closed: whether nothing is reached, whatever the option of the robot is.
        say: takes a line for people before the first byte goes to a peer.

    Attributes:
        way: how users set the option, for texts; that of the command line if None.
        refused: how many connections were not let through, by their peers.

    Raises:
        UsageError: a binding or a network that makes no sense.
    """

    __slots__ = (
        "_first_tick",
        "_fixes",
        "_hope_tick",
        "_is_closed",
        "_last",
        "_leaving",
        "_lines",
        "_lost",
        "_met",
        "_network",
        "_open",
        "_places",
        "_reach",
        "_refusals",
        "_said",
        "_start_s",
        "_tick",
        "refused",
        "say",
        "way",
    )

    def __init__(
        self,
        lines: Mapping[str, str] | None = None,
        network: str = NETWORK_DEFAULT,
        *,
        is_closed: bool = False,
        say: Callable[[str], None] = print_error,
    ) -> None:
        self._last = 0
        self._is_closed = is_closed
        self._network = NONE if is_closed else network
        self._reach: Reach | None = None
        self.way: Way | None = None
        self.say = say
        self._said: set[str] = set()
        """Peers that were named."""
        self._refusals: list[ChannelEvent] = []
        """Of connections that are not let through, for the next tick."""
        self.refused: dict[str, int] = {}
        self._fixes: dict[str, None] = {}
        """What would let them through."""
        self._lines: Mapping[str, str] = {}
        if lines:
            from elitescript.environment.line_bindings import check_bindings

            self._lines = check_bindings(lines)
        self._open: dict[int, TcpChannel | SerialChannel] = {}
        self._leaving: list[TcpChannel | SerialChannel] = []
        """Channels that the program has closed, as long as something of what was sent may be under way."""
        self._lost: list[str] = []
        """What was lost on them, for `give_up`."""
        self._places: dict[int, tuple[str, int]] = {}
        """Where each TCP connection leads."""
        self._met: set[tuple[str, int]] = set()
        """Places where a peer has answered."""
        self._tick = 0
        self._hope_tick = 0
        """Until then a lost connection may come back."""
        self._first_tick = -1
        self._start_s = 0.0

    @property
    def is_real(self) -> bool:
        """Whether a connection is open, being opened, being closed with bytes under way, or lost not long ago."""
        if self._open or self._tick < self._hope_tick:
            return True
        return bool(self._leaving) and any(channel.pending for channel in self._leaving)

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Begin to connect, if the options let it through."""
        self._last += 1
        decision = self.decide(address, port)
        if decision.why_not:
            self._refusals.append(self._refuse(self._last, address, port, decision))
        else:
            assert self._reach is not None
            self._connect(address, port, self._reach, decision)
        return self._last

    def decide(self, address: str, port: int) -> Decision:
        """Return what the options let through of an address; nothing is looked up."""
        if self._reach is None:
            # Most programs open no connection, and the network takes its time to load.
            from elitescript.environment.network_option import COMMAND_LINE
            from elitescript.environment.reach import Reach

            self._reach = Reach(self._network, is_closed=self._is_closed, way=self.way or COMMAND_LINE)
        return self._reach.decide(address, port)

    def target(self, device: str) -> str | None:
        """Return what is bound to a serial port of the robot; None if nothing is."""
        return self._lines.get(device)

    @property
    def may_be_real(self) -> bool:
        """Whether anything outside may be reached."""
        return self._network != NONE or bool(self._lines)

    def _connect(self, address: str, port: int, reach: Reach, decision: Decision) -> None:
        from elitescript.environment.addresses import place_of
        from elitescript.environment.tcp_channel import TcpChannel

        self._name_peer(said("the program connects to {place}", place=place_of(address, port)), reach.named)
        self._open[self._last] = TcpChannel(self._last, address, port, reach, decision)
        self._places[self._last] = address, port

    def _refuse(self, channel: int, address: str, port: int, decision: Decision) -> ChannelEvent:
        """Count a connection that is not let through, and return its event."""
        from elitescript.environment.addresses import HOST_MAX, place_of
        from elitescript.messages.enums import ChannelError
        from elitescript.messages.inputs import ChannelOpened
        from elitescript.shown import printable

        place = place_of(printable(address[:HOST_MAX]), port)
        if place not in self.refused and len(self.refused) >= PEERS_MAX:
            place = NOT_COUNTED
        self.refused[place] = self.refused.get(place, 0) + 1
        if decision.fix and place != NOT_COUNTED:
            self._fixes[decision.fix] = None
        return ChannelOpened(channel, False, decision.why_not, ChannelError.BARRED)

    def take_refused(self) -> str:
        """Return in words how many connections were not let through since the last call; empty if there were none."""
        if not self.refused or self._reach is None:
            return ""
        count = sum(self.refused.values())
        peers = joined(
            ", ",
            (
                said("{place} ({times} times)", place=place, times=times) if times > 1 else place
                for place, times in self.refused.items()
            ),
        )
        subject = Said("this closed run") if self._is_closed else self._reach.named
        text = said(
            "{subject} has refused {connections}: {peers}",
            subject=subject,
            connections=counted(count, "connection", "connections"),
            peers=peers,
        )
        if self._fixes:
            text = said(
                "{text}; `{option}` allows it" if len(self._fixes) == 1 else "{text}; `{option}` allows them",
                text=text,
                option=self._reach.allowing(self._fixes),
            )
        self.refused, self._fixes = {}, {}
        return text

    def _name_peer(self, text: str, option: str) -> None:
        """Say that the outside is reached, once for each peer."""
        if text in self._said or len(self._said) > PEERS_MAX:
            return
        self._said.add(text)
        if len(self._said) > PEERS_MAX:
            text = said(
                "the program reaches more than {peers_max} peers; further ones are not named", peers_max=PEERS_MAX
            )
        self.say(f"{text} ({option})")

    def open_line(self, device: str, settings: LineSettings) -> int:
        """Open what is bound to a port; 0 if nothing is."""
        target = self._lines.get(device)
        if target is None:
            return 0
        from elitescript.environment.line_bindings import bridge_address

        address = bridge_address(target)
        self._last += 1
        if address is not None:
            from elitescript.environment.reach import Reach

            # The user has named it.
            reach = Reach("all")
            self._connect(*address, reach, reach.decide(*address))
            return self._last
        from elitescript.environment.serial_channel import SerialChannel

        self._name_peer(
            said("the program opens the serial port {target}", target=target),
            f"--serial {device}={target}",
        )
        self._open[self._last] = SerialChannel(self._last, target, settings)
        return self._last

    def send(self, channel: int, data: bytes) -> None:
        """Send what the connection takes now, the rest between later ticks."""
        if channel in self._open:
            self._open[channel].send(data)

    def credit(self, channel: int, size: int) -> None:
        if channel in self._open:
            self._open[channel].room += size

    def close(self, channel: int) -> None:
        open_channel = self._open.pop(channel, None)
        self._places.pop(channel, None)
        if open_channel is not None:
            open_channel.close()
            self._leaving.append(open_channel)
            self._look_at_leaving()

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        """Wait for the time of a tick and look at every connection."""
        self._tick = tick
        if self._leaving:
            for channel in self._leaving:
                channel.leave()
            self._look_at_leaving()
        events, self._refusals = self._refusals, []
        if not self.is_real:
            self._first_tick = -1
            return events
        self._hold(tick)
        for number, channel in list(self._open.items()):
            found = channel.poll()
            events += found
            place = self._places.get(number)
            # Most programs open none: the class of the event is not worth its import.
            if place is not None and any(getattr(event, "is_open", False) for event in found):
                self._met.add(place)
            if channel.is_over:
                del self._open[number]
                self._places.pop(number, None)
                if place is not None and (decision := getattr(channel, "barred", None)) is not None:
                    events[-1] = self._refuse(number, *place, decision)
                if place in self._met:
                    self._hope_tick = tick + HOPE_TICKS
        return events

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        return tuple(_words(channel, channel.pending) for channel in self._pending(ignoring))

    def give_up(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        """See `runtime.environment.Channels.give_up`; waits for peers that answer the last bytes."""
        end_s = perf_counter() + LINGER_S
        while any(not channel.pending for channel in self._leaving) and perf_counter() < end_s:
            sleep(_LOOK_S)
            for channel in self._leaving:
                channel.leave()
            self._look_at_leaving()
        for channel in self._leaving:
            channel.drop()
        self._look_at_leaving()
        given_up, self._lost = self._lost, []
        for channel in self._pending(ignoring):
            given_up.append(_words(channel, channel.pending))
            channel.discard()
        return tuple(given_up)

    def _pending(self, ignoring: Collection[int]) -> list[TcpChannel | SerialChannel]:
        channels = [*self._leaving, *(channel for number, channel in self._open.items() if number not in ignoring)]
        return [channel for channel in channels if channel.pending]

    def _look_at_leaving(self) -> None:
        """Forget the channels that are closed by now."""
        for channel in self._leaving:
            if channel.is_over and channel.lost and len(self._lost) < LOST_MAX:
                self._lost.append(_words(channel, channel.lost))
        self._leaving = [channel for channel in self._leaving if not channel.is_over]

    def next_tick(self, tick: int) -> int | None:
        """Return every tick while time is held back, and the next one for a connection that is not let through."""
        return tick + 1 if self._refusals or self.is_real else None

    def _hold(self, tick: int) -> None:
        now_s = perf_counter()
        if self._first_tick < 0:
            self._first_tick, self._start_s = tick, now_s
        due_s = self._start_s + (tick - self._first_tick) * PERIOD_S
        if now_s < due_s:
            sleep(due_s - now_s)


def _words(channel: TcpChannel | SerialChannel, size: int) -> str:
    return said("{bytes} to {place}", bytes=counted(size, "byte", "bytes"), place=channel.place)
