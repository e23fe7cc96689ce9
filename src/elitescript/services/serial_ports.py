"""The serial ports of this computer that a robot's programs use. They are looked at once in every period."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from elitescript.messages.inputs import ChannelClosed, Input
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.messages.timing import PERIOD_S

if TYPE_CHECKING:
    from elitescript.worlds.serial_channel import SerialChannel

UNSENT_MAX: Final = 4 * CHANNEL_WINDOW
"""Bytes that may wait for a port; who keeps to the window stays below it."""


class SerialPorts:
    """The ports that are open.

    Args:
        post: takes what the robot is to hear.
    """

    __slots__ = ("_open", "_post", "_timer")

    def __init__(self, post: Callable[[list[Input]], None]) -> None:
        self._post = post
        self._open: dict[int, SerialChannel] = {}
        self._timer: asyncio.TimerHandle | None = None

    def __contains__(self, number: int) -> bool:
        return number in self._open

    def open(self, number: int, device: str, settings: LineSettings) -> None:
        """Open a port of this computer, or say why that cannot be."""
        # Few robots have one, and the ports of this computer take their time to load.
        from elitescript.worlds.serial_channel import SerialChannel

        self._open[number] = SerialChannel(number, device, settings)
        self._look()

    def send(self, number: int, data: bytes) -> None:
        """Send bytes; a port for which too many wait is closed."""
        channel = self._open[number]
        if channel.unsent + len(data) > UNSENT_MAX:
            self.close(number)
            self._post([ChannelClosed(number, f"{UNSENT_MAX} bytes wait for a port that takes none")])
        else:
            channel.send(data)

    def credit(self, number: int, size: int) -> None:
        """The program has taken so many bytes."""
        channel = self._open[number]
        channel.room = min(channel.room + max(size, 0), CHANNEL_WINDOW)

    def close(self, number: int) -> None:
        """Close a port; no effect on an unknown one."""
        if number in self._open:
            self._open.pop(number).close()

    def close_all(self) -> None:
        """Close every port."""
        for number in list(self._open):
            self.close(number)

    def _look(self) -> None:
        """Let the robot hear what has happened at every port."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        for number, channel in list(self._open.items()):
            if events := channel.poll():
                self._post(list(events))
            if channel.is_over:
                del self._open[number]
        if self._open:
            self._timer = asyncio.get_running_loop().call_later(PERIOD_S, self._look)
