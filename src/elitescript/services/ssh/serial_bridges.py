"""TCP ports that carry the bytes of the robot's serial ports, as `socat` does on the real controller."""

from __future__ import annotations

import asyncio
import socket
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.messages.line import PORT_NAMES
from elitescript.services.clients.binding import bind
from elitescript.services.clients.liveness import watch_peer
from elitescript.services.ssh.line_taps import LineTaps

BRIDGES_MAX: Final = 8
CLIENTS_MAX: Final = 4
"""Of one bridge."""
PORT_MIN: Final = 1024
UNSENT_MAX: Final = 64 * 1024
"""Bytes that wait for a client before the line has to wait."""
FIRST_NUMBER: Final = 2001
"""Stands for the process number of the first bridge."""


class SerialBridges:
    """Holds all bridges of one robot.

    Args:
        host: address to listen at.
        taps: the serial ports.
    """

    __slots__ = ("_bridges", "_host", "_next", "_taps")

    def __init__(self, host: str, taps: LineTaps) -> None:
        self._host = host
        self._taps = taps
        self._bridges: dict[int, _Bridge] = {}
        self._next = FIRST_NUMBER

    async def start(self, port: int, device: str) -> int:
        """Carry a serial port at a TCP port; return the number of the bridge.

        Raises:
            UsageError: the port cannot be had, or there are too many bridges.
        """
        name = PORT_NAMES[device]
        if len(self._bridges) >= BRIDGES_MAX:
            raise UsageError(f"{BRIDGES_MAX} bridges are open")
        if not PORT_MIN <= port <= 65535:
            raise UsageError(
                f"a bridge of the serial port {name} must be at a port from {PORT_MIN} to 65535, not {port}"
            )
        try:
            bound = bind(self._host, port)
        except OSError as error:
            text = f"the serial port {name} cannot be bridged at port {port}: {error.strerror or error}"
            raise UsageError(text) from error
        bridge = _Bridge(port, device, self._taps)
        number, self._next = self._next, self._next + 1
        self._bridges[number] = bridge
        bridge.server = await asyncio.get_running_loop().create_server(lambda: _BridgeClient(bridge), sock=bound)
        return number

    def find(self, port: int) -> int:
        """Return the number of the bridge at a TCP port; 0 if there is none."""
        return next((number for number, bridge in self._bridges.items() if bridge.port == port), 0)

    def kill(self, number: int) -> bool:
        """End a bridge and its connections; return whether there was one."""
        bridge = self._bridges.pop(number, None)
        if bridge is not None:
            bridge.close()
        return bridge is not None

    def close_all(self) -> None:
        """End every bridge."""
        for number in list(self._bridges):
            self.kill(number)


class _Bridge:
    __slots__ = ("clients", "device", "port", "server", "taps")

    def __init__(self, port: int, device: str, taps: LineTaps) -> None:
        self.port = port
        self.device = device
        self.taps = taps
        self.clients: list[_BridgeClient] = []
        self.server: asyncio.Server | None = None

    def close(self) -> None:
        if self.server is not None:
            self.server.close()
        for client in list(self.clients):
            client.drop()


class _BridgeClient(asyncio.Protocol):
    """One connection to a bridge; a `line_taps.LineClient`."""

    __slots__ = ("_bridge", "_is_reading", "_transport")

    def __init__(self, bridge: _Bridge) -> None:
        self._bridge = bridge
        self._transport: asyncio.Transport | None = None
        self._is_reading = True

    # ---------------------------------------------------------------- called by the line

    @property
    def is_behind(self) -> bool:
        """Whether more than `UNSENT_MAX` bytes wait."""
        return self._transport is not None and self._transport.get_write_buffer_size() > UNSENT_MAX

    def receive(self, data: bytes) -> None:
        """Send it."""
        if self._transport is not None:
            self._transport.write(data)

    def go_on(self) -> None:
        """Read again."""
        if not self._is_reading and self._transport is not None and not self._transport.is_closing():
            self._is_reading = True
            self._transport.resume_reading()

    def drop(self) -> None:
        """Close at once."""
        if self._transport is not None:
            self._transport.abort()

    # ---------------------------------------------------------------- called by the event loop

    def connection_made(self, transport: Any) -> None:
        bridge = self._bridge
        if len(bridge.clients) >= CLIENTS_MAX:
            transport.abort()
            return
        self._transport = transport
        raw = transport.get_extra_info("socket")
        if raw is not None:
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            watch_peer(raw)
        bridge.clients.append(self)
        bridge.taps.join(bridge.device, self)

    def data_received(self, data: bytes) -> None:
        transport = self._transport
        if transport is not None and not self._bridge.taps.send(self._bridge.device, data):
            self._is_reading = False
            transport.pause_reading()

    def connection_lost(self, exc: Exception | None) -> None:
        if self._transport is not None:
            self._transport = None
            self._bridge.clients.remove(self)
            self._bridge.taps.leave(self._bridge.device, self)
