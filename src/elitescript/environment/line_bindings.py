"""What is on the robot's serial ports: a port of this computer, or a TCP connection in place of a line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

from elitescript.errors import UsageError
from elitescript.extras import require
from elitescript.messages.line import PORT_NAMES

PORTS: Final = {
    **{name: device for device, name in PORT_NAMES.items()},
    "/dev/ttymxc0": "/dev/ttymxc0",
    "/dev/ttyS2": "/dev/ttyS2",
}
"""Names of the robot's ports, and the device that each means."""

BRIDGE: Final = "socket://"


def parse_bindings(texts: Iterable[str]) -> dict[str, str]:
    """Return bindings by device from `PORT=DEVICE`, such as `tool=/dev/ttyUSB0` or `box=socket://127.0.0.1:7000`.

    Raises:
        UsageError: not of this form, or see `check_bindings`.
    """
    found: dict[str, str] = {}
    for text in texts:
        port, equals, target = text.partition("=")
        if not equals or not target.strip():
            raise UsageError(f"--serial {text}: write PORT=DEVICE, such as tool=/dev/ttyUSB0 or box=socket://HOST:PORT")
        found |= _checked(port.strip(), target.strip(), found)
    return found


def check_bindings(lines: Mapping[str, str]) -> dict[str, str]:
    """Return bindings by device, from bindings by the name of the port.

    Raises:
        UsageError: no such port, something bound twice, an address that is none, or pyserial is needed and missing.
    """
    found: dict[str, str] = {}
    for port, target in lines.items():
        found |= _checked(port, target, found)
    return found


def _checked(port: str, target: str, found: Mapping[str, str]) -> dict[str, str]:
    device = PORTS.get(port)
    if device is None:
        raise UsageError(f"the robot has no serial port {port!r}; its ports: {', '.join(PORTS)}")
    if device in found:
        raise UsageError(f"the serial port {device} is bound to {found[device]} and to {target}")
    if target in found.values():
        raise UsageError(f"{target} is bound to two serial ports")
    if bridge_address(target) is None:
        require("serial", f"the serial port {port}={target}")
    return {device: target}


def bridge_address(target: str) -> tuple[str, int] | None:
    """Return the address and port of `socket://HOST:PORT`; None for a device of this computer.

    Raises:
        UsageError: an address that is none.
    """
    if not target.startswith(BRIDGE):
        return None
    host, _, port = target.removeprefix(BRIDGE).rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not host or not (port.isascii() and port.isdecimal() and 0 < int(port) < 65536):
        raise UsageError(f"{target}: write socket://HOST:PORT, the port from 1 to 65535")
    return host, int(port)
