"""Virtual surroundings for tests of robot programs: devices, wires and faults in the robot's own time.

    >>> from elitescript.testing.world import TcpServer, World

See `docs/devices.md`.
"""

from __future__ import annotations

from elitescript.worlds.virtual.device import Device
from elitescript.worlds.virtual.serial import SerialDevice
from elitescript.worlds.virtual.signals import RobotSignals
from elitescript.worlds.virtual.tcp import TcpConnection, TcpServer
from elitescript.worlds.virtual.world import World

__all__ = ["Device", "RobotSignals", "SerialDevice", "TcpConnection", "TcpServer", "World"]
