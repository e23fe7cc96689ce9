"""Channels that somebody else holds: what programs ask for is collected, the host is told what comes of it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

from elitescript.messages.inputs import ChannelEvent
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import (
    ChannelRequest,
    CloseChannel,
    CreditChannel,
    OpenChannel,
    OpenLine,
    SendChannel,
)
from elitescript.runtime.environment import Channels, Files

TCP: Final = "tcp"


class RequestEnvironment:
    """The world of a robot that has no network of its own.

    Attributes:
        files: the task folder.
        channels: collect what is asked for.
    """

    __slots__ = ("channels", "files")

    def __init__(self, files: Files) -> None:
        self.files = files
        self.channels = RequestChannels()


class FaultyEnvironment:
    """A world with another network.

    Args:
        files: the task folder.
        channels: the network.
    """

    __slots__ = ("channels", "files")

    def __init__(self, files: Files, channels: Channels) -> None:
        self.files = files
        self.channels = channels


class RequestChannels:
    """Implements `runtime.environment.Channels` for a robot that has no network of its own."""

    __slots__ = ("_last", "_requests")

    is_real: Final = False

    def __init__(self) -> None:
        self._last = 0
        self._requests: list[ChannelRequest] = []

    def take(self) -> tuple[ChannelRequest, ...]:
        """Return what was asked for since the last call, in order."""
        requests, self._requests = tuple(self._requests), []
        return requests

    def open(self, address: str, port: int, timeout_s: float) -> int:
        """Ask for a connection; numbers begin with 1 and do not return."""
        self._last += 1
        self._requests.append(OpenChannel(self._last, TCP, address, port, timeout_s))
        return self._last

    def open_line(self, device: str, settings: LineSettings) -> int:
        """Ask for a serial line; it has the next number of a channel."""
        self._last += 1
        self._requests.append(OpenLine(self._last, device, settings))
        return self._last

    def send(self, channel: int, data: bytes) -> None:
        """See `runtime.environment.Channels.send`."""
        self._requests.append(SendChannel(channel, data))

    def credit(self, channel: int, size: int) -> None:
        """See `runtime.environment.Channels.credit`."""
        self._requests.append(CreditChannel(channel, size))

    def close(self, channel: int) -> None:
        """See `runtime.environment.Channels.close`."""
        self._requests.append(CloseChannel(channel))

    def arrivals(self, tick: int) -> Sequence[ChannelEvent]:
        """Nothing: whoever holds the connections tells the host."""
        return ()

    def pending(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        """Not known here: whoever holds the connections brings to its end what was asked for."""
        return ()

    def give_up(self, ignoring: Collection[int] = ()) -> tuple[str, ...]:
        """Not done here."""
        return ()

    def next_tick(self, tick: int) -> int | None:
        """Not known here."""
        return None
