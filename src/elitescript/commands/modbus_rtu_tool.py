"""MODBUS-RTU through the serial port of the tool (manual 2.10 sections 3.33 to 3.40).

The port has to be in MODBUS-RTU mode. A read that fails gives an empty list (*assumed*).
"""

from __future__ import annotations

from typing import Annotated, Any, Final

from elitescript.commands.quantities import Bool, Boolean, Either, Integer, TimeOut, Vector, Whole
from elitescript.commands.registry import command
from elitescript.errors import NotSimulatedError

_NOT_YET: Final = "MODBUS-RTU is not simulated yet"

_SPELLINGS: Final = {"address": "addr", "time_out": "timeout"}
_READ_SPELLINGS: Final = {"address": "addr", "timeout": "time_out"}

_Slave = Annotated[int, Integer(1, 247)]
_Address = Annotated[int, Integer(0)]
_Count = Annotated[int, Integer(1, 125)]
_Registers = Annotated[Any, Either(Integer(0, 65535), Vector(Integer(0, 65535), None))]
_Bits = Annotated[Any, Either(Boolean(), Vector(Boolean(), None))]
_Values = Annotated[tuple[int, ...], Vector(Integer(), None)]


@command(family="modbus_rtu", manual="3.33", spellings=_READ_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_read_registers(slave: _Slave, addr: _Address, len: _Count, time_out: TimeOut = 5) -> _Values:
    """Read holding registers of a slave through the port of the tool (function code 0x03).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        time_out: longest time to wait; 0 and less wait for ever.

    Returns:
        The values.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.34", spellings=_READ_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_read_bits(slave: _Slave, addr: _Address, len: _Count, time_out: TimeOut = 5) -> _Values:
    """Read coils of a slave through the port of the tool (function code 0x01).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        time_out: longest time to wait; 0 and less wait for ever.

    Returns:
        The values, each 0 or 1.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.35", spellings=_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_write_registers(slave: _Slave, addr: _Address, data: _Registers, timeout: TimeOut = 5) -> Bool:
    """Write holding registers of a slave through the port of the tool (function code 0x10).

    Args:
        slave: number of the slave.
        addr: first address.
        data: value, or list of values for the addresses from there on.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        True if it worked.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.36", spellings=_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_write_bits(slave: _Slave, addr: _Address, data: _Bits, timeout: TimeOut = 5) -> Bool:
    """Write coils of a slave through the port of the tool (function code 0x0F).

    Args:
        slave: number of the slave.
        addr: first address.
        data: value, or list of values for the addresses from there on.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        True if it worked.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.37", spellings=_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_read_input_registers(slave: _Slave, addr: _Address, len: _Count, timeout: TimeOut = 5) -> _Values:
    """Read input registers of a slave through the port of the tool (function code 0x04).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        The values.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.38", spellings=_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_read_input_bits(slave: _Slave, addr: _Address, len: _Count, timeout: TimeOut = 5) -> _Values:
    """Read discrete inputs of a slave through the port of the tool (function code 0x02).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        The values, each 0 or 1.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.39", spellings=_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_write_single_bit(slave: _Slave, addr: _Address, data: Whole, timeout: TimeOut = 5) -> Whole:
    """Write one coil of a slave through the port of the tool (function code 0x05).

    Args:
        slave: number of the slave.
        addr: address.
        data: value to write; 0 switches off.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        1 if it was written, 0 and less if not.
    """
    raise NotSimulatedError(_NOT_YET)


@command(family="modbus_rtu", manual="3.40", spellings=_SPELLINGS, waits=True, is_simulated=False)
def tool_modbus_write_single_register(slave: _Slave, addr: _Address, data: Whole, timeout: TimeOut = 5) -> Whole:
    """Write one holding register of a slave through the port of the tool (function code 0x06).

    Args:
        slave: number of the slave.
        addr: address.
        data: value to write.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        1 if it was written, 0 and less if not.
    """
    raise NotSimulatedError(_NOT_YET)
