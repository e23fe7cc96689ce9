"""MODBUS-RTU through the serial port of the tool (manual 2.10 sections 3.33 to 3.40).

The port has to be in MODBUS-RTU mode. What fails shows in the result, and its reason in the log: another mode, a slave
that does not answer in time, whose answer is broken, or that refuses (*assumed*).
"""

from __future__ import annotations

from elitescript.commands import modbus_rtu as rtu
from elitescript.commands.definition.context import Robot
from elitescript.commands.definition.quantities import Bool, TimeOut, Whole
from elitescript.commands.definition.registry import command
from elitescript.commands.serial import TOOL_PORT


@command(family="modbus_rtu", manual="3.33", waits=True)
def tool_modbus_read_registers(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, len: rtu.Count, time_out: TimeOut = 5
) -> rtu.Values:
    """Read holding registers of a slave through the port of the tool (function code 0x03).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        time_out: longest time to wait; 0 and less wait for ever.

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, TOOL_PORT, rtu.READ_HOLDING_REGISTERS, slave, addr, len, time_out)


@command(family="modbus_rtu", manual="3.34", waits=True)
def tool_modbus_read_bits(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, len: rtu.Count, time_out: TimeOut = 5
) -> rtu.Values:
    """Read coils of a slave through the port of the tool (function code 0x01).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        time_out: longest time to wait; 0 and less wait for ever.

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, TOOL_PORT, rtu.READ_COILS, slave, addr, len, time_out)


@command(family="modbus_rtu", manual="3.35", waits=True)
def tool_modbus_write_registers(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, data: rtu.Registers, timeout: TimeOut = 5
) -> Bool:
    """Write holding registers of a slave through the port of the tool (function code 0x10).

    Args:
        slave: number of the slave.
        addr: first address.
        data: value, or list of values for the addresses from there on.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        True if it worked.
    """
    return bool(rtu.write(robot, TOOL_PORT, rtu.WRITE_REGISTERS, slave, addr, data, timeout))


@command(family="modbus_rtu", manual="3.36", waits=True)
def tool_modbus_write_bits(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, data: rtu.Bits, timeout: TimeOut = 5
) -> Bool:
    """Write coils of a slave through the port of the tool (function code 0x0F).

    Args:
        slave: number of the slave.
        addr: first address.
        data: value, or list of values for the addresses from there on.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        True if it worked.
    """
    return bool(rtu.write(robot, TOOL_PORT, rtu.WRITE_COILS, slave, addr, data, timeout))


@command(family="modbus_rtu", manual="3.37", waits=True)
def tool_modbus_read_input_registers(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, len: rtu.Count, timeout: TimeOut = 5
) -> rtu.Values:
    """Read input registers of a slave through the port of the tool (function code 0x04).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, TOOL_PORT, rtu.READ_INPUT_REGISTERS, slave, addr, len, timeout)


@command(family="modbus_rtu", manual="3.38", waits=True)
def tool_modbus_read_input_bits(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, len: rtu.Count, timeout: TimeOut = 5
) -> rtu.Values:
    """Read discrete inputs of a slave through the port of the tool (function code 0x02).

    Args:
        slave: number of the slave.
        addr: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, TOOL_PORT, rtu.READ_DISCRETE_INPUTS, slave, addr, len, timeout)


@command(family="modbus_rtu", manual="3.39", waits=True)
def tool_modbus_write_single_bit(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, data: Whole, timeout: TimeOut = 5
) -> Whole:
    """Write one coil of a slave through the port of the tool (function code 0x05).

    Args:
        slave: number of the slave.
        addr: address.
        data: value to write; 0 switches off.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        1 if it was written, 0 and less if not.
    """
    return rtu.write(robot, TOOL_PORT, rtu.WRITE_COIL, slave, addr, int(data != 0), timeout)


@command(family="modbus_rtu", manual="3.40", waits=True)
def tool_modbus_write_single_register(
    robot: Robot, slave: rtu.Slave, addr: rtu.Address, data: rtu.RegisterValue, timeout: TimeOut = 5
) -> Whole:
    """Write one holding register of a slave through the port of the tool (function code 0x06).

    Args:
        slave: number of the slave.
        addr: address.
        data: value to write.
        timeout: longest time to wait; 0 and less wait for ever.

    Returns:
        1 if it was written, 0 and less if not.
    """
    return rtu.write(robot, TOOL_PORT, rtu.WRITE_REGISTER, slave, addr, data, timeout)
