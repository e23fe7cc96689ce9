"""MODBUS-RTU through the serial port of the control box (manual 2.10 sections 3.48 to 3.55).

The port has to be in MODBUS-RTU mode. A read that fails gives an empty list (*assumed*).
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.quantities import Boolean, Either, Integer, TimeOut, Vector, Whole
from elitescript.commands.registry import alias, command
from elitescript.commands.serial import CABINET_PORT, CabinetPort
from elitescript.errors import NotSimulatedError

_NOT_YET: Final = "MODBUS-RTU is not simulated yet"

_SPELLINGS: Final = {"addr": "address", "time_out": "timeout"}

_Slave = Annotated[int, Integer(1, 247)]
_Address = Annotated[int, Integer(0)]
_Count = Annotated[int, Integer(1, 125)]
_Registers = Annotated[Any, Either(Integer(0, 65535), Vector(Integer(0, 65535), None))]
_Bits = Annotated[Any, Either(Boolean(), Vector(Boolean(), None))]
_Values = Annotated[tuple[int, ...], Vector(Integer(), None)]


@command(family="modbus_rtu", manual="3.48", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_write_registers(
    slave: _Slave, address: _Address, data: _Registers, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> Whole:
    """Write holding registers of a slave through the port of the control box (function code 0x10).

    Args:
        slave: number of the slave.
        address: first address.
        data: value, or list of values for the addresses from there on.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        How many were written, 0 and less for a failure.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.49", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_write_bits(
    slave: _Slave, address: _Address, data: _Bits, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> Whole:
    """Write coils of a slave through the port of the control box (function code 0x0F).

    Args:
        slave: number of the slave.
        address: first address.
        data: value, or list of values for the addresses from there on.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        How many were written, 0 and less for a failure.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.50", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_read_registers(
    slave: _Slave, address: _Address, len: _Count, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> _Values:
    """Read holding registers of a slave through the port of the control box (function code 0x03).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.51", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_read_bits(
    slave: _Slave, address: _Address, len: _Count, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> _Values:
    """Read coils of a slave through the port of the control box (function code 0x01).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values, each 0 or 1.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.52", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_read_input_registers(
    slave: _Slave, address: _Address, len: _Count, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> _Values:
    """Read input registers of a slave through the port of the control box (function code 0x04).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.53", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_read_input_bits(
    slave: _Slave, address: _Address, len: _Count, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> _Values:
    """Read discrete inputs of a slave through the port of the control box (function code 0x02).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values, each 0 or 1.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.54", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_write_single_bit(
    slave: _Slave, address: _Address, data: Whole, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> Whole:
    """Write one coil of a slave through the port of the control box (function code 0x05).

    Args:
        slave: number of the slave.
        address: address.
        data: value to write; 0 switches off.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        1 if it was written, 0 and less if not.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.55", spellings=_SPELLINGS, waits=True, is_simulated=False)
def serial_modbus_write_single_register(
    slave: _Slave, address: _Address, data: Whole, timeout: TimeOut = 5, port: CabinetPort = CABINET_PORT
) -> Whole:
    """Write one holding register of a slave through the port of the control box (function code 0x06).

    Args:
        slave: number of the slave.
        address: address.
        data: value to write.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        1 if it was written, 0 and less if not.
    """
    raise NotSimulatedError(_NOT_YET)


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
