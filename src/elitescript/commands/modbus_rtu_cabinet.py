"""MODBUS-RTU through the serial port of the control box (manual 2.10 sections 3.48 to 3.55).

The port has to be in MODBUS-RTU mode. What fails shows in the result, and its reason in the log: another mode, a slave
that does not answer in time, whose answer is broken, or that refuses (*assumed*).
"""

from __future__ import annotations

from elitescript.commands import modbus_rtu as rtu
from elitescript.commands.definition.context import Robot
from elitescript.commands.definition.quantities import TimeOut, Whole
from elitescript.commands.definition.registry import alias, command
from elitescript.commands.serial import CABINET_PORT, CabinetPort, cabinet_device


@command(family="modbus_rtu", manual="3.48", waits=True)
def serial_modbus_write_registers(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    data: rtu.Registers,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
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
    return rtu.write(robot, cabinet_device(robot, port), rtu.WRITE_REGISTERS, slave, address, data, timeout)


@command(family="modbus_rtu", manual="3.49", waits=True)
def serial_modbus_write_bits(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    data: rtu.Bits,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
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
    return rtu.write(robot, cabinet_device(robot, port), rtu.WRITE_COILS, slave, address, data, timeout)


@command(family="modbus_rtu", manual="3.50", waits=True)
def serial_modbus_read_registers(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    len: rtu.Count,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
) -> rtu.Values:
    """Read holding registers of a slave through the port of the control box (function code 0x03).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, cabinet_device(robot, port), rtu.READ_HOLDING_REGISTERS, slave, address, len, timeout)


@command(family="modbus_rtu", manual="3.51", waits=True)
def serial_modbus_read_bits(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    len: rtu.Count,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
) -> rtu.Values:
    """Read coils of a slave through the port of the control box (function code 0x01).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, cabinet_device(robot, port), rtu.READ_COILS, slave, address, len, timeout)


@command(family="modbus_rtu", manual="3.52", waits=True)
def serial_modbus_read_input_registers(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    len: rtu.Count,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
) -> rtu.Values:
    """Read input registers of a slave through the port of the control box (function code 0x04).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, cabinet_device(robot, port), rtu.READ_INPUT_REGISTERS, slave, address, len, timeout)


@command(family="modbus_rtu", manual="3.53", waits=True)
def serial_modbus_read_input_bits(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    len: rtu.Count,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
) -> rtu.Values:
    """Read discrete inputs of a slave through the port of the control box (function code 0x02).

    Args:
        slave: number of the slave.
        address: first address.
        len: how many to read.
        timeout: longest time to wait; 0 and less wait for ever.
        port: device; `/dev/ttyS2` on B1 and MINI boxes.

    Returns:
        The values, each 0 or 1; an empty list if that fails (*assumed*).
    """
    return rtu.read(robot, cabinet_device(robot, port), rtu.READ_DISCRETE_INPUTS, slave, address, len, timeout)


@command(family="modbus_rtu", manual="3.54", waits=True)
def serial_modbus_write_single_bit(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    data: Whole,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
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
    return rtu.write(robot, cabinet_device(robot, port), rtu.WRITE_COIL, slave, address, int(data != 0), timeout)


@command(family="modbus_rtu", manual="3.55", waits=True)
def serial_modbus_write_single_register(
    robot: Robot,
    slave: rtu.Slave,
    address: rtu.Address,
    data: rtu.RegisterValue,
    timeout: TimeOut = 5,
    port: CabinetPort = CABINET_PORT,
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
    return rtu.write(robot, cabinet_device(robot, port), rtu.WRITE_REGISTER, slave, address, data, timeout)


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
