"""The outgoing TCP connections of a robot's programs, and their serial lines.

The robot sends channel requests and gets channel events; it never has a socket. Everything is bounded: channels,
attempts to connect, and the bytes that are on their way in either direction (`messages.outputs.CHANNEL_WINDOW`). A
program that does not read stops its peer; a peer that does not read stops the program, by the credit that it misses.
Programs reach the addresses that the user allows (`connect_policy`); what is bound to a serial port the user chose.

A peer that ends its own half of a connection has ended it for the program: what it sent before can be read, what the
program sent before still arrives, more cannot be sent (*assumed*; servers of the vendor's client end both at once).
"""

from __future__ import annotations

import asyncio
import socket
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from os import strerror
from re import search
from typing import Any, Final

from elitescript.environment.addresses import HOST_MAX
from elitescript.environment.line_bindings import bridge_address
from elitescript.environment.tcp_channel import channel_error
from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import AddLog, ChannelClosed, ChannelCredit, ChannelData, ChannelOpened, Input
from elitescript.messages.outputs import (
    CHANNEL_WINDOW,
    NOT_CONNECTED,
    ChannelRequest,
    CloseChannel,
    CreditChannel,
    OpenChannel,
    OpenLine,
    SendChannel,
)
from elitescript.services.channels.connect_policy import OPTION, ConnectPolicy
from elitescript.services.channels.serial_ports import SerialPorts
from elitescript.services.clients.liveness import watch_peer

CHANNELS_MAX: Final = 64
LEAVING_MAX: Final = 64
"""Channels that are closed and may still get rid of what was sent before; the oldest must go at once for one more."""
READ_BYTES: Final = 16 * 1024
UNSENT_MAX: Final = 4 * CHANNEL_WINDOW
"""Bytes that may wait for a peer; within the window of a channel there are fewer."""
TIMEOUT_MAX_S: Final = 60.0
LOOK_UPS_MAX: Final = 8
"""Names that are looked up at a time. A name server that is silent keeps each of them busy for longer than an attempt
to connect, and nothing can speed it up."""
LINE_TIMEOUT_S: Final = 2.0
"""How long a connection may take that stands for a serial line."""
LINGER_S: Final = 5.0
"""How long a connection that is closed has to get rid of what was sent before."""

Post = Callable[[list[Input]], object]


