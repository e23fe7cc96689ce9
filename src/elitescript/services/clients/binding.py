"""Ports of this computer: taken, or why they cannot be had."""

from __future__ import annotations

import errno
import socket
import sys
from contextlib import suppress
from typing import Final

from elitescript.errors import UsageError
from elitescript.services.port_numbers import PORTS_PER_INSTANCE

RECEIVE_BYTES: Final = 4 * 1024 * 1024
"""Bytes of a client that the operating system takes from it, if it may: more than most programs have."""
_FORCED: Final = 33 if sys.platform == "linux" else 0
"""SO_RCVBUFFORCE, for a superuser: more than the system gives others."""
BACKLOG: Final = 512
"""Clients that the operating system holds until they are accepted."""


def bind_one(name: str, host: str, number: int, spare: int | None = None) -> tuple[socket.socket, str]:
    """Take the port of a service.

    Args:
        name: of the service.
        host: address to listen at.
        number: of the port; 0 is a free one.
        spare: what to take instead of a number that this user may not have.

    Returns:
        The socket, and a note for the user if it is the spare one.

    Raises:
        UsageError: the port cannot be had.
    """
    try:
        return bind(host, number), ""
    except OSError as error:
        if spare is None or not isinstance(error, PermissionError):
            raise UsageError(_why_not(name, host, number, error)) from error
    bound, _ = bind_one(name, host, spare)
    return bound, f"port {number} ({name}) may not be had by this user: {name} is served at {spare}"


def bind(host: str, number: int) -> socket.socket:
    """Return a socket that listens at a port; 0 is a free one.

    Raises:
        OSError: it is in use, or may not be had; the host is none of this computer.
    """
    found = socket.getaddrinfo(host, number, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    family, kind, protocol, _, address = next((row for row in found if row[0] == socket.AF_INET), found[0])
    bound = socket.socket(family, kind, protocol)
    try:
        if hasattr(socket, "SO_EXCLUSIVEADDRUSE"):
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        else:
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        _enlarge(bound)
        bound.bind(address)
        # Of two processes that bind the same port at the same moment, only one may listen.
        bound.listen(BACKLOG)
        bound.setblocking(False)
    except OSError:
        bound.close()
        raise
    return bound


def _enlarge(bound: socket.socket) -> None:
    """Have clients of a socket be taken as much of as the system allows, before this process reads it.

    What a client still holds when it closes may be lost.
    """
    if _FORCED:
        with suppress(OSError):
            bound.setsockopt(socket.SOL_SOCKET, _FORCED, RECEIVE_BYTES)
            return
    with suppress(OSError):
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BYTES)


def _why_not(name: str, host: str, number: int, error: OSError) -> str:
    if error.errno == errno.EADDRINUSE:
        return (
            f"port {number} ({name}) is in use: another controller or `elitescript serve` has it. Stop that one, move "
            f"all ports by {PORTS_PER_INSTANCE} with the next --instance, or this one with --port {name}=NUMBER "
            "(0: any free)"
        )
    if error.errno == errno.EACCES:
        return f"port {number} ({name}) may not be had by this user: choose one above 1023 with --port {name}=NUMBER"
    if error.errno == errno.EADDRNOTAVAIL:
        return f"--host {host}: this computer does not have that address"
    return f"port {number} ({name}) at {host}: {error.strerror or error}"
