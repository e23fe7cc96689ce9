"""The numbers of the ports that a robot serves, and of those that are open only when they are asked for.

What a port is stands in `protocol.ports`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from elitescript.errors import UsageError
from elitescript.protocol.ports import SERVICES, Service
from elitescript.records import NamedTuple

PORTS_PER_INSTANCE: Final = 100
"""Ports of instance N lie this many times N higher."""
PORT_MAX: Final = 65535
INSTANCE_MAX: Final = 200

NAMES: Final[tuple[str, ...]] = tuple(row.name for row in SERVICES)


class Extra(NamedTuple):
    """A port that is open only when it is asked for, and that an own server answers."""

    name: str
    number: int
    """Port number of instance 0."""
    summary: str
    evidence: str
    spare_number: int
    """Port number of instance 0 where the first one is not permitted."""


SSH: Final = Extra(
    "ssh",
    22,
    "SFTP, SCP and the bridges to serial ports, with `--ssh`; 2222 where ports below 1024 are not for everybody",
    "vendor's client",
    2222,
)


def _rows(has_ssh: bool) -> tuple[Service | Extra, ...]:
    return (*SERVICES, SSH) if has_ssh else SERVICES


def port_numbers(instance: int, chosen: Mapping[str, int], *, robot: int = 0, has_ssh: bool = False) -> dict[str, int]:
    """Return the port of every service of one robot.

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
    """Return ports that stand in for those that this user may not have; there is none for a port that was chosen.

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
