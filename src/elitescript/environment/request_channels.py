"""Channels that are held elsewhere: what programs ask for is collected, and channel events come as inputs."""

from __future__ import annotations

from typing import Final

from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import (
    ChannelRequest,
    CloseChannel,
    CreditChannel,
    OpenChannel,
    OpenLine,
    SendChannel,
)
from elitescript.runtime.environment import Channels, Files, NoChannels

TCP: Final = "tcp"


class RequestEnvironment:
    """Task folder and network of a robot that has no network of its own.

    Args:
        files: the task folder.
        channels: the network; one that collects what is asked for if None.
    """

    __slots__ = ("channels", "files")

    def __init__(self, files: Files, channels: Channels | None = None) -> None:
        self.files = files
        self.channels: Channels = RequestChannels() if channels is None else channels


class RequestChannels(NoChannels):
    """Implements `runtime.environment.Channels` for a robot that has no network of its own."""

    __slots__ = ("_last", "_requests")

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
        self._requests.append(SendChannel(channel, data))

    def credit(self, channel: int, size: int) -> None:
        self._requests.append(CreditChannel(channel, size))

    def close(self, channel: int) -> None:
        self._requests.append(CloseChannel(channel))
