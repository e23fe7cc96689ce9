"""A slave without its line: tables of coils and registers, and answers to requests.

The contents of the addresses are a `Tables`: plain memory here, the controller's own signals or a virtual device
elsewhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final, Protocol

from elitescript.errors import UsageError
from elitescript.modbus.frames.pdu import (
    ADDRESSES,
    DEVICE_FAILURE,
    GATEWAY_NO_ANSWER,
    ILLEGAL_ADDRESS,
    READ_COILS,
    READ_DISCRETE_INPUTS,
    READ_HOLDING_REGISTERS,
    READ_INPUT_REGISTERS,
    READ_WRITE_REGISTERS,
    WRITE_COIL,
    WRITE_COILS,
    ExceptionResponse,
    bits_read,
    exception,
    registers_read,
    request_of,
    written,
)
from elitescript.modbus.frames.rtu import BROADCAST, RtuFrame, RtuSplitter, rtu_frame
from elitescript.modbus.frames.tcp import TOLERATED_LENGTH_MAX, TcpSplitter, tcp_frame

NAMES: Final = {
    READ_COILS: "coils",
    READ_DISCRETE_INPUTS: "discrete_inputs",
    READ_HOLDING_REGISTERS: "holding_registers",
    READ_INPUT_REGISTERS: "input_registers",
}
"""The four tables, by the function that reads them."""


class Tables(Protocol):
    """Coils and registers by address. Addresses and counts are within the limits of MODBUS.

    Every method raises `ExceptionResponse`, with the exception code to answer, to refuse.
    """

    def read_bits(self, table: int, address: int, count: int) -> Sequence[int]:
        """Return levels of `READ_COILS` or `READ_DISCRETE_INPUTS`, 0 or 1 each."""

    def read_registers(self, table: int, address: int, count: int) -> Sequence[int]:
        """Return values of `READ_HOLDING_REGISTERS` or `READ_INPUT_REGISTERS`, 0 to 65535 each."""

    def write_bits(self, address: int, values: Sequence[int]) -> None:
        """Set coils: all of them or, when refusing, none."""

    def write_registers(self, address: int, values: Sequence[int]) -> None:
        """Set holding registers: all of them or, when refusing, none."""


class MemoryTables:
    """Tables in memory.

    Args:
        coils: their number, or their levels; the others alike.

    Attributes:
        coils: levels, 0 or 1.
        discrete_inputs: levels, 0 or 1.
        holding_registers: values, 0 to 65535.
        input_registers: values, 0 to 65535.

    Raises:
        UsageError: too many addresses, or a value out of range.
    """

    __slots__ = ("coils", "discrete_inputs", "holding_registers", "input_registers")

    def __init__(
        self,
        *,
        coils: int | Sequence[int] = ADDRESSES,
        discrete_inputs: int | Sequence[int] = ADDRESSES,
        holding_registers: int | Sequence[int] = ADDRESSES,
        input_registers: int | Sequence[int] = ADDRESSES,
    ) -> None:
        self.coils = _filled("coils", coils, 1)
        self.discrete_inputs = _filled("discrete_inputs", discrete_inputs, 1)
        self.holding_registers = _filled("holding_registers", holding_registers, 65535)
        self.input_registers = _filled("input_registers", input_registers, 65535)

    def read_bits(self, table: int, address: int, count: int) -> Sequence[int]:
        return _part(self.coils if table == READ_COILS else self.discrete_inputs, address, count)

    def read_registers(self, table: int, address: int, count: int) -> Sequence[int]:
        rows = self.holding_registers if table == READ_HOLDING_REGISTERS else self.input_registers
        return _part(rows, address, count)

    def write_bits(self, address: int, values: Sequence[int]) -> None:
        _part(self.coils, address, len(values))
        self.coils[address : address + len(values)] = values

    def write_registers(self, address: int, values: Sequence[int]) -> None:
        _part(self.holding_registers, address, len(values))
        self.holding_registers[address : address + len(values)] = values


def _filled(name: str, content: int | Sequence[int], largest: int) -> list[int]:
    size = content if isinstance(content, int) else len(content)
    if not 0 <= size <= ADDRESSES:
        raise UsageError(f"{name} has {size} addresses; 0 to {ADDRESSES} are possible")
    if isinstance(content, int):
        return [0] * size
    for address, value in enumerate(content):
        if not 0 <= value <= largest:
            raise UsageError(f"{name}[{address}] must be 0 to {largest}, got {value}")
    return [int(value) for value in content]


def _part(rows: list[int], address: int, count: int) -> Sequence[int]:
    if address + count > len(rows):
        raise ExceptionResponse(ILLEGAL_ADDRESS)
    return rows[address : address + count]


class Slave:
    """Answers requests from its tables.

    Args:
        tables: contents of the addresses.
        functions: known function codes; all of them if None.
    """

    __slots__ = ("functions", "tables")

    def __init__(self, tables: Tables, functions: frozenset[int] | None = None) -> None:
        self.tables = tables
        self.functions = functions

    def answer(self, pdu: bytes) -> bytes:
        """Return the answer to a request; an invalid one is answered with an exception code."""
        function = pdu[0] & 0x7F if pdu else 0
        if self.functions is not None and function not in self.functions:
            return exception(function, 1)
        try:
            request = request_of(pdu)
            tables = self.tables
            if function in (READ_HOLDING_REGISTERS, READ_INPUT_REGISTERS):
                return registers_read(function, tables.read_registers(function, request.address, request.quantity))
            if function in (READ_COILS, READ_DISCRETE_INPUTS):
                return bits_read(function, tables.read_bits(function, request.address, request.quantity))
            if function == READ_WRITE_REGISTERS:
                # Both ranges must exist before anything is written.
                tables.read_registers(READ_HOLDING_REGISTERS, request.address, request.quantity)
                tables.write_registers(request.write_address, request.values)
                values = tables.read_registers(READ_HOLDING_REGISTERS, request.address, request.quantity)
                return registers_read(function, values)
            if function in (WRITE_COIL, WRITE_COILS):
                tables.write_bits(request.address, request.values)
            else:
                tables.write_registers(request.address, request.values)
            return written(pdu)
        except ExceptionResponse as error:
            return exception(function, error.code or DEVICE_FAILURE)


class TcpSlave:
    """One TCP connection of a slave, or of a gateway to several.

    Args:
        slaves: by unit, or one slave that answers for every unit. An unknown unit is answered with exception 11, as
            gateways do.
    """

    __slots__ = ("_slaves", "_splitter")

    def __init__(self, slaves: Slave | Mapping[int, Slave]) -> None:
        self._slaves = slaves
        self._splitter = TcpSplitter(TOLERATED_LENGTH_MAX)

    @property
    def is_lost(self) -> bool:
        """Whether the peer sends no MODBUS any more; the connection should be closed."""
        return self._splitter.is_lost

    def take(self, data: bytes) -> bytes:
        """Take bytes of the peer; return all answers in one piece."""
        slaves = self._slaves
        answers: list[bytes] = []
        for transaction, unit, pdu in self._splitter.feed(data):
            slave: Any = slaves if isinstance(slaves, Slave) else slaves.get(unit)
            answer = exception(pdu[0] & 0x7F, GATEWAY_NO_ANSWER) if slave is None else slave.answer(pdu)
            answers.append(tcp_frame(transaction, unit, answer))
        return b"".join(answers)


class RtuSlave:
    """The slaves on one serial line. Unknown units and broadcasts are not answered.

    Args:
        slaves: by unit, 1 to 247.
    """

    __slots__ = ("_slaves", "_splitter")

    def __init__(self, slaves: Mapping[int, Slave]) -> None:
        self._slaves = slaves
        self._splitter = RtuSplitter(is_slave=True)

    def take(self, data: bytes) -> bytes:
        """Take bytes of the line; return the answers."""
        return self._answers(self._splitter.feed(data))

    def silence(self) -> bytes:
        """End the frame, after the silence that ends one; return the answers."""
        return self._answers(self._splitter.silence())

    def _answers(self, frames: list[RtuFrame]) -> bytes:
        answers: list[bytes] = []
        for unit, pdu in frames:
            if unit == BROADCAST:
                for slave in self._slaves.values():
                    slave.answer(pdu)
            elif unit in self._slaves:
                answers.append(rtu_frame(unit, self._slaves[unit].answer(pdu)))
        return b"".join(answers)
