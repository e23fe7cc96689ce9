"""Devices that connect to the robot, such as a PLC that reads its registers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from elitescript.devices.agenda import Agenda
from elitescript.devices.device import Device, check_number, check_text
from elitescript.devices.kinds.lines import Answer, LineBuffer, check_lines, encoded
from elitescript.devices.surroundings import RobotAccess
from elitescript.errors import UsageError
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame
from elitescript.protocol.connection import Connection
from elitescript.protocol.transport import MemoryTransport

if TYPE_CHECKING:
    from elitescript.messages.inputs import Input
    from elitescript.messages.outputs import Output

Then = Callable[[Sequence[int]], Any]


class PortLink:
    """A connection of a device to a port of the robot: bytes take one tick in each direction.

    Args:
        connection: the robot's side.
        robot: takes what it asks for.
        agenda: of the world.
        device: the other side.
    """

    __slots__ = ("_agenda", "_device", "_robot", "_transport")

    def __init__(self, connection: Connection, robot: RobotAccess, agenda: Agenda, device: TcpClient) -> None:
        self._transport = MemoryTransport(connection)
        self._robot = robot
        self._agenda = agenda
        self._device = device
        agenda.put(1, self._begin, device)

    @property
    def is_open(self) -> bool:
        """Whether neither side has closed."""
        return self._transport.is_open

    def next_tick(self, tick: int) -> int | None:
        """Return the next tick after `tick` that the device must get although nothing happens in it."""
        return self._transport.next_tick(tick)

    def reads_snapshot(self, tick: int) -> bool:
        """See `Connection.reads_snapshot`."""
        return self.is_open and self._transport.connection.reads_snapshot(tick)

    def send(self, data: bytes) -> None:
        """Send bytes to the robot, which has them in the next tick."""
        self._agenda.put(1, lambda: self._receive(data), self._device)

    def close(self) -> None:
        """Close from the device's side."""
        self._robot.post(self._transport.end())

    def publish(self, output: Output) -> None:
        """Give the device a tick that has run."""
        self._passed_on(self._transport.publish(output))

    def _begin(self) -> None:
        self._device.stand()
        self._pass_on_data()

    def _receive(self, data: bytes) -> None:
        if self.is_open:
            self._transport.send(data)
            self._passed_on(self._transport.take_in(self._robot.present_tick, self._robot.output()))

    def _passed_on(self, inputs: list[Input]) -> None:
        transport = self._transport
        self._robot.post(inputs)
        if transport.error and not transport.is_open:
            service = self._device.service
            self._device.warn(f"sent what the {service} port of the robot cannot read: {transport.error}")
        self._pass_on_data()
        if not transport.is_open:
            self._agenda.put(1, self._device.end, self._device)
        elif transport.has_sent:
            self._agenda.put(1, lambda: self._receive(b""), self._device)

    def _pass_on_data(self) -> None:
        if data := self._transport.receive():
            self._agenda.put(1, lambda: self._device.hear(data), self._device)


