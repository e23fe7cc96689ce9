"""MODBUS-RTU through the serial ports of tool and control box (manual 2.10 sections 3.33 to 3.40, 3.48 to 3.55).

The port must be in MODBUS-RTU mode. A failure shows in the result, and its reason in the log: another mode, a slave
that does not answer in time, an answer that is broken, or a refusal (*assumed*).

In a secondary program a call without a time-out waits for its one transaction, inside the second that the program has;
one with a time-out looks once, as all readings do there (*assumed*).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Final

from elitescript.commands.definition.context import Robot
from elitescript.commands.definition.quantities import (
    Bool,
    Boolean,
    Either,
    Integer,
    RequestTimeOut,
    UsualTimeOut,
    Vector,
    Whole,
)
from elitescript.commands.definition.registry import Function, alias, command
from elitescript.commands.definition.results import DONE, RECEIVED, WRITTEN
from elitescript.commands.serial import CABINET_PORT, TOOL_PORT, CabinetPort, cabinet_device
from elitescript.errors import ArgumentRangeError
from elitescript.said import said

READ_COILS: Final = 1
READ_DISCRETE_INPUTS: Final = 2
READ_HOLDING_REGISTERS: Final = 3
READ_INPUT_REGISTERS: Final = 4
WRITE_COIL: Final = 5
WRITE_REGISTER: Final = 6
WRITE_COILS: Final = 15
WRITE_REGISTERS: Final = 16

TIME_OUT: Final = UsualTimeOut(5)
"""S."""
_ADDRESSES: Final = 65_536
_WRITTEN_MAX: Final = {WRITE_COILS: 1968, WRITE_REGISTERS: 123}
"""Values that one request can take."""

Slave = Annotated[int, Integer(1, 247)]
Address = Annotated[int, Integer(0, _ADDRESSES - 1)]
Count = Annotated[int, Integer(1, 125)]
RegisterValue = Annotated[int, Integer(0, 65535)]
Registers = Annotated[Any, Either(Integer(0, 65535), Vector(Integer(0, 65535), None))]
Bits = Annotated[Any, Either(Boolean(), Vector(Boolean(), None))]
Values = Annotated[tuple[int, ...], Vector(Integer(), None)]

_ARGUMENTS: Final = {
    "slave": "number of the slave.",
    "addr": "first address.",
    "address": "first address.",
    "len": "how many to read.",
    "data": "value, or list of values for the addresses from there on.",
    "timeout": "longest time to wait; 0 and less wait for ever.",
    "time_out": "longest time to wait; 0 and less wait for ever.",
    "port": "device; `/dev/ttyS2` on B1 and MINI boxes.",
}
"""Texts of the arguments, which all commands below share."""

_SINGLE: Final = {**_ARGUMENTS, "addr": "address.", "address": "address.", "data": "value to write."}
_SINGLE_BIT: Final = {**_SINGLE, "data": "value to write; 0 switches off."}


def _rtu(manual: str, arguments: dict[str, str] = _ARGUMENTS) -> Callable[[Function], Function]:
    return command(family="modbus_rtu", manual=manual, waits=True, arguments=arguments)


@_rtu("3.33")
def tool_modbus_read_registers(
    robot: Robot, slave: Slave, addr: Address, len: Count, time_out: RequestTimeOut = TIME_OUT
) -> Annotated[Values, RECEIVED]:
    """Read holding registers of a slave through the port of the tool (function code 0x03).

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return _read(robot, TOOL_PORT, READ_HOLDING_REGISTERS, slave, addr, len, time_out)


