"""Real connections of a run that is run again: what came in is kept with its tick, and comes in again."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from elitescript.devices.outside import OutsideChannels
from elitescript.messages.inputs import ChannelEvent
from elitescript.messages.line import LineSettings


class KeptNetwork:
    """The network of all executions of a source, and what came in on it.

    Args:
        channels: the network of this computer.

    Attributes:
        live: the network.
        arrived: events by the tick in which they were taken in.
        opened: requests to connect, and the channel that each got.
        refused: what was not let through, in words, if that was asked for.
        requests: how many requests the network has had.
        said: what was said before peers were reached, each with the number of the request.
        until: last tick up to which events are kept.
    """

    __slots__ = ("arrived", "live", "opened", "refused", "requests", "said", "until")

    def __init__(self, channels: OutsideChannels) -> None:
        self.live = channels
        self.refused = ""
        self.said: list[tuple[int, str]] = []
        self.arrived: list[tuple[int, tuple[ChannelEvent, ...]]] = []
        self.opened: list[tuple[int, int]] = []
        self.requests = 0
        self.until = -1

    def forget(self, requests: int) -> None:
        """Forget the requests behind a number, which have come to nothing, and close what they have opened."""
        if self.requests <= requests:
            return
        self.requests = requests
        self.said = [(number, text) for number, text in self.said if number <= requests]
        for number, channel in self.opened:
            if number > requests:
                self.live.close(channel)
        self.opened = [(number, channel) for number, channel in self.opened if number <= requests]


class KeptChannels:
    """The network as one execution has it: kept events first, then the network itself.

    What the execution asks of the network is not asked a second time. Implements `runtime.environment.Channels`.

    Args:
        network: see `KeptNetwork`.
        say: receives a sentence before each peer is reached: the same at the same place of each execution.
    """

    __slots__ = ("_network", "_next", "_opened", "_requests", "say")

    def __init__(self, network: KeptNetwork, say: Callable[[str], None]) -> None:
        self.say = say
        self._network = network
        self._next = 0
        self._opened = 0
        self._requests = 0

    @property
    def _is_live(self) -> bool:
        return self._requests >= self._network.requests and self._next >= len(self._network.arrived)

    @property
    def is_real(self) -> bool:
        return self._is_live and self._network.live.is_real

    def _is_new(self) -> bool:
        """Count a request; return whether the network has not had it."""
        self._requests += 1
        if self._requests <= self._network.requests:
            for number, text in self._network.said:
                if number == self._requests:
                    self.say(text)
            return False
        self._network.requests = self._requests
        self._network.live.say = self._say_first
        return True

    def _say_first(self, text: str) -> None:
        self._network.said.append((self._requests, text))
        self.say(text)

    def _channel(self, made: int | None) -> int:
        network = self._network
        if made is not None:
            network.opened.append((self._requests, made))
        self._opened += 1
        return network.opened[self._opened - 1][1] if self._opened <= len(network.opened) else 0

    def open(self, address: str, port: int, timeout_s: float) -> int:
        return self._channel(self._network.live.open(address, port, timeout_s) if self._is_new() else None)

    def open_line(self, device: str, settings: LineSettings) -> int:
        return self._channel(self._network.live.open_line(device, settings) if self._is_new() else None)

    def send(self, channel: int, data: bytes) -> None:
        if self._is_new():
            self._network.live.send(channel, data)

    def credit(self, channel: int, size: int) -> None:
        if self._is_new():
            self._network.live.credit(channel, size)

    def close(self, channel: int) -> None:
        if self._is_new():
            self._network.live.close(channel)

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        network = self._network
        found: list[ChannelEvent] = []
        while self._next < len(network.arrived) and network.arrived[self._next][0] <= tick:
            found += network.arrived[self._next][1]
            self._next += 1
        if tick > network.until and self._is_live:
            network.until = tick
            events = tuple(network.live.arrivals(tick))
            if events:
                network.arrived.append((tick, events))
                self._next += 1
                found += events
        return found

    def next_tick(self, tick: int) -> int | None:
        network = self._network
        if self._next < len(network.arrived):
            return max(tick + 1, network.arrived[self._next][0])
        if tick < network.until:
            return network.until + 1 if network.live.next_tick(network.until) is not None else None
        return network.live.next_tick(tick)

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        return self._network.live.pending(ignoring) if self._is_live else ()

    def give_up(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        return self._network.live.give_up(ignoring) if self._is_live else ()

    def take_refused(self) -> str:
        """Return what was not let through, the same for each execution: it is asked of the network once."""
        self._network.refused = self._network.live.take_refused() or self._network.refused
        return self._network.refused
