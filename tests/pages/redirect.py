"""Lead connections to the ports that a page documents to those of the robot that the test serves.

Pages show the documented ports; the test serves on free ones. Only connections to this computer are led elsewhere.
"""

from __future__ import annotations

import json
import os
import socket
from pathlib import Path
from typing import Any

PORTS_FILE = "ELITESCRIPT_PAGE_PORTS"
"""Environment variable of child processes: a JSON file with the served port of each documented one."""

connect_as_written = socket.socket.connect
connect_ex_as_written = socket.socket.connect_ex


def served(address: Any) -> Any:
    """Translate an address: a documented port of this computer becomes the served one."""
    name = os.environ.get(PORTS_FILE, "")
    if not isinstance(address, tuple) or address[0] not in ("127.0.0.1", "localhost") or not Path(name).is_file():
        return address
    ports = json.loads(Path(name).read_text(encoding="utf-8"))
    return (address[0], ports.get(str(address[1]), address[1]))


def connect(self: socket.socket, address: Any) -> None:
    connect_as_written(self, served(address))


def connect_ex(self: socket.socket, address: Any) -> int:
    return connect_ex_as_written(self, served(address))


def install() -> None:
    """Change the sockets of this process, for the rest of its life."""
    socket.socket.connect = connect  # type: ignore[method-assign]
    socket.socket.connect_ex = connect_ex  # type: ignore[method-assign]