@_rtu("3.34")
def tool_modbus_read_bits(
    robot: Robot, slave: Slave, addr: Address, len: Count, time_out: RequestTimeOut = TIME_OUT
) -> Annotated[Values, RECEIVED]:
    """Read coils of a slave through the port of the tool (function code 0x01).

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return _read(robot, TOOL_PORT, READ_COILS, slave, addr, len, time_out)


@_rtu("3.35")
def tool_modbus_write_registers(
    robot: Robot, slave: Slave, addr: Address, data: Registers, timeout: RequestTimeOut = TIME_OUT
) -> Annotated[Bool, DONE]:
    """Write holding registers of a slave through the port of the tool (function code 0x10).

    Returns:
        True if it worked.
    """
    return bool(_write(robot, TOOL_PORT, WRITE_REGISTERS, slave, addr, data, timeout))


@_rtu("3.36")
def tool_modbus_write_bits(
    robot: Robot, slave: Slave, addr: Address, data: Bits, timeout: RequestTimeOut = TIME_OUT
) -> Annotated[Bool, DONE]:
    """Write coils of a slave through the port of the tool (function code 0x0F).

    Returns:
        True if it worked.
    """
    return bool(_write(robot, TOOL_PORT, WRITE_COILS, slave, addr, data, timeout))


@_rtu("3.37")
def tool_modbus_read_input_registers(
    robot: Robot, slave: Slave, addr: Address, len: Count, timeout: RequestTimeOut = TIME_OUT
) -> Annotated[Values, RECEIVED]:
    """Read input registers of a slave through the port of the tool (function code 0x04).

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return _read(robot, TOOL_PORT, READ_INPUT_REGISTERS, slave, addr, len, timeout)


@_rtu("3.38")
def tool_modbus_read_input_bits(
    robot: Robot, slave: Slave, addr: Address, len: Count, timeout: RequestTimeOut = TIME_OUT
) -> Annotated[Values, RECEIVED]:
    """Read discrete inputs of a slave through the port of the tool (function code 0x02).

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return _read(robot, TOOL_PORT, READ_DISCRETE_INPUTS, slave, addr, len, timeout)


@_rtu("3.39", _SINGLE_BIT)
def tool_modbus_write_single_bit(
    robot: Robot, slave: Slave, addr: Address, data: Whole, timeout: RequestTimeOut = TIME_OUT
) -> Annotated[Whole, WRITTEN]:
    """Write one coil of a slave through the port of the tool (function code 0x05).

    Returns:
        1 if it was written; what is less than 0 is a failure too.
    """
    return _write(robot, TOOL_PORT, WRITE_COIL, slave, addr, int(data != 0), timeout)


@_rtu("3.40", _SINGLE)
def tool_modbus_write_single_register(
    robot: Robot, slave: Slave, addr: Address, data: RegisterValue, timeout: RequestTimeOut = TIME_OUT
) -> Annotated[Whole, WRITTEN]:
    """Write one holding register of a slave through the port of the tool (function code 0x06).

    Returns:
        1 if it was written; what is less than 0 is a failure too.
    """
    return _write(robot, TOOL_PORT, WRITE_REGISTER, slave, addr, data, timeout)


@_rtu("3.48")
def serial_modbus_write_registers(
    robot: Robot,
    slave: Slave,
    address: Address,
    data: Registers,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Whole, WRITTEN]:
    """Write holding registers of a slave through the port of the control box (function code 0x10).

    Returns:
        How many were written; what is less than 0 is a failure too.
    """
    return _write(robot, cabinet_device(robot, port), WRITE_REGISTERS, slave, address, data, timeout)


@_rtu("3.49")
def serial_modbus_write_bits(
    robot: Robot,
    slave: Slave,
    address: Address,
    data: Bits,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Whole, WRITTEN]:
    """Write coils of a slave through the port of the control box (function code 0x0F).

    Returns:
        How many were written; what is less than 0 is a failure too.
    """
    return _write(robot, cabinet_device(robot, port), WRITE_COILS, slave, address, data, timeout)


@_rtu("3.50")
def serial_modbus_read_registers(
    robot: Robot,
    slave: Slave,
    address: Address,
    len: Count,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Values, RECEIVED]:
    """Read holding registers of a slave through the port of the control box (function code 0x03).

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return _read(robot, cabinet_device(robot, port), READ_HOLDING_REGISTERS, slave, address, len, timeout)


