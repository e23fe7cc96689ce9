"""Holds one configured serial port of the robot; it stays configured when the program ends."""

from __future__ import annotations

from typing import Final

from elitescript.messages.inputs import ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.timing import ticks_for
from elitescript.runtime.connections.connection import Receiver, ScriptConnection
from elitescript.runtime.connections.traffic import ChannelLog
from elitescript.runtime.environment import Channels, NoChannels
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.runtime.threads.turns import Turns

CLOSED: Final = "CLOSE"
PLAIN: Final = "RS485"
MODBUS: Final = "MODBUS-RTU"
"""Modes as scripts read them."""


class LineConnection(ScriptConnection):
    """The channel of a line. Attribute `has_heard`: whether bytes have come since it was cleared."""

    __slots__ = ("has_heard",)

    def __init__(self, channel: int, channels: Channels, scheduler: Scheduler, log: ChannelLog) -> None:
        super().__init__(channel, channels, scheduler, log)
        self.has_heard = False

    def take(self, event: ChannelEvent) -> None:
        if isinstance(event, ChannelData):
            self.has_heard = True
        super().take(event)


class SilentLineConnection(LineConnection):
    """A line with nothing at its other end: sent bytes are lost, none are received."""

    __slots__ = ()

    def __init__(self, scheduler: Scheduler, log: ChannelLog) -> None:
        super().__init__(0, NoChannels(), scheduler, log)
        self.take(ChannelOpened(0, True))

    def send(self, data: bytes) -> None:
        self.log.sent(data)
        self.queued += len(data)
        self.sent += len(data)


class SerialLine:
    """A serial port.

    Args:
        scheduler: of the threads that use it.

    Attributes:
        settings: of its characters.
        mode: `PLAIN` or `MODBUS`, whether it is open or not.
        is_daemons: whether it belongs to a daemon and scripts may not use it.
        wire: its channel; None while it is closed.
        readers: lock of the reading thread.
        masters: lock of the thread that sends a request to a slave.
        quiet_tick: before this tick no request may be sent.
        has_echo: whether an echo of sent bytes was detected.
        repeated: the last request, if its echo would look like its response.
    """

    __slots__ = (
        "has_echo",
        "is_daemons",
        "masters",
        "mode",
        "quiet_tick",
        "readers",
        "repeated",
        "settings",
        "wire",
    )

    def __init__(self, scheduler: Scheduler) -> None:
        self.settings = LineSettings(9600, 0, 1, 8)
        self.mode = PLAIN
        self.is_daemons = False
        self.wire: LineConnection | None = None
        self.readers = Turns(scheduler)
        self.masters = Turns(scheduler)
        self.quiet_tick = 0
        self.has_echo = False
        self.repeated = b""

    @property
    def is_open(self) -> bool:
        """Whether it is enabled and its device present."""
        return self.is_daemons or (self.wire is not None and self.wire.is_open)

    def close(self, connections: dict[int, Receiver]) -> None:
        """Disable it: received bytes are lost, waiting threads go on."""
        self.is_daemons = False
        wire, self.wire = self.wire, None
        if wire is not None:
            wire.close()
            connections.pop(wire.channel, None)

    def begin(self, settings: LineSettings, mode: str) -> None:
        """Take over settings."""
        self.settings, self.mode = settings, mode
        self.quiet_tick, self.has_echo, self.repeated = 0, False, b""

    def ticks_of(self, size: int) -> int:
        """Return the ticks for `size` characters, rounded up."""
        return ticks_for(size * self.settings.character_s)


def close_lines(lines: dict[str, SerialLine], connections: dict[int, Receiver]) -> None:
    """Close every port: the controller restarts."""
    for line in lines.values():
        line.close(connections)
    lines.clear()
