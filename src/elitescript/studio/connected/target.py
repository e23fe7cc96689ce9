"""Which controller: its address, its ports, and the `ctl` socket of a robot that is served on this computer."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from elitescript.errors import UsageError
from elitescript.records import field, record
from elitescript.services.control.channel import address_of, exchange
from elitescript.services.hosts import is_loopback
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
    place = socket or (address_of(instance) if is_loopback(host) else None)
    found = None if place is None else _served(place, is_needed=socket is not None)
    if found is None:
        place = None
    return Target(host, found or ports, robot, may_control, place, programs, jog_register)


def _served(path: Path, *, is_needed: bool) -> Mapping[str, int] | None:
    """Return the ports of a robot that is served on this computer; None if there is none."""
    try:
        answer = asyncio.run(asyncio.wait_for(exchange(path, "ports"), _ASK_S))
    except (UsageError, TimeoutError, OSError, ValueError) as error:
        if is_needed:
            raise UsageError(f"{path}: {str(error) or 'no answer'}") from None
        return None
    result = answer.get("result", {})
    found = {name: row["port"] for name, row in result.items() if isinstance(row, dict) and "port" in row}
    return found if all(name in found for name in PORTS) else None