@_rtu("3.51")
def serial_modbus_read_bits(
    robot: Robot,
    slave: Slave,
    address: Address,
    len: Count,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Values, RECEIVED]:
    """Read coils of a slave through the port of the control box (function code 0x01).

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return _read(robot, cabinet_device(robot, port), READ_COILS, slave, address, len, timeout)


@_rtu("3.52")
def serial_modbus_read_input_registers(
    robot: Robot,
    slave: Slave,
    address: Address,
    len: Count,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Values, RECEIVED]:
    """Read input registers of a slave through the port of the control box (function code 0x04).

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return _read(robot, cabinet_device(robot, port), READ_INPUT_REGISTERS, slave, address, len, timeout)


@_rtu("3.53")
def serial_modbus_read_input_bits(
    robot: Robot,
    slave: Slave,
    address: Address,
    len: Count,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Values, RECEIVED]:
    """Read discrete inputs of a slave through the port of the control box (function code 0x02).

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return _read(robot, cabinet_device(robot, port), READ_DISCRETE_INPUTS, slave, address, len, timeout)


@_rtu("3.54", _SINGLE_BIT)
def serial_modbus_write_single_bit(
    robot: Robot,
    slave: Slave,
    address: Address,
    data: Whole,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Whole, WRITTEN]:
    """Write one coil of a slave through the port of the control box (function code 0x05).

    Returns:
        1 if it was written; what is less than 0 is a failure too.
    """
    return _write(robot, cabinet_device(robot, port), WRITE_COIL, slave, address, int(data != 0), timeout)


@_rtu("3.55", _SINGLE)
def serial_modbus_write_single_register(
    robot: Robot,
    slave: Slave,
    address: Address,
    data: RegisterValue,
    timeout: RequestTimeOut = TIME_OUT,
    port: CabinetPort = CABINET_PORT,
) -> Annotated[Whole, WRITTEN]:
    """Write one holding register of a slave through the port of the control box (function code 0x06).

    Returns:
        1 if it was written; what is less than 0 is a failure too.
    """
    return _write(robot, cabinet_device(robot, port), WRITE_REGISTER, slave, address, data, timeout)


# Older names, in public programs.
for _name in (
    "write_registers",
    "write_bits",
    "read_registers",
    "read_bits",
    "read_input_registers",
    "read_input_bits",
    "write_single_bit",
    "write_single_register",
):
    alias(f"masterboard_modbus_rtu_{_name}", of=f"serial_modbus_{_name}", evidence="observed")


def _read(
    robot: Robot, device: str, function: int, slave: int, address: int, count: int, timeout_s: float
) -> tuple[int, ...]:
    """Read values of a slave; return none if the request fails.

    Raises:
        ArgumentRangeError: beyond the last address.
    """
    _check_end(address, count)
    is_polled = type(timeout_s) is not UsualTimeOut
    return robot.lines.read_slave(device, slave, function, address, count, timeout_s, is_polled=is_polled) or ()


def _write(robot: Robot, device: str, function: int, slave: int, address: int, data: Any, timeout_s: float) -> int:
    """Write values to a slave; return how many it has taken, 0 if the request fails.

    Raises:
        ArgumentRangeError: no values, more than a request can take, or beyond the last address.
    """
    values = tuple(map(int, data if isinstance(data, tuple) else (data,)))
    most = _WRITTEN_MAX.get(function, 1)
    if not 1 <= len(values) <= most:
        text = said("data must have 1 to {most} elements, got {count}", most=most, count=len(values))
        raise ArgumentRangeError(text, argument="data", value=len(values), limit=f"1 to {most} elements")
    _check_end(address, len(values))
    is_polled = type(timeout_s) is not UsualTimeOut
    is_done = robot.lines.write_slave(device, slave, function, address, values, timeout_s, is_polled=is_polled)
    return len(values) if is_done else 0


def _check_end(address: int, count: int) -> None:
    if address + count > _ADDRESSES:
        text = said(
            "{count} from address {address} on go beyond the last address, {addresses}",
            count=count,
            address=address,
            addresses=_ADDRESSES - 1,
        )
        raise ArgumentRangeError(text, value=address + count - 1, limit=f"<= {_ADDRESSES - 1}")
