"""Virtual surroundings for tests of robot programs: devices, wires and faults in the robot's own time.

    >>> from elitescript.testing.world import TcpServer, World

See `docs/devices.md`.
"""

from __future__ import annotations

from elitescript.worlds.virtual.agenda import DeviceError
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

__all__ = [
    "Device",
    "DeviceError",
    "Fault",
    "ModbusDevice",
    "Parts",
    "RobotSignals",
    "RpcFault",
    "Schedule",
    "SerialDevice",
    "TcpConnection",
    "TcpServer",
    "Wire",
    "World",
    "XmlRpcServer",
]
