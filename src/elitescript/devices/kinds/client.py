"""Devices that connect to the robot, such as a PLC that reads its registers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from elitescript.devices.device import Device, check_number, check_text
from elitescript.devices.kinds.lines import Answer, LineBuffer, check_lines, encoded
from elitescript.devices.surroundings import RobotAccess
from elitescript.errors import UsageError
from elitescript.modbus.frames import pdu
from elitescript.modbus.frames.tcp import TcpSplitter, tcp_frame
from elitescript.protocol.transport import MemoryTransport
from elitescript.said import said

if TYPE_CHECKING:
    from elitescript.messages.inputs import Input
    from elitescript.messages.outputs import Output

Then = Callable[[Sequence[int]], Any]


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

    _transport: MemoryTransport | None = None
    _lines: LineBuffer | None = None

    # ---------------------------------------------------------------- what a subclass may override

    def opened(self) -> Answer:
        """Act on a connection that stands."""
        return None

    def received(self, data: bytes) -> Answer:
        """Take bytes; without an override they are cut into lines for `line_received`."""
        if self._lines is None:
            self._lines = LineBuffer(self.line_end, self.encoding)
        for line in self._lines.receive(data):
            self.send(self.line_received(line))
        return None

    def line_received(self, line: str) -> Answer:
        """Take a line, without its end."""
        return None

    def closed(self) -> None:
        """Act on a connection that the robot has closed."""

    # ---------------------------------------------------------------- what a subclass may use

    @property
    def is_connected(self) -> bool:
        """Whether the connection stands."""
        return self._transport is not None and self._transport.is_open

    def connect(self) -> None:
        """Connect, unless the connection stands.

        Raises:
            UsageError: the robot has no such port.
        """
        if not self.is_connected:
            self._lines = None
            context = self._in_world()
            connection, robot = context.connect(self, self.service), context.signals.robot
            assert robot is not None
            self._robot: RobotAccess = robot
            self._transport = transport = MemoryTransport(connection)
            self.after(0.0, self._begin, transport)

    def send(self, answer: Answer) -> None:
        """Send a text as a line, or bytes as they are; lost without a connection."""
        if answer is not None and self.is_connected:
            self.after(0.0, self._give_data, self._transport, encoded(answer, self.line_end, self.encoding))

    def close(self) -> None:
        """Close the connection."""
        if self._transport is not None:
            self._robot.post(self._transport.end())

    # ---------------------------------------------------------------- called by the world

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

    def next_output_tick(self, tick: int) -> int | None:
        return None if self._transport is None else self._transport.next_tick(tick)

    def reads(self, tick: int) -> int:
        transport = self._transport
        return 0 if transport is None or not transport.is_open else transport.connection.reads(tick)

    def take_output(self, output: Output) -> None:
        assert self._transport is not None
        self._pass_on(self._transport, self._transport.publish(output))

    def _begin(self, transport: MemoryTransport) -> None:
        self.stand()
        self._pass_on_data(transport)

    def stand(self) -> None:
        """Begin a connection."""
        self.send(self.opened())

    # What the device sends and what the robot sends takes one tick each: `after(0.0, ...)`.

    def _give_data(self, transport: MemoryTransport, data: bytes) -> None:
        if transport.is_open:
            transport.send(data)
            self._pass_on(transport, transport.take_in(self._robot.present_tick, self._robot.output()))

    def _pass_on(self, transport: MemoryTransport, inputs: list[Input]) -> None:
        """Give the robot what the connection asks for, and the device what it has sent."""
        self._robot.post(inputs)
        if transport.error and not transport.is_open:
            self.warn(
                said(
                    "sent what the {service} port of the robot cannot read: {error}",
                    service=self.service,
                    error=transport.error,
                )
            )
        self._pass_on_data(transport)
        if not transport.is_open:
            self.after(0.0, self.closed)
        elif transport.has_sent:
            self.after(0.0, self._give_data, transport, b"")

    def _take_data(self, data: bytes) -> None:
        self.send(self.received(data))

    def _pass_on_data(self, transport: MemoryTransport) -> None:
        if data := transport.receive():
            self.after(0.0, self._take_data, data)


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
        self._asked: dict[int, tuple[bytes, Then | None]] = {}
        self._splitter = TcpSplitter()
        super().stand()

    def received(self, data: bytes) -> Answer:
        """Give the values of answers to the callers of `ask`."""
        for transaction, _, answer in self._splitter.feed(data):
            asked = self._asked.pop(transaction, None)
            if asked is None:
                self.warn(
                    said("got an answer that it has not asked for: transaction {transaction}", transaction=transaction)
                )
                continue
            request, then = asked
            try:
                values = pdu.values_of(request, answer)
            except (pdu.ExceptionResponse, pdu.AnswerError) as error:
                self.warn(said("request {hex}: {error}", hex=request.hex(), error=error))
                continue
            if then is not None:
                then(values)
        return None