class Broker:
    """Holds all channels of one robot.

    Args:
        post: takes inputs of the robot.
        lines: what is on the robot's serial ports, by device; see `environment.line_bindings`.
        policy: what programs may reach.
    """

    __slots__ = ("_attempts", "_channels", "_leaving", "_lines", "_look_ups", "_ports", "_post", "_resolver", "policy")

    def __init__(self, post: Post, lines: Mapping[str, str] | None = None, policy: ConnectPolicy | None = None) -> None:
        self._post = post
        self.policy = policy or ConnectPolicy()
        self._channels: dict[int, _BrokerChannel] = {}
        self._attempts: dict[int, asyncio.Task[None]] = {}
        self._leaving: deque[_BrokerChannel] = deque()
        self._lines = dict(lines or {})
        self._ports = SerialPorts(post)
        self._resolver: ThreadPoolExecutor | None = None
        """Threads of its own: other work off the event loop does not wait for name servers."""
        self._look_ups: set[Future[list[Any]]] = set()

    @property
    def count(self) -> int:
        """Channels that are open or about to be."""
        return len(self._channels) + len(self._attempts)

    def carry_out(self, requests: Iterable[ChannelRequest]) -> None:
        """Do what the robot asks for, in order."""
        for request in requests:
            match request:
                case OpenChannel():
                    self._open(request, self.policy)
                case OpenLine():
                    self._open_line(request)
                case SendChannel(number, data) if number in self._ports:
                    self._ports.send(number, data)
                case CreditChannel(number, size) if number in self._ports:
                    self._ports.credit(number, size)
                case SendChannel(number, data):
                    self._send(number, data)
                case CreditChannel(number, size):
                    if channel := self._channels.get(number):
                        channel.credit(size)
                case CloseChannel(number):
                    self._close(number)

    def close_all(self) -> None:
        """Close everything: the robot has gone, or begins anew."""
        for task in self._attempts.values():
            task.cancel()
        self._attempts.clear()
        for channel in list(self._channels.values()):
            channel.drop()
        self._channels.clear()
        for channel in self._leaving:
            channel.drop()
        self._leaving.clear()
        self._ports.close_all()

    def _open(self, request: OpenChannel, policy: ConnectPolicy | None) -> None:
        why = ""
        if request.channel in self._channels or request.channel in self._attempts:
            why = f"channel {request.channel} is in use"
        elif request.kind != "tcp":
            why = f"there is no kind of channel called {request.kind[:40]!r}"
        elif len(request.address) > HOST_MAX:
            # Looking it up would take seconds, of all robots.
            why = f"the address has {len(request.address)} characters; a host name has {HOST_MAX} at most"
        elif self.count >= CHANNELS_MAX:
            why = f"{CHANNELS_MAX} connections are open"
        if why:
            self._post([ChannelOpened(request.channel, False, why)])
            return
        self._attempts[request.channel] = asyncio.get_running_loop().create_task(self._connect(request, policy))

    def _open_line(self, request: OpenLine) -> None:
        """Open what is bound to a serial port. Another channel of the same port is closed already, by the robot."""
        number, target = request.channel, self._lines.get(request.device)
        if target is None:
            self._post([ChannelOpened(number, False, NOT_CONNECTED, ChannelError.NOTHING_BOUND)])
            return
        if number in self._channels or number in self._attempts or number in self._ports:
            self._post([ChannelOpened(number, False, f"channel {number} is in use")])
            return
        address = bridge_address(target)
        if address is None:
            self._ports.open(number, target, request.settings)
        else:
            self._open(OpenChannel(number, "tcp", *address, LINE_TIMEOUT_S), None)

    async def _connect(self, request: OpenChannel, policy: ConnectPolicy | None) -> None:
        number = request.channel
        # In this order NaN becomes 0.
        timeout_s = min(max(0.0, request.timeout_s), TIMEOUT_MAX_S)
        try:
            async with asyncio.timeout(timeout_s):
                found = await self._found(request.address, request.port, policy)
                channel = await self._first_of(_allowed(found, request, policy), number)
        except TimeoutError:
            self._give_up(number, f"no answer within {request.timeout_s:g} s", ChannelError.TIMED_OUT)
        except (OSError, ValueError, OverflowError) as error:
            self._give_up(number, *reason_of(error))
        else:
            del self._attempts[number]
            self._channels[number] = channel
            self._post([ChannelOpened(number, True)])
            channel.start()

    async def _found(self, address: str, port: int, policy: ConnectPolicy | None) -> list[Any]:
        """Return what `getaddrinfo` finds for an address.

        Raises:
            OSError: nothing, too many others are asked for, or the user does not allow to ask for it.
            ValueError: it cannot be an address.
        """
        try:
            return socket.getaddrinfo(address, port, type=socket.SOCK_STREAM, flags=socket.AI_NUMERICHOST)
        except socket.gaierror:
            pass  # a name
        if policy is not None and not policy.looks_up(address, port):
            raise OSError(f"refused: {address} is a name that `serve {OPTION}` does not allow to look up")
        if len(self._look_ups) >= LOOK_UPS_MAX:
            raise OSError(f"{LOOK_UPS_MAX} names are being looked up already")
        if self._resolver is None:
            self._resolver = ThreadPoolExecutor(LOOK_UPS_MAX, "look up")
        job = self._resolver.submit(socket.getaddrinfo, address, port, type=socket.SOCK_STREAM)
        self._look_ups.add(job)
        job.add_done_callback(self._look_ups.discard)
        return await asyncio.wrap_future(job)

    async def _first_of(self, found: list[Any], number: int) -> _BrokerChannel:
        """Return a connection to the first address that accepts one.

        Raises:
            OSError: none does; of the first one.
        """
        failure: OSError | None = None
        for family, *_, address in found:
            try:
                _, channel = await asyncio.get_running_loop().create_connection(
                    lambda: _BrokerChannel(number, self._post, self._part), *address[:2], family=family
                )
                return channel
            except OSError as error:
                failure = failure or error
        raise failure or socket.gaierror(socket.EAI_NONAME, "the address is not known")

    def _give_up(self, number: int, why: str, error: ChannelError) -> None:
        if self._attempts.pop(number, None) is not None:
            self._post([ChannelOpened(number, False, why, error)])

    def _send(self, number: int, data: bytes) -> None:
        channel = self._channels.get(number)
        if channel is not None and not channel.send(data):
            del self._channels[number]
            channel.drop()
            self._post(
                [ChannelClosed(number, f"{UNSENT_MAX} bytes wait for a peer that does not read", ChannelError.OTHER)]
            )

    def _close(self, number: int) -> None:
        self._ports.close(number)
        if (task := self._attempts.pop(number, None)) is not None:
            task.cancel()
        self._part(number)

    def _part(self, number: int) -> None:
        """Forget a channel; its connection may still send what waits."""
        if (channel := self._channels.pop(number, None)) is None:
            return
        channel.close()
        self._leaving.append(channel)
        if len(self._leaving) > LEAVING_MAX:
            self._leaving = deque(one for one in self._leaving if not one.is_gone)
        if len(self._leaving) > LEAVING_MAX:
            self._leaving.popleft().give_up()


