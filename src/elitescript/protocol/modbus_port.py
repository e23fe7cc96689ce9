"""The controller's own Modbus TCP server, port 502: registers and coils that mirror the robot and may be written.

`modbus.port_map` is the table of addresses. Reads are answered at once, from the snapshot of the last tick. A write is
a request to the robot and is answered when the robot has handled it, one at a time for each client; later requests of
the client wait. So every read after the answer sees the written value. A coil is set by itself, without its neighbours,
so that no client undoes the writes of another.

As at the RTSI port, remote and local control make no difference, and an output that is tied to the task keeps the
written value until the task releases it.

Evidence: port and table are *documented*, that clients use functions 1, 3, 5, 6 and 16 is *observed*. *Assumed*: the
other functions, that any unit is answered, and the exceptions: 2 for unknown or read-only addresses, 3 for values that
the robot refuses, 4 if the robot was restarted in between.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

from elitescript.errors import ArgumentRangeError, ScriptError
from elitescript.messages.inputs import Do, Input
from elitescript.messages.machine import MachineRequest, WritePortCoils, WritePortRegisters
from elitescript.messages.outcomes import Done, Outcome, Refused, RegistersRead
from elitescript.messages.outputs import Output
from elitescript.messages.snapshot import RobotDescription
from elitescript.modbus.frames.pdu import (
    BIT_READS,
    DEVICE_FAILURE,
    ILLEGAL_ADDRESS,
    ILLEGAL_VALUE,
    READ_WRITE_REGISTERS,
    WRITE_COIL,
    WRITE_COILS,
    WRITE_REGISTER,
    WRITE_REGISTERS,
    ExceptionResponse,
    ModbusRequest,
    bits_read,
    exception,
    registers_read,
    request_of,
    written,
)
from elitescript.modbus.frames.tcp import LENGTH_MAX, TOLERATED_LENGTH_MAX, TcpFrame, TcpSplitter, tcp_frame
from elitescript.modbus.port_image import PortImage, check_writable_coils, check_writable_registers
from elitescript.modbus.port_map import REGISTER_PARTS, View
from elitescript.protocol.connection import Connection, ProtocolError, is_restarted
from elitescript.records import NamedTuple

NUMBER: Final = 502
SPARE_NUMBER: Final = 5020
"""Used where port 502 is not permitted."""
REQUESTS_PER_TICK: Final = 20
"""Of one client; further ones wait for the next tick."""
REQUESTS_OF_ALL: Final = 200
"""Of all clients of a robot in a tick, about 2 ms of work; many clients share it."""
REQUESTS_MIN: Final = 2
"""Of each client, however many there are."""

_WRITES: Final = frozenset({WRITE_COIL, WRITE_COILS, WRITE_REGISTER, WRITE_REGISTERS, READ_WRITE_REGISTERS})


class ModbusPort:
    """State that the clients of one robot share: registers, coils and replies of the last tick, computed once.

    Args:
        description: the robot.

    Attributes:
        clients: their number.
    """

    __slots__ = ("_image", "_outcomes", "_output", "_version", "clients")

    def __init__(self, description: RobotDescription) -> None:
        self._version = description.version
        self._image: PortImage | None = None
        self._output: Output | None = None
        self._outcomes: dict[str, Outcome] = {}
        self.clients = 0

    @property
    def share(self) -> int:
        """Limit of requests of each client in a tick."""
        return max(REQUESTS_MIN, min(REQUESTS_PER_TICK, REQUESTS_OF_ALL // max(1, self.clients)))

    def image(self, output: Output) -> PortImage:
        """Return registers and coils of a tick."""
        image = self._image
        if image is None or image.view.snapshot is not output.snapshot:
            image = self._image = PortImage(View(output.snapshot, self._version))
        return image

    def outcome(self, output: Output, origin: str) -> Outcome | None:
        """Return the outcome of the request of an origin in a tick; None without a reply."""
        if output is not self._output:
            self._output = output
            self._outcomes = {reply.origin: reply.outcome for reply in output.replies}
        return self._outcomes.get(origin)


class _Write(NamedTuple):
    """A write that the robot has not answered yet."""

    origin: str
    frame: TcpFrame
    request: ModbusRequest


class ModbusConnection(Connection):
    """One client.

    Each write has its own origin, `modbus#2/7` for the seventh of `modbus#2`, so that no reply is taken for that of
    another.

    Args:
        origin: see `Connection`.
        description: the robot.
        port: shared with the other clients.
    """

    __slots__ = ("_frames", "_left", "_port", "_splitter", "_tick", "_ticks", "_write")

    def __init__(self, origin: str, description: RobotDescription, port: ModbusPort) -> None:
        super().__init__(origin, description)
        self._port = port
        self._splitter = TcpSplitter(TOLERATED_LENGTH_MAX)
        self._frames: deque[TcpFrame] = deque()
        self._write: _Write | None = None
        self._tick = -1
        self._left = 0
        self._ticks = 0
        """Number of published ticks."""
        port.clients += 1

    def receive(self, data: bytes, output: Output) -> list[Input]:
        self._frames += self._splitter.feed(data)
        inputs = self._go_on(output)
        self._check_stream()
        return inputs

    @property
    def is_busy(self) -> bool:
        return bool(self._frames) or self._write is not None

    @property
    def is_expecting(self) -> bool:
        return self.is_busy

    def reads(self, tick: int) -> int:
        """See `Connection.reads`: a request may come at any time."""
        return REGISTER_PARTS

    def publish(self, output: Output) -> None:
        self._ticks += 1
        if self._write is not None:
            self._settle(self._write, output)
        if self._frames:
            self._due += self._go_on(output)
        self._check_stream()

    def read_on(self, output: Output) -> list[Input]:
        self._left = self._port.share
        return self._go_on(output)

    def closed(self) -> list[Input]:
        self._port.clients -= 1
        return []

    def _check_stream(self) -> None:
        """Close a connection with invalid bytes, once earlier requests are answered."""
        if self._splitter.is_lost and not self.is_busy and not self.is_over:
            self.is_over = True
            raise ProtocolError(f"this is no Modbus TCP: the length in a header must be 2 to {LENGTH_MAX}")

    # ---------------------------------------------------------------- requests

    def _go_on(self, output: Output) -> list[Input]:
        """Take requests in their order, up to the first write or as many as a tick allows."""
        if self._ticks < 2 and not output.has(REGISTER_PARTS):
            # Connected after the last tick, or during it: the next tick has a snapshot for it.
            return []
        if output.tick != self._tick:
            self._tick, self._left = output.tick, self._port.share
        while self._frames and self._write is None and self._left > 0:
            self._left -= 1
            inputs = self._take(self._frames.popleft(), output)
            if inputs:
                return inputs
        return []

    def _take(self, frame: TcpFrame, output: Output) -> list[Input]:
        try:
            request = request_of(frame.pdu)
            if request.function in _WRITES:
                return self._begin(frame, request, output)
            self._answer(frame, self._values(request, output))
        except ExceptionResponse as error:
            self._refuse(frame, error.code)
        return []

    def _begin(self, frame: TcpFrame, request: ModbusRequest, output: Output) -> list[Input]:
        change = _change(request)
        if request.function == READ_WRITE_REGISTERS:
            # Registers to read must exist before anything is written.
            self._values(request, output)
        self._write = _Write(self.next_origin(), frame, request)
        return [Do(self._write.origin, change, is_answered=True)]

    def _settle(self, write: _Write, output: Output) -> None:
        """Answer a write if the robot has replied to it, or was restarted."""
        outcome = self._port.outcome(output, write.origin)
        if outcome is not None:
            self._write = None
            self._pass_on(write, outcome)
        elif is_restarted(output):
            self._write = None
            self._refuse(write.frame, DEVICE_FAILURE)

    def _pass_on(self, write: _Write, outcome: Outcome) -> None:
        """Answer a write; function 23 with the registers that the robot has read right after the write."""
        is_mixed = write.request.function == READ_WRITE_REGISTERS
        match outcome:
            case Refused():
                self._refuse(write.frame, ILLEGAL_VALUE)
            case Done() if not is_mixed:
                self._answer(write.frame, written(write.frame.pdu))
            case RegistersRead(values) if is_mixed and len(values) == write.request.quantity:
                self._answer(write.frame, registers_read(READ_WRITE_REGISTERS, values))
            case _:
                # The robot's process is not trusted: it may answer anything.
                self._refuse(write.frame, DEVICE_FAILURE)

    def _values(self, request: ModbusRequest, output: Output) -> bytes:
        image, function = self._port.image(output), request.function
        read: Callable[[int, int], list[int] | list[bool]]
        answer, read = (bits_read, image.coils) if function in BIT_READS else (registers_read, image.registers)
        try:
            return answer(function, read(request.address, request.quantity))
        except ArgumentRangeError as error:
            raise ExceptionResponse(ILLEGAL_ADDRESS, function) from error

    def _answer(self, frame: TcpFrame, pdu: bytes) -> None:
        self.send(tcp_frame(frame.transaction, frame.unit, pdu))

    def _refuse(self, frame: TcpFrame, code: int) -> None:
        self._answer(frame, exception(frame.pdu[0] & 0x7F, code))


def _change(request: ModbusRequest) -> MachineRequest:
    """Return the request to the machine of a write.

    Raises:
        ExceptionResponse: an unknown or read-only address.
    """
    try:
        if request.function in (WRITE_COIL, WRITE_COILS):
            check_writable_coils(request.address, len(request.values))
            return WritePortCoils(request.address, tuple(map(bool, request.values)))
        is_mixed = request.function == READ_WRITE_REGISTERS
        first = request.write_address if is_mixed else request.address
        check_writable_registers(first, len(request.values))
        if is_mixed:
            return WritePortRegisters(first, request.values, request.address, request.quantity)
        return WritePortRegisters(first, request.values)
    except ScriptError as error:
        raise ExceptionResponse(ILLEGAL_ADDRESS, request.function) from error
