"""One TCP connection of this computer that is never waited for."""

from __future__ import annotations

import errno
import socket
import sys
from contextlib import suppress
from errno import EINPROGRESS, EINTR, EWOULDBLOCK
from os import strerror
from threading import Thread
from time import monotonic
from typing import Any, Final

from elitescript.environment.reach import Decision, Reach
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.said import said

CLOSING_S: Final = 2.0
"""How long a connection that is closed may take to get rid of what was sent."""

_UNREAD_MAX: Final = 1 << 20
"""Bytes that are read and dropped before a connection is closed: unread ones would make the peer lose the last text."""


_ERRORS: Final = {
    errno.EPIPE: ChannelError.BROKEN_PIPE,
    errno.ENETUNREACH: ChannelError.NETWORK_UNREACHABLE,
    errno.ECONNRESET: ChannelError.RESET,
    errno.ETIMEDOUT: ChannelError.TIMED_OUT,
    errno.ECONNREFUSED: ChannelError.REFUSED,
    errno.EHOSTDOWN: ChannelError.HOST_DOWN,
    errno.EHOSTUNREACH: ChannelError.HOST_UNREACHABLE,
}
_UNDER_WAY: Final = (EINPROGRESS, EWOULDBLOCK, EINTR)
"""Error numbers of an attempt to connect that goes on."""