class _BrokerChannel(asyncio.BufferedProtocol):
    """One open connection. It is not read before `start`, so that nothing comes before `ChannelOpened`."""

    __slots__ = (
        "_buffer",
        "_is_closed",
        "_is_reading",
        "_is_started",
        "_linger",
        "_number",
        "_part",
        "_post",
        "_room",
        "_transport",
        "_unsent",
    )

    def __init__(self, number: int, post: Post, part: Callable[[int], None]) -> None:
        self._number = number
        self._post = post
        self._part = part
        self._buffer = bytearray(READ_BYTES)
        self._transport: asyncio.Transport | None = None
        self._linger: asyncio.TimerHandle | None = None
        self._room = CHANNEL_WINDOW
        self._unsent = 0
        self._is_started = False
        self._is_reading = False
        self._is_closed = False

    @property
    def is_gone(self) -> bool:
        """Whether nothing is left of the connection."""
        return self._transport is None

    def start(self) -> None:
        """Begin to read: the robot has the event that the channel is open."""
        self._is_started = True
        self._read_or_not()

    def credit(self, size: int) -> None:
        """Read on: the program has taken so many bytes."""
        self._room = min(self._room + max(size, 0), CHANNEL_WINDOW)
        self._read_or_not()

    def send(self, data: bytes) -> bool:
        """Send bytes; return whether there is room for them."""
        transport = self._transport
        if transport is None or self._is_closed:
            return True
        if transport.get_write_buffer_size() + len(data) > UNSENT_MAX:
            return False
        transport.write(data)
        self._unsent += len(data)
        if not transport.get_write_buffer_size():
            self.resume_writing()
        return True

    def close(self) -> None:
        """Send what waits, then close; the robot gets no more events."""
        self._is_closed = True
        if self._transport is not None:
            self._transport.close()
            self._linger = asyncio.get_running_loop().call_later(LINGER_S, self.give_up)

    def give_up(self) -> None:
        """Close at once; what has not left is lost, with a line in the robot's log."""
        transport = self._transport
        if transport is not None and (size := transport.get_write_buffer_size()):
            self._post([AddLog("", f"not delivered: {size} bytes to {_place(transport)}", is_warning=True)])
        self.drop()

    def drop(self) -> None:
        """Close at once."""
        self._is_closed = True
        if self._transport is not None:
            self._transport.abort()

    # ---------------------------------------------------------------- called by the event loop

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        transport.pause_reading()
        # Any byte that waits counts as unsent; `resume_writing` comes when none does.
        transport.set_write_buffer_limits(high=0)
        raw = transport.get_extra_info("socket")
        if raw is not None:
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            watch_peer(raw)

    def get_buffer(self, sizehint: int) -> memoryview:
        return memoryview(self._buffer)[: max(1, min(self._room, READ_BYTES))]

    def buffer_updated(self, nbytes: int) -> None:
        if self._is_closed:
            return
        self._post([ChannelData(self._number, bytes(self._buffer[:nbytes]))])
        self._room -= nbytes
        self._read_or_not()

    def resume_writing(self) -> None:
        if self._unsent and not self._is_closed:
            self._post([ChannelCredit(self._number, self._unsent)])
        self._unsent = 0

    def eof_received(self) -> bool:
        self._end()
        return True

    def connection_lost(self, exc: Exception | None) -> None:
        # It has no loop any more, and must not be asked for anything.
        self._transport = None
        if self._linger is not None:
            self._linger.cancel()
            self._linger = None
        self._end(*(reason_of(exc) if exc else ()))

    def _end(self, reason: str = "", error: ChannelError = ChannelError.RESET) -> None:
        if not self._is_closed:
            self._is_closed = True
            self._part(self._number)
            self._post([ChannelClosed(self._number, reason, error)])

    def _read_or_not(self) -> None:
        transport = self._transport
        if transport is None or transport.is_closing():
            return
        may_read = self._is_started and self._room > 0
        if may_read != self._is_reading:
            self._is_reading = may_read
            if may_read:
                transport.resume_reading()
            else:
                transport.pause_reading()


def _place(transport: asyncio.Transport) -> str:
    peer = transport.get_extra_info("peername")
    return f"{peer[0]}:{peer[1]}" if peer else "a peer that has gone"


def _allowed(found: list[Any], request: OpenChannel, policy: ConnectPolicy | None) -> list[Any]:
    """Return the addresses that a program may connect to, of those that were found.

    Raises:
        OSError: there are none; with the reason of the first.
    """
    if policy is None:
        return found
    refusals = [policy.refusal(request.address, row[4][0], request.port) for row in found]
    allowed = [row for row, refusal in zip(found, refusals, strict=True) if not refusal]
    if found and not allowed:
        raise OSError(f"refused: {refusals[0]}")
    return allowed


def reason_of(error: BaseException) -> tuple[str, ChannelError]:
    """Return why a connection failed: in the words of the operating system if it has any, and as a number."""
    number = getattr(error, "errno", None)
    if number is None and (found := search(r"\[Errno (\d+)\]", str(error))):
        # Of several addresses each has failed; programs get the error of the first.
        number = int(found[1])
    if number is not None and number > 0:
        return strerror(number).lower(), channel_error(number)
    is_unknown = isinstance(error, socket.gaierror) and number == socket.EAI_NONAME
    text = str(getattr(error, "strerror", None) or str(error) or type(error).__name__)
    return text, ChannelError.HOST_UNREACHABLE if is_unknown else ChannelError.OTHER
