"""Virtual devices on real ports and lines: `elitescript devices`.

The same devices as beside a virtual robot, in the time of the wall clock: a real robot, or any other program, connects
to their TCP ports; each serial line is a pseudo-terminal or a serial port of this computer. There is no robot here:
signals are remembered, so that wires and schedules work, and that is all.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from elitescript.controller.signals.by_name import signal_write
from elitescript.devices.agenda import DeviceError
from elitescript.devices.channels.network import Endpoint
from elitescript.devices.kinds.serial import LineDevice
from elitescript.devices.world import World
from elitescript.errors import UsageError
from elitescript.messages.events import DeviceNoted, Event
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened, Input
from elitescript.messages.line import LineSettings
from elitescript.messages.machine import DisturbInput, EndInputFaults, WriteSignal
from elitescript.messages.outputs import CHANNEL_WINDOW, Output
from elitescript.messages.signals import SIGNALS, Value, signal_name
from elitescript.protocol.connection import Connection
from elitescript.services.channels.serial_ports import SerialPorts
from elitescript.services.time.cycle import Cycle

USUAL_BAUD: Final = 115_200
CONNECT_S: Final = 2.0

Say = Callable[[str, bool], None]
"""Takes a text, and whether it is a problem."""


class DeviceServer:
    """Devices on ports and lines of this computer.

    Args:
        world: the devices.
        host: address at which they listen.
        ports: number of the port of this computer by that of a device; the same if it is not there.
        lines: serial port of this computer by the name of a line; a pseudo-terminal if it is not there.
        say: takes a text and whether it is a problem.

    Attributes:
        places: what each device is reached by, in words, once `open` has returned.
    """

    def __init__(self, world: World, host: str, ports: Mapping[int, int], lines: Mapping[str, str], say: Say) -> None:
        self._world = world
        self._host = host
        self._numbers = dict(ports)
        self._targets = dict(lines)
        self._say = say
        self._values: dict[str, Value] = {}
        self._servers: list[asyncio.Server] = []
        self._ends: dict[int, _End] = {}
        self._ports = SerialPorts(self._take_events)
        self._terminals: list[_Terminal] = []
        self._refusal = ""
        """Why a serial port could not be had, while ports are being taken."""
        self._is_ready = False
        self.places: list[str] = []
        world.on_device_failure = lambda error: say(f"{error}; the device is disconnected", True)

    # ---------------------------------------------------------------- `RobotAccess` without a robot

    @property
    def present_tick(self) -> int:
        """The time is that of the world itself."""
        return 0

    @property
    def has_news(self) -> bool:
        """There is no robot."""
        return False

    def read(self, name: str, index: int) -> Value:
        """Return a level that was set before."""
        row = SIGNALS[name]
        return self._values.get(signal_name(row, index), row.default)

    def write(self, request: WriteSignal, by: str) -> None:
        """Remember a level."""
        name = signal_name(SIGNALS[request.name], request.index)
        if self.read(request.name, request.index) != request.value:
            self._values[name] = request.value
            self._world.signal_changed(name, request.value)

    def disturb(self, request: DisturbInput | EndInputFaults) -> None:
        """Warn that no robot reads the input."""
        if isinstance(request, DisturbInput):
            self._say(f"{request.kind} on {request.name}[{request.index}]: there is no robot here that reads it", True)

    def connect(self, service: str, origin: str) -> Connection:
        """Refuse: there is no robot."""
        raise UsageError(f"service: there is no robot here whose port {service} could be reached")

    def output(self) -> Output:
        """Refuse: there is no robot."""
        raise UsageError("there is no robot here")

    def post(self, inputs: Sequence[Input]) -> None:
        """Do nothing: there is no robot."""

    def emit(self, event: Event) -> None:
        """Pass on a note of a device."""
        if isinstance(event, DeviceNoted):
            self._say(f"{event.device}: {event.text}", event.is_warning)

    # ---------------------------------------------------------------- life

    async def open(self) -> None:
        """Take all ports and lines, or none.

        Raises:
            UsageError: one cannot be had.
        """
        network = self._world.network
        try:
            for endpoint in network.servers:
                await self._listen(endpoint)
            for line in network.lines:
                self._open_line(line)
        except BaseException:
            self.close()
            raise
        if self._world.settings is not None:
            for name, value in self._world.settings.signals.items():
                self.write(signal_write(name, value), "schedule")
        self._is_ready = True
        self._world.begin(self)
        for request in self._world.input_faults:
            self.disturb(request)

    async def run(self) -> None:
        """Let time pass until cancelled."""
        cycle, tick = Cycle(), 0
        try:
            while True:
                await cycle.next()
                tick += 1
                self.step(tick)
        finally:
            cycle.close()

    def step(self, tick: int) -> None:
        """Run one tick."""
        try:
            events = self._world.channels.arrivals(tick)
            self._world.settle()
        except DeviceError as error:
            self._say(str(error), True)
            return
        for event in events:
            end = self._ends.get(event.channel)
            if end is not None:
                end.take(event)

    def close(self) -> None:
        """Give everything back."""
        for server in self._servers:
            server.close()
        for end in list(self._ends.values()):
            end.drop()
        for terminal in self._terminals:
            terminal.close()
        self._ports.close_all()

    # ---------------------------------------------------------------- TCP

    async def _listen(self, endpoint: Endpoint) -> None:
        address, port = endpoint if isinstance(endpoint, tuple) else ("", endpoint)
        number = self._numbers.get(port, port)
        loop = asyncio.get_running_loop()
        try:
            server = await loop.create_server(lambda: _DeviceClient(self, address, port), self._host, number)
        except OSError as error:
            # What asyncio makes of the reason repeats address and port.
            reason = os.strerror(error.errno) if error.errno and error.errno > 0 else error
            raise UsageError(
                f"port {number} at {self._host}: {reason}; another one: --port {port}=NUMBER (0: any)"
            ) from error
        self._servers.append(server)
        owner: Any = getattr(self._world.network.servers[endpoint], "__self__", None)
        self.places.append(f"{getattr(owner, 'title', port)} {server.sockets[0].getsockname()[1]}")

    def admit(self, end: _End, address: str, port: int) -> int:
        """Open a channel for a client, and return its number."""
        channel = self._world.channels.open(address, port, CONNECT_S)
        self._ends[channel] = end
        return channel

    def send(self, channel: int, data: bytes) -> None:
        """Send bytes to a device."""
        self._world.channels.send(channel, data)

    def credit(self, channel: int, size: int) -> None:
        """Give a device credit for bytes that have left."""
        self._world.channels.credit(channel, size)

    def forget(self, channel: int) -> None:
        """Close the channel of a client that has gone."""
        if self._ends.pop(channel, None) is not None:
            self._world.channels.close(channel)

    # ---------------------------------------------------------------- lines

    def _open_line(self, line: str) -> None:
        device = getattr(self._world.network.lines[line], "__self__", None)
        baud = device.baud if isinstance(device, LineDevice) and device.baud else USUAL_BAUD
        settings = LineSettings(baud, 0, 1, 8)
        target = self._targets.get(line)
        channel = self._world.channels.open_line(line, settings)
        end: _End
        if target is None:
            end = _Terminal(self, channel)
            self._terminals.append(end)
            target = end.path
        else:
            end = _Port(self._ports, channel)
            self._ports.open(channel, target, settings)
            if channel not in self._ports:
                raise UsageError(f"--serial {line}={target}: {self._refusal}")
        self._ends[channel] = end
        self.places.append(f"{getattr(device, 'title', line)} {target}")

    def _take_events(self, inputs: list[Input]) -> None:
        """Take events of the serial ports of this computer."""
        for item in inputs:
            if isinstance(item, ChannelData):
                self.send(item.channel, item.data)
            elif isinstance(item, ChannelOpened | ChannelClosed) and item.reason:
                if self._is_ready:
                    self._say(item.reason, True)
                else:
                    self._refusal = item.reason


class _End:
    """The other end of a channel: a client, a terminal, a serial port."""

    def take(self, event: ChannelEvent) -> None:
        """Take an event of a device."""

    def drop(self) -> None:
        """Close at once."""


class _DeviceClient(_End, asyncio.Protocol):
    """A TCP client of a device."""

    def __init__(self, server: DeviceServer, address: str, port: int) -> None:
        self._server = server
        self._place = address, port
        self._channel = 0
        self._room = CHANNEL_WINDOW
        self._unread = 0
        """Bytes for which the device gets credit when the client has taken what waits."""
        self._is_behind = False
        self._transport: asyncio.Transport | None = None

    def connection_made(self, transport: Any) -> None:
        self._transport = transport
        transport.pause_reading()
        self._channel = self._server.admit(self, *self._place)

    def data_received(self, data: bytes) -> None:
        self._server.send(self._channel, data)
        self._room -= len(data)
        if self._room <= 0 and self._transport is not None:
            self._transport.pause_reading()

    def pause_writing(self) -> None:
        self._is_behind = True

    def resume_writing(self) -> None:
        self._is_behind = False
        self._give_credit()

    def _give_credit(self) -> None:
        if self._unread and not self._is_behind:
            self._server.credit(self._channel, self._unread)
            self._unread = 0

    def connection_lost(self, exc: Exception | None) -> None:
        self._transport = None
        self._server.forget(self._channel)

    def take(self, event: ChannelEvent) -> None:
        transport = self._transport
        if transport is None or transport.is_closing():
            return
        match event:
            case ChannelOpened(_, True, _):
                transport.resume_reading()
            case ChannelOpened():
                transport.abort()
            case ChannelData(_, data):
                self._unread += len(data)
                transport.write(data)
                self._give_credit()
            case ChannelCredit(_, size):
                if self._room <= 0 < self._room + size:
                    transport.resume_reading()
                self._room += size
            case ChannelClosed():
                transport.close()

    def drop(self) -> None:
        if self._transport is not None:
            self._transport.abort()


class _Terminal(_End):
    """A pseudo-terminal: what opens its path talks to the device."""

    def __init__(self, server: DeviceServer, channel: int) -> None:
        if not hasattr(os, "openpty"):
            raise UsageError("this system has no pseudo-terminals; name a serial port with --serial LINE=DEVICE")
        import tty

        self._fd, self._other = os.openpty()
        tty.setraw(self._other)
        os.set_blocking(self._fd, False)
        self.path = os.ttyname(self._other)
        self._server = server
        self._channel = channel
        self._room = CHANNEL_WINDOW
        asyncio.get_running_loop().add_reader(self._fd, self._read)

    def _read(self) -> None:
        try:
            data = os.read(self._fd, min(4096, self._room))
        except OSError:
            return
        self._room -= len(data)
        if self._room <= 0:
            asyncio.get_running_loop().remove_reader(self._fd)
        self._server.send(self._channel, data)

    def take(self, event: ChannelEvent) -> None:
        match event:
            case ChannelCredit(_, size):
                if self._room <= 0:
                    asyncio.get_running_loop().add_reader(self._fd, self._read)
                self._room += size
            case ChannelData(_, data):
                self._server.credit(self._channel, len(data))
                with contextlib.suppress(OSError):  # no reader, as on a real line
                    os.write(self._fd, data)

    def close(self) -> None:
        """Give it back."""
        asyncio.get_running_loop().remove_reader(self._fd)
        os.close(self._fd)
        os.close(self._other)


class _Port(_End):
    """A serial port of this computer."""

    def __init__(self, ports: SerialPorts, channel: int) -> None:
        self._ports = ports
        self._channel = channel

    def take(self, event: ChannelEvent) -> None:
        if self._channel not in self._ports:
            return
        match event:
            case ChannelCredit(_, size):
                self._ports.credit(self._channel, size)
            case ChannelData(_, data):
                self._ports.send(self._channel, data)