class TcpClient(Device):
    """A device that connects to one of the robot's own ports.

    Override `line_received`, or `received` for what is not made of lines. A text that a method returns is sent as a
    line, bytes are sent as they are, and None sends nothing.

    Attributes:
        service: name of the port, as `--port` calls it.
        connect_at_s: when it connects; never by itself if negative.
        line_end: ends the lines of both sides. If empty, whatever arrives together counts as a line.
        encoding: of texts.
        is_connected: whether the connection stands.

    Example:
        >>> from elitescript.testing.world import TcpClient, World
        >>> class Panel(TcpClient):
        ...     service = "dashboard"
        ...     def opened(self):
        ...         self.after(5.0, self.send, "status")
        ...     def line_received(self, line):
        ...         self.log(line)
        >>> world = World(devices=[Panel()])
    """

    service: str = ""
    connect_at_s: float = 0.0
    line_end: str = "\n"
    encoding: str = "utf-8"

    _link: PortLink | None = None
    _lines: LineBuffer | None = None

    # ---------------------------------------------------------------- what a subclass may override

    def opened(self) -> Answer:
        """The connection stands."""
        return None

    def received(self, data: bytes) -> Answer:
        """Bytes have come; without an override they are cut into lines for `line_received`."""
        if self._lines is None:
            self._lines = LineBuffer(self.line_end, self.encoding)
        for line in self._lines.receive(data):
            self.send(self.line_received(line))
        return None

    def line_received(self, line: str) -> Answer:
        """A line has come, without its end."""
        return None

    def closed(self) -> None:
        """The robot has closed the connection."""

    # ---------------------------------------------------------------- what a subclass may use

    @property
    def is_connected(self) -> bool:
        """Whether the connection stands."""
        return self._link is not None and self._link.is_open

    def connect(self) -> None:
        """Connect, unless the connection stands.

        Raises:
            UsageError: the robot has no such port.
        """
        if not self.is_connected:
            self._lines = None
            self._link = self._in_world().connect(self)

    def send(self, answer: Answer) -> None:
        """Send a text as a line, or bytes as they are; lost without a connection."""
        if answer is not None and self._link is not None:
            self._link.send(encoded(answer, self.line_end, self.encoding))

    def close(self) -> None:
        """Close the connection."""
        if self._link is not None:
            self._link.close()

    # ---------------------------------------------------------------- the world's side

    def check(self) -> None:
        check_text("service", self.service)
        if not self.service:
            raise UsageError("service: is missing: the name of a port of the robot, such as modbus")
        check_number("connect_at_s", self.connect_at_s, -1.0, 1e6, "s")
        check_lines(self.line_end, self.encoding)

    def begin(self) -> None:
        if self.connect_at_s >= 0.0:
            self.after(self.connect_at_s, self.connect)

    def leave(self) -> None:
        super().leave()
        self.close()

    def stand(self) -> None:
        """The connection stands from now on."""
        self.send(self.opened())

    def hear(self, data: bytes) -> None:
        """Bytes of the robot have come."""
        self.send(self.received(data))

    def end(self) -> None:
        """The robot has closed."""
        self.closed()


class ModbusClient(TcpClient):
    """A MODBUS client, such as a PLC that reads and writes the registers of the robot's own server.

    Each request is answered by a call of `then` with the values; what the robot refuses is a warning.

    Attributes:
        unit: number that requests carry.

    Example:
        A PLC that asks twice a second for register 256 and answers in register 257.

        >>> from elitescript.testing.world import ModbusClient, World
        >>> class Plc(ModbusClient):
        ...     def opened(self):
        ...         self.every(0.5, self.read_registers, 256, 1, self.look)
        ...     def look(self, values):
        ...         self.write_register(257, values[0] + 1)
        >>> world = World(devices=[Plc()])
    """

    service: str = "modbus"
    unit: int = 1

    _transaction = 0
    _asked: dict[int, tuple[bytes, Then | None]]
    _splitter: TcpSplitter

    def read_registers(self, address: int, count: int, then: Then) -> None:
        """Read holding registers."""
        self.ask(pdu.read(pdu.READ_HOLDING_REGISTERS, address, count), then)

    def read_coils(self, address: int, count: int, then: Then) -> None:
        """Read coils."""
        self.ask(pdu.read(pdu.READ_COILS, address, count), then)

    def write_register(self, address: int, value: int) -> None:
        """Write one holding register."""
        self.ask(pdu.write_register(address, value & 0xFFFF))

    def write_coil(self, address: int, level: bool) -> None:
        """Write one coil."""
        self.ask(pdu.write_coil(address, level))

    def ask(self, request: bytes, then: Then | None = None) -> None:
        """Send any request; `then` gets the values of its answer."""
        if not self.is_connected:
            return
        self._transaction = self._transaction % 0xFFFF + 1
        self._asked[self._transaction] = request, then
        self.send(tcp_frame(self._transaction, self.unit, request))

    def check(self) -> None:
        super().check()
        check_number("unit", self.unit, 0, 255, is_whole=True)

    def stand(self) -> None:
        self._asked, self._splitter = {}, TcpSplitter()
        super().stand()

    def received(self, data: bytes) -> Answer:
        """Answers have come."""
        for transaction, _, answer in self._splitter.feed(data):
            asked = self._asked.pop(transaction, None)
            if asked is None:
                self.warn(f"got an answer that it has not asked for: transaction {transaction}")
                continue
            request, then = asked
            try:
                values = pdu.values_of(request, answer)
            except (pdu.ExceptionResponse, pdu.AnswerError) as error:
                self.warn(f"request {request.hex()}: {error}")
                continue
            if then is not None:
                then(values)
        return None
