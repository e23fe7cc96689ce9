"""Which controller: its address, its ports, and the `ctl` socket of a robot that is served on this computer."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.records import field, record
from elitescript.services.control.channel import address_of, addresses, exchange
from elitescript.services.hosts import LOOPBACK, is_loopback
from elitescript.services.port_numbers import port_numbers

JOG_REGISTER: Final = 40
"""First of two integer and six float input registers that jogging writes; free, *assumed*."""
PORTS: Final = ("primary", "rtsi", "dashboard")
"""Services that the studio uses."""
_ASK_S: Final = 3.0


@record
class Target:
    """What the studio connects to."""

    host: str
    ports: Mapping[str, int] = field(default_factory=lambda: port_numbers(0, {}))
    """Numbers by the name of the service, those of `PORTS` at least."""
    robot: str = ""
    """Model to show if the controller does not say it; empty: the controller's word alone."""
    may_control: bool = False
    """Whether commands may be sent at all; without it, nothing that changes anything leaves this computer."""
    control_socket: Path | None = None
    """Of `ctl`, if the robot is served on this computer."""
    programs: tuple[str, ...] = ()
    """Names of programs that can be loaded, as far as they are known."""
    jog_register: int = JOG_REGISTER


def find_target(
    host: str,
    *,
    instance: int = 0,
    socket: Path | None = None,
    robot: str = "",
    may_control: bool = False,
    programs: tuple[str, ...] = (),
    jog_register: int = JOG_REGISTER,
) -> Target:
    """Return what is at an address; a robot that is served on this computer says its ports itself.

    Args:
        host: name or address; of this computer, `ctl` is looked for.
        instance: of the robot, as of `serve`; it moves the ports.
        socket: of its `ctl`, if it is another than that of the instance.
        robot: see `Target`.
        may_control: see `Target`.
        programs: see `Target`.
        jog_register: see `Target`.

    Raises:
        UsageError: no host, an instance or register that does not exist, or no robot at the socket.
    """
    if not host or any(letter.isspace() or letter == "/" for letter in host):
        raise UsageError(f"--connect {host!r}: a name or an address is needed, such as 192.168.1.20")
    if not 0 <= jog_register <= 42:
        raise UsageError(f"the first register for jogging is from 0 to 42, not {jog_register}")
    ports: Mapping[str, int] = port_numbers(instance, {})
    place: Path | None = socket
    found: Mapping[str, int] | None
    if socket is not None:
        found = _served(socket)
    else:
        place, found = _served_at(host, instance, ports) if is_loopback(host) else (None, None)
    return Target(host, found or ports, robot, may_control, place if found else None, programs, jog_register)


def _served_at(host: str, instance: int, ports: Mapping[str, int]) -> tuple[Path | None, Mapping[str, int] | None]:
    """Return the socket and the ports of the robot that is served at a loopback address; None if there is none.

    That of the instance may have any ports. Robots with an address each have the ports of one instance, so of another
    one these must be the same.
    """
    first = address_of(instance)
    for place in [first, *(other for other in addresses() if other != first)]:
        try:
            found = _served(place, host)
        except UsageError:
            continue
        if found and (place == first or all(found[name] == ports[name] for name in PORTS)):
            return place, found
    return None, None


def _served(path: Path, host: str = "") -> Mapping[str, int] | None:
    """Return the ports of a robot that is served on this computer; None if it lacks one, or is not at a given address.

    Raises:
        UsageError: there is none at this socket.
    """
    try:
        answer = asyncio.run(asyncio.wait_for(exchange(path, "ports"), _ASK_S))
    except (UsageError, TimeoutError, OSError, ValueError) as error:
        raise UsageError(f"{path}: {str(error) or 'no answer'}") from None
    result = answer.get("result", {})
    rows = {name: row for name, row in result.items() if isinstance(row, dict) and "port" in row}
    if not all(name in rows and (not host or _is_at(rows[name].get("host"), host)) for name in PORTS):
        return None
    return {name: row["port"] for name, row in rows.items()}


def _is_at(bound: object, host: str) -> bool:
    """Return whether a port that listens at an address is reached at another spelling of it, or at all of them."""
    return bound in (host, "0.0.0.0", "::") or (host in LOOPBACK and bound in LOOPBACK)
