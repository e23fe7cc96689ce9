"""Holds the MODBUS TCP signals and the serial ports, which outlive programs; made on first use."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from elitescript.commands.definition.context import Machine
from elitescript.runtime.threads.scheduler import Scheduler
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.runtime.connections.connection import Receiver
    from elitescript.runtime.connections.modbus_signals import ModbusSignals
    from elitescript.runtime.connections.serial_line import LineConnection, SerialLine
    from elitescript.runtime.connections.traffic import Traffic
    from elitescript.runtime.environment import Channels


class Background:
    """Signals and serial ports of a host.

    Args:
        machine: the controller.
        scheduler: of the waiting threads.
        connections: receiver of each open channel.

    Attributes:
        lines: the configured serial ports, by device.
    """

    __slots__ = ("_connections", "_machine", "_modbus", "_scheduler", "_traffic", "lines")

    def __init__(self, machine: Machine, scheduler: Scheduler, connections: dict[int, Receiver]) -> None:
        self._machine = machine
        self._scheduler = scheduler
        self._connections = connections
        self._modbus: ModbusSignals | None = None
        self._traffic: Traffic | None = None
        self.lines: dict[str, SerialLine] = {}

    @property
    def traffic(self) -> Traffic:
        """Records the traffic of all channels."""
        if self._traffic is None:
            from elitescript.runtime.connections.traffic import Traffic

            self._traffic = Traffic(self._machine, self._scheduler)
        return self._traffic

    def modbus(self, channels: Channels) -> ModbusSignals:
        """Return the MODBUS TCP signals.

        Args:
            channels: carry the bytes, if these are the first signals.
        """
        if self._modbus is None:
            from elitescript.runtime.connections.modbus_signals import ModbusSignals

            self._modbus = ModbusSignals(self._machine, self._scheduler, channels, self._connections, self.traffic)
        return self._modbus

    @property
    def channels(self) -> Collection[int]:
        """Open channels of the MODBUS TCP signals."""
        return () if self._modbus is None else self._modbus.master.channels

    def program_ended(self) -> None:
        """End repeated requests, and update outputs that are tied to the program: it is over."""
        if self._modbus is not None:
            self._modbus.master.set_running(False)

    def pending(self) -> tuple[str, ...]:
        """Return a text for each request and each line with bytes that no device has yet."""
        requests = () if self._modbus is None else self._modbus.master.pending()
        return (*requests, *(_waiting(device, wire) for device, wire in self._held()))

    def give_up(self) -> tuple[str, ...]:
        """Drop what is pending, and return it; MODBUS signals keep their values."""
        given_up = [] if self._modbus is None else list(self._modbus.master.give_up())
        for device, wire in self._held():
            given_up.append(_waiting(device, wire))
            wire.discard()
        return tuple(given_up)

    def _held(self) -> list[tuple[str, LineConnection]]:
        return [(name, line.wire) for name, line in self.lines.items() if line.wire is not None and line.wire.unsent]

    def run_tick(self, tick: int, *, is_running: bool) -> None:
        """Run the MODBUS signals in a tick, before the threads."""
        if self._modbus is not None:
            self._modbus.run_tick(tick, is_running=is_running)

    def next_tick(self, tick: int, *, is_running: bool) -> int | None:
        """Return the earliest tick after `tick` at which something is due."""
        return None if self._modbus is None else self._modbus.next_tick(tick, is_running=is_running)

    def close(self) -> None:
        """Drop the signals and close their connections: the run is over, or the controller restarts."""
        if self._modbus is not None:
            self._modbus.close()
            self._modbus = None


def _waiting(device: str, wire: LineConnection) -> str:
    return said("{unsent} bytes that wait for room on {device}", unsent=wire.unsent, device=device)
