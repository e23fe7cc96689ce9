"""Has the operating system find peers that have vanished without a word, and close the connections to them.

A computer that loses its power or its cable ends no connection. Then nothing comes any more, and what belongs to the
client, such as its claims to RTSI inputs, would stay taken for ever. So every connection asks its peer for a sign of
life when it has been silent, and is given up when none comes.

Evidence: *assumed*; whether and when the real controller does so is not known. No client notices any of it.
"""

from __future__ import annotations

import contextlib
import socket
from typing import Final

SILENCE_S: Final = 10
"""Without a byte, after which the peer is asked for a sign of life."""
PROBE_S: Final = 5
"""Between two questions."""
PROBES: Final = 4
"""Questions without an answer after which it is given up: 30 s of silence in all."""
UNTAKEN_S: Final = 30
"""How long what was sent may stay without a receipt."""

_OPTIONS: Final = (
    ("TCP_KEEPIDLE", SILENCE_S),
    # What macOS calls it.
    ("TCP_KEEPALIVE", SILENCE_S),
    ("TCP_KEEPINTVL", PROBE_S),
    ("TCP_KEEPCNT", PROBES),
    ("TCP_USER_TIMEOUT", UNTAKEN_S * 1000),
)
"""Which of them there are depends on the operating system."""


def watch_peer(connected: socket.socket) -> None:
    """Have a TCP connection end when its peer has vanished."""
    connected.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _OPTIONS:
        option = getattr(socket, name, None)
        if option is not None:
            with contextlib.suppress(OSError):
                connected.setsockopt(socket.IPPROTO_TCP, option, value)
