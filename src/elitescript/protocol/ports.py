"""The table of the TCP ports of a robot, one row each.

A robot in memory opens its connections from it (`Kernel.connect`), a served robot its listeners; options, the reference
page and the `ready` line derive from it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Final

from elitescript.messages.profile import Release
from elitescript.messages.snapshot import RobotDescription
from elitescript.protocol import modbus_port
from elitescript.protocol.connection import Connection
from elitescript.protocol.dashboard.connection import DashboardConnection
from elitescript.protocol.interpreter import InterpreterConnection
from elitescript.protocol.modbus_port import ModbusConnection, ModbusPort
from elitescript.protocol.primary import connection as primary
from elitescript.protocol.primary.connection import PrimaryConnection, PrimaryFeed, PrimaryPort
from elitescript.protocol.primary.packets import ROBOT_STATE
from elitescript.protocol.query import QueryConnection
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.protocol.rtsi.recipes import DATA_PACKAGE, RtsiPort
from elitescript.records import NamedTuple

Connect = Callable[[str], Connection]
"""Makes the connection of one client from its origin."""


class Service(NamedTuple):
    """One port."""

    name: str
    """Name for `--port` and `VirtualRobot.connect`; origins begin with it."""
    number: int
    """Port number of instance 0."""
    summary: str
    evidence: str
    open: Callable[[RobotDescription], Connect]
    """Called once for each robot: makes the state that its clients share."""
    is_sample: Callable[[bytes], bool] = lambda _message: False
    """Returns whether a message is one of a stream, which may be dropped for a client that reads too slowly."""
    outlives_silence: bool = False
    """Whether a client that has ended its own half of the connection still gets the stream."""
    since: Release = (0, 0)
    """First firmware with the port; on older ones it is closed (*assumed*)."""
    spare_number: int | None = None
    """Port number of instance 0 where the first one is not permitted."""


def _open_primary(port: PrimaryPort, description: RobotDescription) -> Connect:
    feed = PrimaryFeed(description, port)
    return lambda origin: PrimaryConnection(origin, description, feed)


def _open_rtsi(description: RobotDescription) -> Connect:
    port = RtsiPort()
    return lambda origin: RtsiConnection(origin, description, port)


def _open_modbus(description: RobotDescription) -> Connect:
    port = ModbusPort(description)
    return lambda origin: ModbusConnection(origin, description, port)


def _open_plain(kind: Callable[[str, RobotDescription], Connection], description: RobotDescription) -> Connect:
    return lambda origin: kind(origin, description)


def _primary_row(port: PrimaryPort) -> Service:
    opener = partial(_open_primary, port)
    return Service(
        port.name,
        port.number,
        port.summary,
        port.evidence,
        opener,
        lambda message: message[4] == ROBOT_STATE,
        outlives_silence=True,
    )


def _plain_row(
    name: str,
    number: int,
    summary: str,
    evidence: str,
    kind: Callable[[str, RobotDescription], Connection],
    since: Release = (0, 0),
) -> Service:
    opener = partial(_open_plain, kind)
    return Service(name, number, summary, evidence, opener, since=since)


SERVICES: Final[tuple[Service, ...]] = (
    _plain_row(
        "dashboard",
        29999,
        "text commands: power, tasks, popups, state",
        "vendor's client; documented",
        DashboardConnection,
    ),
    *(_primary_row(port) for port in primary.PORTS),
    Service(
        "rtsi",
        30004,
        "typed variables both ways, up to 250 times a second",
        "vendor's client; documented",
        _open_rtsi,
        lambda message: message[2] == DATA_PACKAGE,
    ),
    _plain_row("interpreter", 30020, "statements one at a time", "documented", InterpreterConnection, (2, 11)),
    _plain_row("query", 40011, "single function calls and their values", "observed", QueryConnection, (2, 11)),
    Service(
        "modbus",
        modbus_port.NUMBER,
        f"Modbus TCP server; {modbus_port.SPARE_NUMBER} where ports below 1024 need privileges",
        "documented",
        _open_modbus,
        spare_number=modbus_port.SPARE_NUMBER,
    ),
)


def services_of(firmware: Release) -> tuple[Service, ...]:
    """Return the ports that a firmware has."""
    return tuple(row for row in SERVICES if firmware >= row.since)
