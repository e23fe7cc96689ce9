"""The table of services: every port that a robot serves, one row each.

Options, the reference page, the pump and the `ready` line are derived from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Final, NamedTuple

from elitescript.errors import UsageError
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

PORTS_PER_INSTANCE: Final = 100
"""Ports of instance N lie this many times N higher."""
PORT_MAX: Final = 65535
INSTANCE_MAX: Final = 200

Connect = Callable[[str], Connection]
"""Makes the connection of one client from its origin."""


class Service(NamedTuple):
    """One port."""

    name: str
    """What `--port` calls it; origins begin with it."""
    number: int
    """Of instance 0."""
    summary: str
    evidence: str
    open: Callable[[RobotDescription], Connect]
    """Called once for each robot: makes what its clients share."""
    is_sample: Callable[[bytes], bool]
    """Whether a message is one of a stream, which a client that reads too slowly may miss."""
    outlives_silence: bool
    """Whether a client that has ended its own half of the connection still gets the stream."""
    since: Release = (0, 0)
    """Firmware that brought it; an older one leaves the port closed (*assumed*)."""
    spare_number: int | None = None
    """Of instance 0, where the system does not let this user have the other one."""


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


def _is_robot_state(message: bytes) -> bool:
    return message[4] == ROBOT_STATE


def _is_data_package(message: bytes) -> bool:
    return message[2] == DATA_PACKAGE


def _is_never_a_sample(_message: bytes) -> bool:
    return False


def _primary_row(port: PrimaryPort) -> Service:
    opener = partial(_open_primary, port)
    return Service(port.name, port.number, port.summary, port.evidence, opener, _is_robot_state, outlives_silence=True)


def _plain_row(
    name: str,
    number: int,
    summary: str,
    evidence: str,
    kind: Callable[[str, RobotDescription], Connection],
    since: Release = (0, 0),
) -> Service:
    opener = partial(_open_plain, kind)
    return Service(name, number, summary, evidence, opener, _is_never_a_sample, outlives_silence=False, since=since)


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
        _is_data_package,
        outlives_silence=False,
    ),
    _plain_row("interpreter", 30020, "statements one at a time", "documented", InterpreterConnection, (2, 11)),
    _plain_row("query", 40011, "single function calls and their values", "observed", QueryConnection, (2, 11)),
    Service(
        "modbus",
        modbus_port.NUMBER,
        f"Modbus TCP server; {modbus_port.SPARE_NUMBER} where ports below 1024 are not for everybody",
        "documented",
        _open_modbus,
        _is_never_a_sample,
        outlives_silence=False,
        spare_number=modbus_port.SPARE_NUMBER,
    ),
)

NAMES: Final[tuple[str, ...]] = tuple(row.name for row in SERVICES)


class Extra(NamedTuple):
    """A port that is open only when it is asked for, and that an own server answers."""

    name: str
    number: int
    """Of instance 0."""
    summary: str
    evidence: str
    spare_number: int
    """Of instance 0, where the system does not let this user have the other one."""


SSH: Final = Extra(
    "ssh",
    22,
    "SFTP, SCP and the bridges to serial ports, with `--ssh`; 2222 where ports below 1024 are not for everybody",
    "vendor's client",
    2222,
)


def _rows(has_ssh: bool) -> tuple[Service | Extra, ...]:
    return (*SERVICES, SSH) if has_ssh else SERVICES


def services_of(firmware: tuple[int, ...]) -> tuple[Service, ...]:
    """The services that a firmware has."""
    return tuple(row for row in SERVICES if firmware[:2] >= row.since)


def port_numbers(instance: int, chosen: Mapping[str, int], *, robot: int = 0, has_ssh: bool = False) -> dict[str, int]:
    """The port of every service of one robot.

    Args:
        instance: moves every port that is not chosen.
        chosen: numbers of the first robot by name; 0 lets the system choose a free one.
        robot: which robot of a `serve` this is; each has the next instance.
        has_ssh: whether there is an SSH port.

    Raises:
        UsageError: an unknown name, a number out of range, or one port for two services.
    """
    if not 0 <= instance + robot <= INSTANCE_MAX:
        raise UsageError(f"an instance is a number from 0 to {INSTANCE_MAX}, not {instance + robot}")
    rows = _rows(has_ssh)
    if unknown := chosen.keys() - {row.name for row in rows}:
        if min(unknown) == SSH.name:
            raise UsageError("there is an SSH port only with --ssh")
        raise UsageError(f"no service is called {min(unknown)!r}; there are {', '.join(NAMES)}")
    numbers: dict[str, int] = {}
    users: dict[int, str] = {}
    for row in rows:
        number = row.number + PORTS_PER_INSTANCE * (instance + robot)
        if row.name in chosen:
            number = chosen[row.name] and chosen[row.name] + PORTS_PER_INSTANCE * robot
        if not 0 <= number <= PORT_MAX:
            raise UsageError(f"port {row.name} must be a number from 0 to {PORT_MAX}, not {number}")
        if number in users:
            raise UsageError(f"{users[number]} and {row.name} cannot have the same port {number}")
        if number:
            users[number] = row.name
        numbers[row.name] = number
    return numbers


def spare_numbers(instance: int, chosen: Mapping[str, int], *, robot: int = 0, has_ssh: bool = False) -> dict[str, int]:
    """Ports that stand in for those that this user may not have; there is none for a port that was chosen.

    Args:
        instance: see `port_numbers`.
        chosen: see `port_numbers`.
        robot: see `port_numbers`.
        has_ssh: see `port_numbers`.
    """
    return {
        row.name: row.spare_number + PORTS_PER_INSTANCE * (instance + robot)
        for row in _rows(has_ssh)
        if row.spare_number is not None and row.name not in chosen
    }