class TcpChannel:
    """A connection to a server, under way from the beginning.

    Args:
        channel: its number.
        address: name or number of the computer.
        port: port of the server.
        reach: decides on what a name stands for.
        decision: what it has decided on the address.

    Attributes:
        barred: why nothing of what a name stands for is let through; None if it is.
        room: bytes that the peer may send.
        is_over: whether nothing will come any more; the connection is closed then.
        place: address and port; for messages.
        lost: bytes that were sent and had not left when the connection ended.
    """

    __slots__ = (
        "_address",
        "_channel",
        "_closing_end_s",
        "_error",
        "_failure",
        "_found",
        "_is_open",
        "_is_shut",
        "_left",
        "_outgoing",
        "_reach",
        "_socket",
        "barred",
        "is_over",
        "lost",
        "place",
        "room",
    )

    def __init__(self, channel: int, address: str, port: int, reach: Reach, decision: Decision) -> None:
        self._channel = channel
        self._address = address, port
        self._socket: socket.socket | None = None
        self._found: list[Any] | None = None if decision.is_name else decision.rows
        self._reach = reach
        self.barred: Decision | None = None
        self._failure = ""
        self._error = ChannelError.OTHER
        self._is_open = False
        self._outgoing = bytearray()
        self._left = 0
        self._is_shut = False
        self._closing_end_s = 0.0
        self.place = f"{address}:{port}"
        self.room = CHANNEL_WINDOW
        self.is_over = False
        self.lost = 0
        if decision.is_name:
            # A name server may take seconds to answer.
            Thread(
                target=self._look_up_name, name=said("look up {address!r:.40}", address=address), daemon=True
            ).start()

    # ---------------------------------------------------------------- connecting

    def _look_up_name(self) -> None:
        address, port = self._address
        try:
            found = socket.getaddrinfo(address, port, type=socket.SOCK_STREAM)
            # What was decided on is what is connected to.
            decision = self._reach.among(found, address, port)
        except (OSError, ValueError):
            self._failure, self._error = "the address is not known", ChannelError.HOST_UNREACHABLE
            return
        if decision.why_not:
            self.barred = decision
            self._failure, self._error = decision.why_not, ChannelError.BARRED
        else:
            self._found = decision.rows

    def _connect(self) -> None:
        if self._socket is None:
            if self._found is None:
                return
            family, kind, protocol, _, address = self._found[0]
            self._socket = connection = socket.socket(family, kind, protocol)
            connection.setblocking(False)
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            error = connection.connect_ex(address)
            if error in _UNDER_WAY:
                error = 0
        else:
            error = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if error:
            self._failure, self._error = strerror(error).lower(), channel_error(error)
            return
        with suppress(OSError):
            self._is_open = bool(self._socket.getpeername())
        if self._is_open and self._socket.getpeername() == self._socket.getsockname():
            # Nothing listens, but the system has chosen that very port for this end.
            self._failure, self._error = "connection refused", ChannelError.REFUSED

    # ---------------------------------------------------------------- bytes

    def send(self, data: bytes) -> None:
        """Send what the connection takes now, the rest at a later `poll`."""
        self._outgoing += data
        with suppress(OSError):
            self._flush()

    def _flush(self) -> None:
        assert self._socket is not None
        while self._outgoing:
            try:
                size = self._socket.send(self._outgoing)
            except BlockingIOError:
                return
            del self._outgoing[:size]
            self._left += size

    def poll(self) -> list[ChannelEvent]:
        """Go on with what is under way; return what has happened."""
        events: list[ChannelEvent] = []
        if not self._is_open:
            try:
                self._connect()
            except OSError as error:
                self._failure, self._error = _words(error), channel_error(error.errno)
            if self._failure:
                self._end()
                return [ChannelOpened(self._channel, False, self._failure, self._error)]
            if not self._is_open:
                return []
            events.append(ChannelOpened(self._channel, True))
        try:
            self._flush()
            is_closed = self._receive(events)
            closed = ChannelClosed(self._channel)
        except OSError as error:
            is_closed, closed = True, ChannelClosed(self._channel, _words(error), channel_error(error.errno))
        if self._left:
            events.append(ChannelCredit(self._channel, self._left))
            self._left = 0
        if is_closed:
            self._end()
            events.append(closed)
        return events

    def _receive(self, events: list[ChannelEvent]) -> bool:
        """Take what has arrived; whether the peer has closed."""
        assert self._socket is not None
        while self.room > 0:
            try:
                data = self._socket.recv(self.room)
            except BlockingIOError:
                return False
            if not data:
                return True
            self.room -= len(data)
            events.append(ChannelData(self._channel, data))
        return False

    # ---------------------------------------------------------------- the end

    @property
    def pending(self) -> int:
        """Bytes that the peer's computer does not have yet, as far as this one reports it."""
        if self._socket is None or self.is_over:
            return len(self._outgoing)
        # The end of this half counts as a byte until it is confirmed.
        return len(self._outgoing) + max(0, _unacknowledged(self._socket) - self._is_shut)

    def close(self) -> None:
        """Begin to close the connection, which ends at once if all that was sent has left; else call `leave`."""
        self._closing_end_s = monotonic() + CLOSING_S
        if self._is_open:
            self.leave()
        else:
            self._end()

    def leave(self) -> None:
        """Go on with closing: send what is left, end this half, then wait until the peer has ended the other half.

        What the peer still sends is read and dropped: a connection that is closed with unread bytes, or gets more after
        it is closed, is reset, and the peer loses what it has not read.
        """
        assert self._socket is not None
        try:
            self._flush()
            if not self._outgoing:
                if not self._is_shut:
                    self._is_shut = True
                    self._socket.shutdown(socket.SHUT_WR)
                unread = _UNREAD_MAX
                while unread > 0 and (data := self._socket.recv(CHANNEL_WINDOW)):
                    unread -= len(data)
                if unread > 0:
                    self._end()
                    return
        except BlockingIOError:
            pass
        except OSError:
            self._end()
            return
        if monotonic() >= self._closing_end_s:
            self._end()

    def discard(self) -> None:
        """Drop what has not left."""
        self._left += len(self._outgoing)
        self._outgoing.clear()

    def drop(self) -> None:
        """Close the connection at once, whatever is under way."""
        self._end()

    def _end(self) -> None:
        self.lost = self.pending
        self.is_over = True
        if self._socket is not None:
            self._socket.close()


def _unacknowledged(connection: socket.socket) -> int:
    """Return bytes that the system has taken and the peer's system has not confirmed; 0 where that cannot be asked."""
    if sys.platform != "linux":
        return 0
    from fcntl import ioctl
    from termios import TIOCOUTQ

    try:
        return int.from_bytes(ioctl(connection, TIOCOUTQ, bytes(4)), sys.byteorder)
    except OSError:
        return 0


def channel_error(number: int | None) -> ChannelError:
    """Return what an error number of this operating system means."""
    return ChannelError.OTHER if number is None else _ERRORS.get(number, ChannelError.OTHER)


def _words(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
