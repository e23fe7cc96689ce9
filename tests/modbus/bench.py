"""A master on a network of devices that live in ticks."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import Any

from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelEvent, ChannelOpened
from elitescript.modbus.frames.pdu import WRITE_COIL, WRITE_COILS, WRITE_REGISTER, WRITE_REGISTERS
from elitescript.modbus.frames.tcp import TcpFrame, TcpSplitter, tcp_frame
from elitescript.modbus.master.master import Master
from elitescript.modbus.master.signals import SignalKind
from elitescript.modbus.slave import MemoryTables, Slave

HOST = "10.0.0.9"
WRITES = (WRITE_COIL, WRITE_REGISTER, WRITE_COILS, WRITE_REGISTERS, 23)


class Device:
    """A device behind one port; what it does wrong can be set.

    Attributes:
        latency: ticks from a request to its answer.
        ticks_each: ticks that it works on each request before the next one; answers leave when they are ready.
        per_segment: how many requests of a segment it answers; None for all.
        alter: makes of an answer the bytes that are sent.
        requests: tick, unit and request of all that have come.
    """

    def __init__(self) -> None:
        self.tables = MemoryTables(holding_registers=[100 + n for n in range(500)], coils=500)
        self.tables.input_registers = list(range(500))
        self.slave = Slave(self.tables)
        self.latency = 1
        self.ticks_each = 0.0
        self.per_segment: int | None = None
        self.is_silent = False
        self.breaks_after: int | None = None
        self.alter: Callable[[TcpFrame, bytes], bytes] = lambda frame, answer: tcp_frame(
            frame.transaction, frame.unit, answer
        )
        self.requests: list[tuple[int, int, bytes]] = []
        self.segments: list[int] = []
        self.busy_until = 0.0

    def writes(self) -> list[bytes]:
        """The requests that wrote."""
        return [request for _, _, request in self.requests if request[0] in WRITES]


class Network:
    """Implements `runtime.environment.Channels`; one device for each port, others refuse."""

    is_real = False

    def __init__(self) -> None:
        self.tick = 0
        self.devices: dict[int, Device] = {}
        self.dead: set[int] = set()
        """Ports that never answer an attempt to connect."""
        self.is_there = True
        self.gives_credit = True
        self.opened: list[tuple[int, int]] = []
        self.closed: list[int] = []
        self.credited = 0
        self.ports: dict[int, int] = {}
        self._splitters: dict[int, TcpSplitter] = {}
        self._due: list[tuple[int, ChannelEvent]] = []

    def open(self, address: str, port: int, timeout_s: float) -> int:
        if not self.is_there:
            return 0
        channel = len(self.opened) + 1
        self.opened.append((self.tick, port))
        if port in self.devices:
            self.ports[channel] = port
            self._splitters[channel] = TcpSplitter()
            self._tell(1, ChannelOpened(channel, True))
        elif port not in self.dead:
            self._tell(1, ChannelOpened(channel, False, "connection refused", ChannelError.REFUSED))
        return channel

    def open_line(self, device: str, settings: Any) -> int:
        return 0

    def send(self, channel: int, data: bytes) -> None:
        device = self.devices[self.ports[channel]]
        if self.gives_credit:
            self._tell(1, ChannelCredit(channel, len(data)))
        frames = self._splitters[channel].feed(data)
        device.segments.append(len(frames))
        device.requests += [(self.tick, frame.unit, frame.pdu) for frame in frames]
        if device.breaks_after is not None and len(frames) > device.breaks_after:
            self._tell(device.latency, ChannelClosed(channel, "connection reset by peer", ChannelError.RESET))
            return
        parts = []
        for frame in frames[: device.per_segment]:
            answer = device.slave.answer(frame.pdu)
            if frame.unit and not device.is_silent:
                parts.append(device.alter(frame, answer))
            if device.ticks_each:
                device.busy_until = max(device.busy_until, self.tick) + device.ticks_each
                self._tell(ceil(device.busy_until) - self.tick, ChannelData(channel, parts.pop()))
        if parts:
            self._tell(device.latency, ChannelData(channel, b"".join(parts)))

    def say(self, event: ChannelEvent) -> None:
        """Something happens in the next tick."""
        self._tell(1, event)

    def credit(self, channel: int, size: int) -> None:
        self.credited += size

    def close(self, channel: int) -> None:
        self.closed.append(channel)

    def _tell(self, after: int, event: ChannelEvent) -> None:
        self._due.append((self.tick + after, event))

    def arrivals(self, tick: int) -> list[ChannelEvent]:
        """What has happened by a tick."""
        self.tick = tick
        events = [event for due, event in self._due if due <= tick]
        self._due = [(due, event) for due, event in self._due if due > tick]
        return events

    def next_tick(self, tick: int) -> int | None:
        """When something happens."""
        return min((max(due, tick + 1) for due, _ in self._due), default=None)


class Bench:
    """A master, its network, and time."""

    def __init__(self, *, leaps: bool = False) -> None:
        self.network = Network()
        self.device = self.network.devices[502] = Device()
        self.listeners: dict[int, Any] = {}
        self.warnings: list[str] = []
        self.master = Master(self.network, self.listeners, lambda text, code="": self.warnings.append(text))
        self.tick = 0
        self.is_running = True
        self.visited = 0
        self._leaps = leaps

    def add(
        self, name: str, kind: SignalKind = SignalKind.REGISTER_OUTPUT, first: int = 0, count: int = 1, **more: Any
    ) -> None:
        """Add a signal of slave 255 at the usual device."""
        port, unit = more.pop("port", 502), more.pop("unit", 255)
        frequency = more.pop("hertz", None)
        self.master.add(HOST, port, name, kind, unit, first, count, **more)
        if frequency is not None:
            self.master.retime(name, frequency)

    def run(self, ticks: int) -> None:
        """Let time go by."""
        end = self.tick + ticks
        while self.tick < end:
            due = self.tick + 1
            if self._leaps:
                ours = self.master.next_tick(self.tick, is_running=self.is_running)
                theirs = self.network.next_tick(self.tick)
                dues = [at for at in (ours, theirs) if at is not None]
                due = min([*dues, end]) if dues else end
            assert due > self.tick
            self.tick = self.network.tick = due
            self.visited += 1
            for event in self.network.arrivals(due):
                if event.channel in self.listeners:
                    self.listeners[event.channel].take(event)
            self.master.tick(due, is_running=self.is_running)

    def value(self, name: str) -> tuple[int, ...]:
        """What a signal stands at."""
        return self.master.find(name).values

    def link(self, port: int = 502) -> Any:
        """The connection to a port."""
        return self.master.links[HOST, port]
