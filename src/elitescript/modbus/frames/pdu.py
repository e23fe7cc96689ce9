"""Requests and answers of MODBUS as bytes: function code and data, without the frame of TCP or RTU.

Numbers are big-endian, bits fill bytes from the lowest one on. Source: MODBUS Application Protocol Specification
V1.1b3, chapters 4, 6 and 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct, pack, unpack_from
from typing import Final

from elitescript.errors import PeerError, UsageError
from elitescript.records import NamedTuple
from elitescript.said import said

READ_COILS: Final = 1
READ_DISCRETE_INPUTS: Final = 2
READ_HOLDING_REGISTERS: Final = 3
READ_INPUT_REGISTERS: Final = 4
WRITE_COIL: Final = 5
WRITE_REGISTER: Final = 6
WRITE_COILS: Final = 15
WRITE_REGISTERS: Final = 16
READ_WRITE_REGISTERS: Final = 23

EXCEPTION_BIT: Final = 0x80
"""Set in the function code of an answer that refuses."""

ILLEGAL_FUNCTION: Final = 1
ILLEGAL_ADDRESS: Final = 2
ILLEGAL_VALUE: Final = 3
DEVICE_FAILURE: Final = 4
ACKNOWLEDGE: Final = 5
DEVICE_BUSY: Final = 6
NEGATIVE_ACKNOWLEDGE: Final = 7
MEMORY_PARITY: Final = 8
GATEWAY_NO_PATH: Final = 10
GATEWAY_NO_ANSWER: Final = 11

EXCEPTIONS: Final = {
    ILLEGAL_FUNCTION: "illegal function",
    ILLEGAL_ADDRESS: "illegal data address",
    ILLEGAL_VALUE: "illegal data value",
    DEVICE_FAILURE: "failure of the device",
    ACKNOWLEDGE: "accepted, but it takes its time",
    DEVICE_BUSY: "the device is busy",
    NEGATIVE_ACKNOWLEDGE: "the device cannot do that",
    MEMORY_PARITY: "parity error of the device's memory",
    GATEWAY_NO_PATH: "the gateway has no path to the device",
    GATEWAY_NO_ANSWER: "the device behind the gateway does not answer",
}
"""Exception codes in words."""

READ_BITS_MAX: Final = 2000
READ_REGISTERS_MAX: Final = 125
WRITE_BITS_MAX: Final = 1968
WRITE_REGISTERS_MAX: Final = 123
READ_WRITE_WRITE_MAX: Final = 121
"""Registers that `READ_WRITE_REGISTERS` can write; it can read `READ_REGISTERS_MAX`."""

ADDRESSES: Final = 65536
PDU_MAX: Final = 253
"""Bytes of the longest request or answer."""

COIL_ON: Final = 0xFF00

BIT_READS: Final = (READ_COILS, READ_DISCRETE_INPUTS)
REGISTER_READS: Final = (READ_HOLDING_REGISTERS, READ_INPUT_REGISTERS)
READS: Final = (*BIT_READS, *REGISTER_READS, READ_WRITE_REGISTERS)
"""Function codes whose answers carry values."""

_THREE: Final = Struct(">BHH")
_FOUR: Final = Struct(">BHHB")
_TWO_READ: Final = Struct(">BHHHHB")


class ExceptionResponse(PeerError):
    """The device refused a request.

    Args:
        code: its exception code, a key of `EXCEPTIONS` if it keeps to the specification.
        function: code of the requested function.
    """

    def __init__(self, code: int, function: int = 0) -> None:
        self.code = code
        self.function = function
        super().__init__(said("exception {code}: {exceptions}", code=code, exceptions=EXCEPTIONS.get(code, "unknown")))


class AnswerError(PeerError):
    """An answer does not belong to its request, or is malformed."""


class ModbusRequest(NamedTuple):
    """A parsed request.

    One that only writes has its range in `address` and `quantity`; the value of a coil is 0 or 1.
    """

    function: int
    address: int
    quantity: int
    values: tuple[int, ...] = ()
    write_address: int = 0
    """Where `READ_WRITE_REGISTERS` writes `values`; it reads `quantity` from `address`."""


# ------------------------------------------------------------------------------------------------- building requests


def read(function: int, address: int, count: int) -> bytes:
    """Return a request that reads.

    Args:
        function: `READ_COILS`, `READ_DISCRETE_INPUTS`, `READ_HOLDING_REGISTERS` or `READ_INPUT_REGISTERS`.
        address: of the first bit or register.
        count: how many.

    Raises:
        UsageError: another function, or a range outside the limits of MODBUS.
    """
    if function in BIT_READS:
        _check_range(address, count, READ_BITS_MAX)
    elif function in REGISTER_READS:
        _check_range(address, count, READ_REGISTERS_MAX)
    else:
        raise UsageError(f"function {function} does not read; functions 1 to 4 do")
    return _THREE.pack(function, address, count)


def write_coil(address: int, value: bool | int) -> bytes:
    """Return a request that sets one coil.

    Raises:
        UsageError: no such address.
    """
    _check_range(address, 1, 1)
    return _THREE.pack(WRITE_COIL, address, COIL_ON if value else 0)


def write_register(address: int, value: int) -> bytes:
    """Return a request that sets one register, 0 to 65535.

    Raises:
        UsageError: no such address or value.
    """
    _check_range(address, 1, 1)
    _check_values((value,))
    return _THREE.pack(WRITE_REGISTER, address, value)


def write_coils(address: int, values: Sequence[bool | int]) -> bytes:
    """Return a request that sets coils, upwards from an address.

    Raises:
        UsageError: a range outside the limits of MODBUS.
    """
    _check_range(address, len(values), WRITE_BITS_MAX)
    data = packed_bits(values)
    return _FOUR.pack(WRITE_COILS, address, len(values), len(data)) + data


def write_registers(address: int, values: Sequence[int]) -> bytes:
    """Return a request that sets registers, upwards from an address.

    Raises:
        UsageError: a range outside the limits of MODBUS, or a value outside 0 to 65535.
    """
    count = len(values)
    _check_range(address, count, WRITE_REGISTERS_MAX)
    _check_values(values)
    return pack(f">BHHB{count}H", WRITE_REGISTERS, address, count, 2 * count, *values)


def read_write_registers(read_address: int, read_count: int, write_address: int, values: Sequence[int]) -> bytes:
    """Return a request that sets registers, and reads registers afterwards.

    Raises:
        UsageError: a range outside the limits of MODBUS, or a value outside 0 to 65535.
    """
    count = len(values)
    _check_range(read_address, read_count, READ_REGISTERS_MAX)
    _check_range(write_address, count, READ_WRITE_WRITE_MAX)
    _check_values(values)
    head = (READ_WRITE_REGISTERS, read_address, read_count, write_address, count, 2 * count)
    return pack(f">BHHHHB{count}H", *head, *values)


def custom(function: int, data: bytes) -> bytes:
    """Return a request with any function code and bytes.

    Raises:
        UsageError: no function code, or too many bytes.
    """
    if not 1 <= function < EXCEPTION_BIT:
        raise UsageError(f"a function code is 1 to 127, got {function}")
    if len(data) >= PDU_MAX:
        raise UsageError(f"{len(data)} bytes do not fit behind a function code; at most {PDU_MAX - 1} do")
    return bytes((function,)) + data


# ------------------------------------------------------------------------------------------------- building answers


def exception(function: int, code: int) -> bytes:
    """Return an answer that refuses."""
    return bytes((function | EXCEPTION_BIT, code))


def bits_read(function: int, values: Sequence[bool | int]) -> bytes:
    """Return the answer to a request that read bits."""
    data = packed_bits(values)
    return bytes((function, len(data))) + data


def registers_read(function: int, values: Sequence[int]) -> bytes:
    """Return the answer to a request that read registers, 0 to 65535 each."""
    count = len(values)
    return pack(f">BB{count}H", function, 2 * count, *values)


def written(request: bytes) -> bytes:
    """Return the answer to a request that wrote: its function, address and count, or its one value."""
    return request[:5]


# ------------------------------------------------------------------------------------------------- taking apart


def request_of(pdu: bytes) -> ModbusRequest:
    """Parse a request.

    Raises:
        ExceptionResponse: `ILLEGAL_FUNCTION` for an unknown function, `ILLEGAL_VALUE` if it is malformed or outside
            the limits of MODBUS, `ILLEGAL_ADDRESS` if it goes beyond the last address.
    """
    if not pdu:
        raise ExceptionResponse(ILLEGAL_FUNCTION)
    function, size = pdu[0], len(pdu)
    if size > PDU_MAX:
        raise ExceptionResponse(ILLEGAL_VALUE, function)
    if function in REGISTER_READS or function in BIT_READS:
        if size != 5:
            raise ExceptionResponse(ILLEGAL_VALUE, function)
        _, address, count = _THREE.unpack(pdu)
        if not 1 <= count <= (READ_REGISTERS_MAX if function in REGISTER_READS else READ_BITS_MAX):
            raise ExceptionResponse(ILLEGAL_VALUE, function)
        if address + count > ADDRESSES:
            raise ExceptionResponse(ILLEGAL_ADDRESS, function)
        return ModbusRequest(function, address, count)
    if function in (WRITE_REGISTER, WRITE_COIL):
        if size != 5:
            raise ExceptionResponse(ILLEGAL_VALUE, function)
        _, address, value = _THREE.unpack(pdu)
        if function == WRITE_COIL:
            if value not in (0, COIL_ON):
                raise ExceptionResponse(ILLEGAL_VALUE, function)
            value = value and 1
        return ModbusRequest(function, address, 1, (value,))
    if function in (WRITE_REGISTERS, WRITE_COILS):
        return _several_of(pdu, function)
    if function == READ_WRITE_REGISTERS:
        return _read_write_of(pdu)
    raise ExceptionResponse(ILLEGAL_FUNCTION, function)


def _several_of(pdu: bytes, function: int) -> ModbusRequest:
    if len(pdu) < 7:
        raise ExceptionResponse(ILLEGAL_VALUE, function)
    _, address, count, size = _FOUR.unpack_from(pdu)
    is_bits = function == WRITE_COILS
    limit, needed = (WRITE_BITS_MAX, (count + 7) // 8) if is_bits else (WRITE_REGISTERS_MAX, 2 * count)
    if not 1 <= count <= limit or size != needed or len(pdu) != 6 + size:
        raise ExceptionResponse(ILLEGAL_VALUE, function)
    if address + count > ADDRESSES:
        raise ExceptionResponse(ILLEGAL_ADDRESS, function)
    return ModbusRequest(
        function, address, count, unpacked_bits(pdu[6:], count) if is_bits else registers_in(pdu, 6, count)
    )


def _read_write_of(pdu: bytes) -> ModbusRequest:
    if len(pdu) < 12:
        raise ExceptionResponse(ILLEGAL_VALUE, READ_WRITE_REGISTERS)
    _, address, count, write_address, write_count, size = _TWO_READ.unpack_from(pdu)
    if (
        not 1 <= count <= READ_REGISTERS_MAX
        or not 1 <= write_count <= READ_WRITE_WRITE_MAX
        or size != 2 * write_count
        or len(pdu) != 10 + size
    ):
        raise ExceptionResponse(ILLEGAL_VALUE, READ_WRITE_REGISTERS)
    if address + count > ADDRESSES or write_address + write_count > ADDRESSES:
        raise ExceptionResponse(ILLEGAL_ADDRESS, READ_WRITE_REGISTERS)
    return ModbusRequest(READ_WRITE_REGISTERS, address, count, registers_in(pdu, 10, write_count), write_address)


def values_of(request: bytes, answer: bytes) -> tuple[int, ...]:
    """Return the values of an answer; none for a request that wrote, or for a custom one.

    Args:
        request: the request, as the functions above build it.
        answer: the bytes of the device.

    Raises:
        ExceptionResponse: the device refused.
        AnswerError: the answer does not belong to the request, or is malformed.
    """
    function = request[0]
    if len(answer) < 2 or answer[0] != function:
        if len(answer) == 2 and answer[0] == function | EXCEPTION_BIT:
            raise ExceptionResponse(answer[1], function)
        raise AnswerError(
            said(
                "function {function} was asked for, and {hex} has come",
                function=function,
                hex=answer[:2].hex() or "nothing",
            )
        )
    size = answer[1]
    if function in REGISTER_READS or function == READ_WRITE_REGISTERS:
        count = request[3] << 8 | request[4]
        if size != 2 * count or len(answer) != 2 + size:
            raise AnswerError(
                said(
                    "{count} registers were asked for, and an answer of {answer_count} bytes has come",
                    count=count,
                    answer_count=len(answer),
                )
            )
        return registers_in(answer, 2, count)
    if function in BIT_READS:
        count = request[3] << 8 | request[4]
        if size != (count + 7) // 8 or len(answer) != 2 + size:
            raise AnswerError(
                said(
                    "{count} bits were asked for, and an answer of {answer_count} bytes has come",
                    count=count,
                    answer_count=len(answer),
                )
            )
        return unpacked_bits(answer[2:], count)
    if function in (WRITE_COIL, WRITE_REGISTER, WRITE_COILS, WRITE_REGISTERS) and answer != request[:5]:
        raise AnswerError(said("the answer {hex} does not repeat what was written", hex=answer.hex()))
    return ()


# ------------------------------------------------------------------------------------------------- bits and registers


def packed_bits(values: Sequence[bool | int]) -> bytes:
    """Return bits packed into bytes, the first one lowest; the rest of the last byte is 0."""
    number = 0
    for index, value in enumerate(values):
        if value:
            number |= 1 << index
    return number.to_bytes((len(values) + 7) // 8, "little")


def unpacked_bits(data: bytes, count: int) -> tuple[int, ...]:
    """Return the first `count` bits of bytes, each 0 or 1."""
    number = int.from_bytes(data, "little")
    return tuple([number >> index & 1 for index in range(count)])


def registers_in(data: bytes, offset: int, count: int) -> tuple[int, ...]:
    """Return `count` registers, 0 to 65535, from an offset on."""
    return unpack_from(f">{count}H", data, offset)


def _check_range(address: int, count: int, limit: int) -> None:
    if not 0 <= address < ADDRESSES:
        raise UsageError(f"a MODBUS address is 0 to {ADDRESSES - 1}, got {address}")
    if not 1 <= count <= limit:
        raise UsageError(f"one request takes 1 to {limit} of them, got {count}")
    if address + count > ADDRESSES:
        raise UsageError(f"{count} from address {address} on go beyond the last address, {ADDRESSES - 1}")


def _check_values(values: Sequence[int]) -> None:
    for value in values:
        if not 0 <= value < 65536:
            raise UsageError(f"a register holds 0 to 65535, got {value}")
