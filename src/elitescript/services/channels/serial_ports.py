"""The serial ports of this computer that a robot's programs use. They are looked at once in every period."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import AddLog, ChannelClosed, Input
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.messages.timing import PERIOD_S

if TYPE_CHECKING:
    from elitescript.environment.serial_channel import SerialChannel

LINGER_S: Final = 5.0
"""How long a port that is closed has to get rid of what was sent before."""
UNSENT_MAX: Final = 4 * CHANNEL_WINDOW
"""Bytes that may wait for a port; within the window of a channel there are fewer."""


class SerialPorts:
    """The ports that are open.

    Args:
        post: takes inputs of the robot.
    """

    __slots__ = ("_leaving", "_open", "_post", "_timer")

    def __init__(self, post: Callable[[list[Input]], object]) -> None:
        self._post = post
        self._open: dict[int, SerialChannel] = {}
        self._leaving: list[tuple[float, SerialChannel]] = []
        """Ports that are closed and may still get rid of what was sent before, with the time until which they may."""
        self._timer: asyncio.TimerHandle | None = None

    def __contains__(self, number: int) -> bool:
        return number in self._open

    def open(self, number: int, device: str, settings: LineSettings) -> None:
        """Open a port of this computer, or post why that cannot be."""
        # Few robots have one, and the ports of this computer take their time to load.
        from elitescript.environment.serial_channel import SerialChannel

        for leaving in self._leaving:
            if leaving[1].device == device:
                leaving[1].drop()
        self._open[number] = SerialChannel(number, device, settings)
        self._look()

    def send(self, number: int, data: bytes) -> None:
        """Send bytes; a port for which too many wait is closed."""
        channel = self._open[number]
        if channel.unsent + len(data) > UNSENT_MAX:
            self._open.pop(number).drop()
            self._post(
                [ChannelClosed(number, f"{UNSENT_MAX} bytes wait for a port that takes none", ChannelError.OTHER)]
            )
        else:
            channel.send(data)

    def credit(self, number: int, size: int) -> None:
        """Give a port credit for bytes that the program has taken."""
        channel = self._open[number]
        channel.room = min(channel.room + max(size, 0), CHANNEL_WINDOW)

    def close(self, number: int) -> None:
        """Close a port once what was sent has left it; no effect on an unknown one."""
        channel = self._open.pop(number, None)
        if channel is None:
            return
        if channel.has_left:
            channel.drop()
        else:
            self._leaving.append((asyncio.get_running_loop().time() + LINGER_S, channel))

    def close_all(self) -> None:
        """Close every port at once."""
        for channel in (*self._open.values(), *(channel for _, channel in self._leaving)):
            channel.drop()
        self._open.clear()
        self._leaving.clear()

    def _look(self) -> None:
        """Post what has happened at every port."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        for number, channel in list(self._open.items()):
            if events := channel.poll():
                self._post(list(events))
            if channel.is_over:
                del self._open[number]
        loop = asyncio.get_running_loop()
        self._leaving = [entry for entry in self._leaving if not self._has_gone(*entry, loop.time())]
        if self._open or self._leaving:
            self._timer = loop.call_later(PERIOD_S, self._look)

    def _has_gone(self, until_s: float, channel: SerialChannel, now_s: float) -> bool:
        if not channel.is_over and (channel.has_left or now_s > until_s):
            channel.drop()
            if channel.lost:
                self._post([AddLog("", f"not delivered: {channel.lost} bytes to {channel.place}", is_warning=True)])
        return channel.is_over
