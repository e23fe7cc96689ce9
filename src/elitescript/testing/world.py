"""Virtual surroundings for tests of robot programs: devices, wires and faults in the robot's own time.

    >>> from elitescript.testing.world import TcpServer, World

See `docs/devices.md`.
"""

from __future__ import annotations

from pathlib import Path

from elitescript.errors import UsageError
from elitescript.worlds.cell import load_cell
from elitescript.worlds.virtual.agenda import DeviceError
from elitescript.worlds.virtual.client import ModbusClient, TcpClient
from elitescript.worlds.virtual.device import Device
from elitescript.worlds.virtual.faults import Fault
from elitescript.worlds.virtual.modbus import ModbusDevice
from elitescript.worlds.virtual.parts import Parts
from elitescript.worlds.virtual.serial import SerialDevice
from elitescript.worlds.virtual.signals import RobotSignals
from elitescript.worlds.virtual.tcp import TcpConnection, TcpServer
from elitescript.worlds.virtual.wiring import Schedule, Wire
from elitescript.worlds.virtual.world import World
from elitescript.worlds.virtual.xmlrpc import RpcFault, XmlRpcServer


def load_world(path: str | Path) -> World:
    """The world that a file declares, to add devices to it before a robot gets it.

    Raises:
        UsageError: a mistake in the file, or nothing in it that is beside the robot; the text names file and line.
    """
    world = load_cell(path).world
    if world is None:
        raise UsageError(f"{path} declares nothing beside the robot")
    return world


__all__ = [
    "Device",
    "DeviceError",
    "Fault",
    "ModbusClient",
    "ModbusDevice",
    "Parts",
    "RobotSignals",
    "RpcFault",
    "Schedule",
    "SerialDevice",
    "TcpClient",
    "TcpConnection",
    "TcpServer",
    "Wire",
    "World",
    "XmlRpcServer",
    "load_world",
]
