"""MODBUS devices beside the robot, on a TCP port or a serial line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from elitescript.devices.channels.faults import MODBUS
from elitescript.devices.channels.network import DeviceLink, Endpoint
from elitescript.devices.device import Device, DeviceContext, check_number, check_text
from elitescript.devices.kinds.serial import BAUD_MAX, LineDevice, line_device
from elitescript.devices.kinds.tcp import LATENCY_MAX_S, TcpConnection, TcpServer
from elitescript.errors import UsageError
from elitescript.messages.timing import PERIOD_S
from elitescript.modbus.frames.pdu import (
    ADDRESSES,
    EXCEPTIONS,
    ILLEGAL_ADDRESS,
    READ_COILS,
    READ_HOLDING_REGISTERS,
    ExceptionResponse,
)
from elitescript.modbus.slave import RtuSlave, Slave, TcpSlave

PORT: Final = 502
ANY_UNIT: Final = 0
FRAME_GAP: Final = 3.5
"""Characters of silence that end a frame on a line."""

Values = Mapping[int, int] | Sequence[int] | int


class Table:
    """One table of a `ModbusDevice`: coils, discrete inputs, or registers of either kind, by address.

    An address that is not there is answered with exception 2. As many addresses as the device was made with exist;
    without any, all of them do, and are 0.
    """

    __slots__ = ("_is_open", "_largest", "_name", "_values")

    def __init__(self, name: str, content: Values | None, largest: int) -> None:
        self._name = name
        self._largest = largest
        self._is_open = content is None
        self._values: dict[int, int] = {}
        rows: Mapping[Any, Any]
        if isinstance(content, int):
            if not 0 <= content <= ADDRESSES:
                raise UsageError(f"{name}: there are {ADDRESSES} addresses at most, not {content!r:.40}")
            rows = dict.fromkeys(range(content), 0)
        elif isinstance(content, Mapping):
            rows = content
        else:
            rows = dict(enumerate(content or ()))
        for address, value in rows.items():
            self._values[_address(name, address)] = self._checked(address, value)

    def _checked(self, address: object, value: object) -> int:
        # A register that its device takes as signed is written with its sign.
        least = -(self._largest // 2 + 1) if self._largest > 1 else 0
        if not isinstance(value, int) or not least <= value <= self._largest:
            raise UsageError(
                f"{self._name}: the value at address {address} must be in [{least}, {self._largest}], got {value!r}"
            )
        return value & self._largest if value < 0 else int(value)

    def __contains__(self, address: int) -> bool:
        return self._is_open or address in self._values

    def __getitem__(self, address: int) -> int:
        if not self._is_open and address not in self._values:
            raise UsageError(f"{self._name}: there is no address {address}")
        return self._values.get(address, 0)

    def __setitem__(self, address: int, value: int) -> None:
        if self._largest == 1:
            value = int(bool(value))
        self._values[_address(self._name, address)] = self._checked(address, value)

    def take(self, address: int, count: int) -> list[int]:
        """Return values as a request asks for them.

        Raises:
            DeviceError: an address is not there.
        """
        values = self._values
        if not self._is_open:
            for number in range(address, address + count):
                if number not in values:
                    raise ExceptionResponse(ILLEGAL_ADDRESS)
        return [values.get(number, 0) for number in range(address, address + count)]


class ModbusDevice(Device):
    """A MODBUS server (slave): over TCP if it has a port, over RTU if it has a line.

    Attributes:
        port: where it listens; or
        line: serial line, such as `tool`.
        address: under which alone it is reached over TCP; any address if empty.
        unit: number of the unit that answers; 0 for every one, over TCP.
        baud: of its line, or 0 for any; at another speed both sides get rubbish.
        latency_s: time that it thinks about a request.
        coils, discrete_inputs, holding_registers, input_registers: what stands at the start: values from address 0 on,
            values by address, or how many there are, all 0. If left out, every address exists. Afterwards they are
            tables: `self.holding_registers[4]` reads, `self.holding_registers[4] = -1` writes. A negative value of a
            register is that of a signed one: -1 is read as 65535.
        requests: how many it has answered.

    Example:
        A gripper at unit 9 of the tool's RS-485: a 1 in register 0 closes it, which takes 0.4 s.

        >>> from elitescript.testing.world import ModbusDevice, World
        >>> class Gripper(ModbusDevice):
        ...     line = "tool"
        ...     unit = 9
        ...     def register_written(self, address, value):
        ...         if address == 0:
        ...             self.after(0.4, self.finish, value)
        ...     def finish(self, position):
        ...         self.input_registers[0] = position
        >>> world = World(devices=[Gripper()])
    """

    port: int = 0
    line: str = ""
    address: str = ""
    unit: int = ANY_UNIT
    baud: int = 0
    latency_s: float = 0.0
    coils: Any = None
    discrete_inputs: Any = None
    holding_registers: Any = None
    input_registers: Any = None

    _kept = ("requests",)
    requests = 0

    # ---------------------------------------------------------------- what a subclass may override

    def register_written(self, address: int, value: int) -> None:
        """Act on a holding register that was written; called once for each, after all of a request are written.

        Masters repeat what they write: the value may be the one that it had.
        """

    def coil_written(self, address: int, level: bool) -> None:
        """Act on a coil that was written, perhaps to the level that it had."""

    def reading(self, table: str, address: int, count: int) -> None:
        """Prepare for a request that reads `coils`, `discrete_inputs`, `holding_registers` or `input_registers`."""

    def refuse(self, code: int) -> None:
        """Answer the request with an exception code, such as 6 for a busy device; called in one of the methods above.

        Raises:
            DeviceError: always.
        """
        if code not in EXCEPTIONS:
            raise UsageError(f"{code} is no exception code of MODBUS; there are {sorted(EXCEPTIONS)}")
        raise ExceptionResponse(code)

    # ---------------------------------------------------------------- the world's side

    def check(self) -> None:
        if bool(self.port) is bool(self.line):
            raise UsageError("port: give either a port, for MODBUS TCP, or a line, for MODBUS RTU")
        if self.port:
            check_number("port", self.port, 1, 65535, is_whole=True)
        check_text("line", self.line)
        if self.line:
            self.line = line_device("line", self.line)
        check_text("address", self.address)
        check_number("unit", self.unit, 1 if self.line else ANY_UNIT, 247 if self.line else 255, is_whole=True)
        check_number("baud", self.baud, 0, BAUD_MAX, "bit/s", is_whole=True)
        check_number("latency_s", self.latency_s, 0.0, LATENCY_MAX_S, "s")
        if self.baud and not self.line:
            raise UsageError("baud: goes with line")
        if self.address and self.line:
            raise UsageError("address: goes with port")
        for name, largest in TABLES.items():
            content = getattr(self, name)
            if not isinstance(content, Table):
                if isinstance(content, str | bool) or not isinstance(content, int | Sequence | Mapping | None):
                    raise UsageError(f"{name}: write a list of values, a table of address and value, or how many")
                setattr(self, name, Table(name, content, largest))

    def join(self, context: DeviceContext) -> None:
        super().join(context)
        bus = self._bus(context)
        if self.unit in bus.slaves or (bus.slaves and ANY_UNIT in (self.unit, *bus.slaves)):
            raise UsageError(f"unit: {self.unit or 'every unit'} is taken by another device at the same place")
        bus.slaves[self.unit] = Slave(_Memory(self, bus))
        self._carrier = bus

    @property
    def carrier(self) -> Device:
        return self._carrier

    def _bus(self, context: DeviceContext) -> _TcpBus | _RtuBus:
        """Return what carries requests to this device: several may share a line, or a port as behind a gateway."""
        network = context.network
        place: Endpoint = (self.address, self.port) if self.address else self.port
        server = network.servers.get(place) if self.port else network.lines.get(self.line)
        bus = getattr(server, "__self__", None)
        if isinstance(bus, _TcpBus | _RtuBus):
            return bus
        made: _TcpBus | _RtuBus
        if self.port:
            made = _TcpBus(name=self.title, port=self.port, address=self.address, latency_s=self.latency_s)
        else:
            made = _RtuBus(name=self.title, line=self.line, baud=self.baud, latency_s=self.latency_s)
        made.slaves = {}
        made.join(context)
        return made


class _Memory:
    """The tables of a device as its slave sees them; implements `modbus.slave.Tables`."""

    __slots__ = ("_bus", "_device")

    def __init__(self, device: ModbusDevice, bus: _Bus) -> None:
        self._device = device
        self._bus = bus

    def read_bits(self, table: int, address: int, count: int) -> Sequence[int]:
        return self._read("coils" if table == READ_COILS else "discrete_inputs", address, count)

    def read_registers(self, table: int, address: int, count: int) -> Sequence[int]:
        return self._read("holding_registers" if table == READ_HOLDING_REGISTERS else "input_registers", address, count)

    def _read(self, name: str, address: int, count: int) -> Sequence[int]:
        device = self._asked()
        device.reading(name, address, count)
        table: Table = getattr(device, name)
        return table.take(address, count)

    def write_bits(self, address: int, values: Sequence[int]) -> None:
        device = self._asked()
        self._write(device.coils, address, values)
        for offset, value in enumerate(values):
            device.coil_written(address + offset, bool(value))

    def write_registers(self, address: int, values: Sequence[int]) -> None:
        device = self._asked()
        self._write(device.holding_registers, address, values)
        for offset, value in enumerate(values):
            device.register_written(address + offset, value)

    @staticmethod
    def _write(table: Table, address: int, values: Sequence[int]) -> None:
        table.take(address, len(values))  # all of them exist, or nothing is written
        for offset, value in enumerate(values):
            table[address + offset] = value

    def _asked(self) -> ModbusDevice:
        self._bus.asked = self._device
        self._device.requests += 1
        return self._device


class _Bus:
    """Carries requests to the devices at one place."""

    protocol = MODBUS
    slaves: dict[int, Slave]
    asked: Device | None = None
    """The device that the last request was for; its code may have failed."""


class _TcpBus(_Bus, TcpServer):
    @property
    def author(self) -> Device:
        return self.asked or self

    def connect(self, link: DeviceLink, number: int) -> TcpConnection:
        return _TcpRequests(self, link, number, TcpSlave(self.slaves.get(ANY_UNIT) or self.slaves))


class _TcpRequests(TcpConnection):
    def __init__(self, bus: _TcpBus, link: DeviceLink, number: int, slave: TcpSlave) -> None:
        super().__init__(bus, link, number)
        self._slave = slave

    def received(self, data: bytes) -> None:
        answers = self._slave.take(data)
        if answers:
            self.send(answers)
        if self._slave.is_lost:
            self.server.warn("got what is no MODBUS TCP, and closes the connection")
            self.close()


class _RtuBus(_Bus, LineDevice):
    _count = 0

    @property
    def author(self) -> Device:
        return self.asked or self

    def line_opened(self) -> None:
        self._slave = RtuSlave(self.slaves)

    def bytes_received(self, data: bytes) -> None:
        self.send_bytes(self._slave.take(data))
        self._count += 1
        settings = self.settings
        if settings is not None:
            # Bytes that belong together may come in two ticks.
            self.after(FRAME_GAP * settings.character_s + PERIOD_S, self._end_frame, self._count)

    def _end_frame(self, count: int) -> None:
        if count == self._count:
            self.send_bytes(self._slave.silence())


def _address(name: str, address: object) -> int:
    """Return an address of a table; one that comes out of a file may be a text of digits.

    Raises:
        UsageError: it is none.
    """
    number = int(address) if isinstance(address, str) and address.isdecimal() else address
    if not isinstance(number, int) or not 0 <= number < ADDRESSES:
        raise UsageError(f"{name}: an address must be in [0, {ADDRESSES - 1}], got {address!r}")
    return number


TABLES: Final = {"coils": 1, "discrete_inputs": 1, "holding_registers": 65535, "input_registers": 65535}
"""The tables of a device, and the largest value in each."""
