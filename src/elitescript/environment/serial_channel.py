"""One serial port of this computer, or a pseudo-terminal, that is never waited for."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from time import monotonic
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import CHANNEL_WINDOW

_FAILURES: tuple[type[Exception], ...] = (OSError, ValueError)
"""What pyserial and the system raise for a port that does not do what it is asked."""

if sys.platform != "win32":
    from termios import error as _termios_error

    _FAILURES += (_termios_error,)

CLOSING_S: Final = 2.0
"""How long a port that is closed may take to get rid of what was sent."""

_PARITIES: Final = ("N", "O", "E")


class SerialChannel:
    """A serial port, opened at once. What comes in beyond `room` waits in the system.

    Args:
        channel: its number.
        device: name of the port on this computer.
        settings: of the line.

    Attributes:
        room: bytes that may come.
        device: see above.
        lost: bytes that were sent and had not left when the port was closed.
        is_over: whether nothing will come any more; the port is closed then.
    """

    __slots__ = (
        "_channel",
        "_closing_end_s",
        "_failure",
        "_is_open",
        "_left",
        "_outgoing",
        "_port",
        "device",
        "is_over",
        "lost",
        "room",
    )

    def __init__(self, channel: int, device: str, settings: LineSettings) -> None:
        self._channel = channel
        self._port: Any = None
        self._failure = ""
        self._is_open = False
        self._outgoing = bytearray()
        self._left = 0
        self._closing_end_s = 0.0
        self.device = device
        self.lost = 0
        self.room = CHANNEL_WINDOW
        self.is_over = False
        try:
            self._port = require("serial").Serial(
                device,
                baudrate=settings.baud,
                bytesize=settings.size,
                parity=_PARITIES[settings.parity],
                stopbits=settings.stop_bits,
                timeout=0,
                write_timeout=0,
                exclusive=True if os.name == "posix" else None,
            )
        except UsageError as error:
            self._failure = str(error)
        except _FAILURES as error:
            self._failure = _words(error)

    @property
    def place(self) -> str:
        """Name of the port; for messages."""
        return self.device

    @property
    def unsent(self) -> int:
        """Bytes that the system has not taken yet."""
        return len(self._outgoing)

    @property
    def pending(self) -> int:
        """Bytes that are not out of the port yet, as far as the system reports it."""
        try:
            return len(self._outgoing) + (0 if self._port is None else self._port.out_waiting)
        except _FAILURES:
            return len(self._outgoing)

    def send(self, data: bytes) -> None:
        """Send what the port takes now, the rest at a later `poll`."""
        self._outgoing += data
        with suppress(*_FAILURES):
            self._flush()

    def poll(self) -> list[ChannelEvent]:
        """Go on with what is under way; return what has happened."""
        if self._failure:
            self.is_over = True
            return [ChannelOpened(self._channel, False, self._failure)]
        events: list[ChannelEvent] = []
        if not self._is_open:
            self._is_open = True
            events.append(ChannelOpened(self._channel, True))
        reason = ""
        try:
            self._flush()
            while self.room > 0 and (data := self._port.read(self.room)):
                self.room -= len(data)
                events.append(ChannelData(self._channel, bytes(data)))
        except _FAILURES as error:
            reason = _words(error)
        if self._left:
            events.append(ChannelCredit(self._channel, self._left))
            self._left = 0
        if reason:
            self.drop()
            events.append(ChannelClosed(self._channel, reason, ChannelError.OTHER))
        return events

    @property
    def has_left(self) -> bool:
        """Whether all that was sent is out of the port, or never will be."""
        if self._port is None:
            return True
        try:
            self._flush()
            return not self._outgoing and not self._port.out_waiting
        except _FAILURES:
            return True

    def close(self) -> None:
        """Begin to close the port, which ends at once if all that was sent has left it; else call `leave`."""
        self._closing_end_s = monotonic() + CLOSING_S
        self.leave()

    def leave(self) -> None:
        """Go on with closing."""
        if self.has_left or monotonic() >= self._closing_end_s:
            self.drop()

    def discard(self) -> None:
        """Drop what has not left the port."""
        self._left += len(self._outgoing)
        self._outgoing.clear()
        with suppress(*_FAILURES):
            if self._port is not None and self._port.out_waiting:
                self._port.reset_output_buffer()

    def drop(self) -> None:
        """Close the port at once. What has not left it is lost: some systems would wait for it for half a minute."""
        self.is_over = True
        self.lost = self.pending
        if self._port is not None:
            with suppress(*_FAILURES):
                if self._port.out_waiting:
                    self._port.reset_output_buffer()
            with suppress(*_FAILURES):
                self._port.close()
            self._port = None

    def _flush(self) -> None:
        while self._outgoing and self._port is not None:
            size = self._write(self._outgoing)
            if not size:
                return
            del self._outgoing[:size]
            self._left += size

    def _write(self, data: bytearray) -> int:
        if os.name != "posix":
            return self._port.write(data) or 0
        # pyserial tries again and again, without a pause, when the system takes nothing.
        try:
            return os.write(self._port.fileno(), data)
        except BlockingIOError:
            return 0


def _words(error: Exception) -> str:
    return str(getattr(error, "strerror", None) or str(error) or type(error).__name__)
