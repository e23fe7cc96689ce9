"""The outgoing TCP connections of a robot's programs.

The robot asks by channel requests and hears by channel inputs; it never has a socket. Everything is bounded: channels,
attempts to connect, bytes either way. What a peer sends is handed over once a tick; while `UNREAD_MAX` bytes wait for
the next tick the rest stays in the socket.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable, Iterable
from typing import Any, Final

from elitescript.messages.inputs import ChannelClosed, ChannelData, ChannelOpened, Input
from elitescript.messages.outputs import ChannelRequest, CloseChannel, OpenChannel, SendChannel

CHANNELS_MAX: Final = 64
UNREAD_MAX: Final = 64 * 1024
"""Bytes of one peer in one tick."""
UNSENT_MAX: Final = 1024 * 1024
"""Bytes that may wait for a peer that does not read."""
TIMEOUT_MAX_S: Final = 60.0


class Broker:
    """All channels of one robot.

    Args:
        post: takes what the robot is to hear.
    """

    __slots__ = ("_attempts", "_channels", "_post")

    def __init__(self, post: Callable[[list[Input]], None]) -> None:
        self._post = post
        self._channels: dict[int, _Channel] = {}
        self._attempts: dict[int, asyncio.Task[None]] = {}

    @property
    def count(self) -> int:
        """Channels that are open or about to be."""
        return len(self._channels) + len(self._attempts)

    def carry_out(self, requests: Iterable[ChannelRequest]) -> None:
        """Do what the robot asks for, in order."""
        for channel in self._channels.values():
            channel.next_tick()
        for request in requests:
            if isinstance(request, OpenChannel):
                self._open(request)
            elif isinstance(request, SendChannel):
                self._send(request)
            else:
                self._close(request)

    def close_all(self) -> None:
        """Close everything: the robot has gone, or begins anew."""
        for task in self._attempts.values():
            task.cancel()
        self._attempts.clear()
        for channel in list(self._channels.values()):
            channel.drop()
        self._channels.clear()

    def _open(self, request: OpenChannel) -> None:
        why = ""
        if request.channel in self._channels or request.channel in self._attempts:
            why = f"channel {request.channel} is in use"
        elif request.kind != "tcp":
            why = f"there is no kind of channel called {request.kind!r}"
        elif self.count >= CHANNELS_MAX:
            why = f"{CHANNELS_MAX} connections are open"
        if why:
            self._post([ChannelOpened(request.channel, False, why)])
            return
        self._attempts[request.channel] = asyncio.get_running_loop().create_task(self._connect(request))

    async def _connect(self, request: OpenChannel) -> None:
        number = request.channel
        loop = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(min(max(request.timeout_s, 0.0), TIMEOUT_MAX_S)):
                # If it is opened at the last moment, the time-out still ends it: the channel is entered right below.
                _, channel = await loop.create_connection(
                    lambda: _Channel(number, self._post, self._forget), request.address, request.port
                )
        except TimeoutError:
            self._give_up(number, f"no answer within {request.timeout_s:g} s")
        except (OSError, ValueError, OverflowError) as error:
            self._give_up(number, _reason(error))
        else:
            del self._attempts[number]
            if channel.is_gone:
                self._post([ChannelOpened(number, False, "closed by the peer")])
                return
            self._channels[number] = channel
            self._post([ChannelOpened(number, True)])
            channel.start()

    def _give_up(self, number: int, why: str) -> None:
        if self._attempts.pop(number, None) is not None:
            self._post([ChannelOpened(number, False, why)])

    def _send(self, request: SendChannel) -> None:
        channel = self._channels.get(request.channel)
        if channel is None:
            self._post([ChannelClosed(request.channel, "not open")])
        elif not channel.send(request.data):
            del self._channels[request.channel]
            channel.drop()
            self._post([ChannelClosed(request.channel, f"the peer does not read: {UNSENT_MAX} bytes wait for it")])

    def _close(self, request: CloseChannel) -> None:
        if (task := self._attempts.pop(request.channel, None)) is not None:
            task.cancel()
        if (channel := self._channels.pop(request.channel, None)) is not None:
            channel.close()

    def _forget(self, number: int) -> None:
        self._channels.pop(number, None)


class _Channel(asyncio.BufferedProtocol):
    """One open connection."""

    __slots__ = (
        "_buffer",
        "_forget",
        "_is_closed",
        "_is_paused",
        "_number",
        "_post",
        "_transport",
        "_unread",
        "is_gone",
    )

    def __init__(self, number: int, post: Callable[[list[Input]], None], forget: Callable[[int], None]) -> None:
        self._number = number
        self._post = post
        self._forget = forget
        self._buffer = bytearray(16 * 1024)
        self._transport: asyncio.Transport | None = None
        self._unread = 0
        self._is_paused = True
        self._is_closed = False
        self.is_gone = False

    def start(self) -> None:
        """The robot knows of the channel: it may hear what the peer sends."""
        if self._transport is not None and not self.is_gone:
            self._is_paused = False
            self._transport.resume_reading()

    def next_tick(self) -> None:
        """What was read belongs to the tick before."""
        self._unread = 0
        if self._is_paused:
            self.start()

    def send(self, data: bytes) -> bool:
        """Send; whether the peer still takes it."""
        if self._transport is None or self.is_gone:
            return True
        if self._transport.get_write_buffer_size() + len(data) > UNSENT_MAX:
            return False
        self._transport.write(data)
        return True

    def close(self) -> None:
        """Send what waits, then close; the robot hears nothing more."""
        self._is_closed = True
        if self._transport is not None:
            self._transport.close()

    def drop(self) -> None:
        """Close at once."""
        self._is_closed = True
        if self._transport is not None:
            self._transport.abort()

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        transport.pause_reading()
        raw = transport.get_extra_info("socket")
        if raw is not None:
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def get_buffer(self, sizehint: int) -> bytearray:
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        if self._is_closed:
            return
        self._post([ChannelData(self._number, bytes(self._buffer[:nbytes]))])
        self._unread += nbytes
        if self._unread >= UNREAD_MAX and self._transport is not None:
            self._is_paused = True
            self._transport.pause_reading()

    def eof_received(self) -> bool:
        return False

    def connection_lost(self, exc: Exception | None) -> None:
        self.is_gone = True
        if not self._is_closed:
            self._is_closed = True
            self._forget(self._number)
            self._post([ChannelClosed(self._number, _reason(exc) if exc else "")])


def _reason(error: BaseException) -> str:
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return str(text)
