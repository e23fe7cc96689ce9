"""Virtual surroundings for tests of robot programs: devices, wires and faults in the robot's own time.

    >>> from elitescript.testing.world import TcpServer, World

See `docs/how-to/devices.md`.
"""

from __future__ import annotations

from pathlib import Path

from elitescript.devices.agenda import DeviceError
from elitescript.devices.channels.faults import Fault
from elitescript.devices.device import Device
from elitescript.devices.kinds.client import ModbusClient, TcpClient
from elitescript.devices.kinds.modbus import ModbusDevice
from elitescript.devices.kinds.parts import Parts
from elitescript.devices.kinds.serial import SerialDevice
from elitescript.devices.kinds.tcp import TcpConnection, TcpServer
from elitescript.devices.kinds.wiring import Schedule, Wire
from elitescript.devices.kinds.xmlrpc import RpcFault, XmlRpcServer
from elitescript.devices.signals import RobotSignals
from elitescript.devices.world import World
from elitescript.errors import UsageError
from elitescript.world_file import load_world_file


def load_world(path: str | Path) -> World:
    """Return the world that a file declares, to which devices can be added before a robot gets it.

    Raises:
        UsageError: a mistake in the file, or nothing in it that is beside the robot; the text names file and line.
    """
    world = load_world_file(path).world
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
