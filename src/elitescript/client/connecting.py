"""Connections to a controller: opened within a time, and opened again when they are lost."""

from __future__ import annotations

import asyncio
import contextlib
import os
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Final

from elitescript.errors import ElitescriptError, PeerError

CONNECT_S: Final = 3.0
"""Longest time for a connection to open."""
BURST_S: Final = 5.0
"""How long a peer may send as much as it may at most, s: what waited while this computer was busy comes at once."""
READ_BYTES: Final = 1 << 14
"""Bytes that are read at once: what else goes on waits for so much to be decoded."""
BACKOFF_S: Final = (0.2, 0.5, 1.0, 2.0, 5.0)
"""Pauses between attempts; the last one again and again."""


class LinkError(ElitescriptError):
    """A connection to a controller cannot be had, or has ended; the text says which and why."""


class CommandError(ElitescriptError):
    """Something would command the controller over a connection that only reads."""


class Inflow:
    """Bounds what a peer sends: a burst passes, a flood ends its connection.

    Args:
        name: of the port, for texts.
        messages_per_s: most messages a second for longer than `BURST_S`.
        bytes_per_s: most bytes a second, likewise.
    """

    __slots__ = ("_bytes", "_bytes_per_s", "_messages", "_messages_per_s", "_name", "_t")

    def __init__(self, name: str, messages_per_s: float, bytes_per_s: float) -> None:
        self._name = name
        self._messages_per_s = messages_per_s
        self._bytes_per_s = bytes_per_s
        self._messages = self._bytes = 0.0
        """What counts yet of that which has come."""
        self._t = 0.0

    def take(self, messages: int, size: int, t: float) -> None:
        """Count what has come by a time, s.

        Raises:
            PeerError: it is too much.
        """
        passed_s, self._t = t - self._t, t
        self._messages = max(0.0, self._messages - passed_s * self._messages_per_s) + messages
        self._bytes = max(0.0, self._bytes - passed_s * self._bytes_per_s) + size
        too_much = ""
        if self._messages > self._messages_per_s * BURST_S:
            too_much = f"{self._messages_per_s:g} messages"
        elif self._bytes > self._bytes_per_s * BURST_S:
            too_much = f"{self._bytes_per_s / 1e6:g} MB"
        if too_much:
            raise PeerError(
                f"{self._name}: the controller sends more than {too_much} a second: the connection was closed"
            )


Streams = tuple[asyncio.StreamReader, asyncio.StreamWriter]


@contextlib.asynccontextmanager
async def connected(host: str, port: int, name: str, timeout_s: float = CONNECT_S) -> AsyncIterator[Streams]:
    """Open a connection; close it at the end of the block.

    Args:
        host: name or address.
        port: its number.
        name: of the port, for texts.
        timeout_s: longest time to wait.

    Raises:
        LinkError: it does not open; in the block, also when it ends or a peer does not keep the protocol.
    """
    where = f"{name} port {host}:{port}"
    try:
        async with asyncio.timeout(timeout_s):
            reader, writer = await asyncio.open_connection(host, port)
    except TimeoutError:
        raise LinkError(f"{where}: nothing answers within {timeout_s:g} s") from None
    except OSError as error:
        raise LinkError(f"{where}: {_reason(error)}") from None
    except UnicodeError:
        raise LinkError(f"{where}: no name of a computer") from None
    peer: socket.socket | None = writer.get_extra_info("socket")
    if peer is not None:
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    try:
        yield reader, writer
    except (OSError, EOFError) as error:
        raise LinkError(f"{where}: the connection has ended ({error})") from None
    except PeerError as error:
        # What reads the bytes names its port too, but not where it is.
        text = str(error).removeprefix(f"{name} port: ").removeprefix(f"{name}: ")
        raise LinkError(f"{where}: {text}") from None
    finally:
        # Abort: what waits in buffers is not to reach a controller later on.
        writer.transport.abort()


def _reason(error: OSError) -> str:
    """Return why a connection does not open, as the system says it; the text of `asyncio` is the address again."""
    text = error.strerror or str(error)
    if not isinstance(error, socket.gaierror) and error.errno:
        text = os.strerror(error.errno)
    return text[:1].lower() + text[1:]


async def read_some(reader: asyncio.StreamReader, timeout_s: float, what: str) -> bytes:
    """Return what arrives next.

    Raises:
        LinkError: nothing came within the time, or the peer has closed the connection.
    """
    try:
        async with asyncio.timeout(timeout_s):
            data = await reader.read(READ_BYTES)
    except TimeoutError:
        raise LinkError(f"{what}: nothing came in time") from None
    except OSError as error:
        raise LinkError(f"{what}: {error.strerror or error}") from None
    if not data:
        raise LinkError(f"{what}: the controller has closed the connection")
    # What has arrived already is returned without a pause; everything else must go on beside a flood.
    await asyncio.sleep(0)
    return data


async def keep_connected(
    session: Callable[[], Awaitable[None]], lost: Callable[[str], None], backoff_s: tuple[float, ...] = BACKOFF_S
) -> None:
    """Run a session again whenever it ends with an error, until this task is cancelled or it returns.

    Args:
        session: opens a connection and works with it; one that worked for a while begins the pauses anew.
        lost: takes why it ended, each time.
        backoff_s: pauses between attempts.
    """
    loop = asyncio.get_running_loop()
    attempt = 0
    while True:
        began = loop.time()
        try:
            await session()
            return
        except (LinkError, PeerError) as error:
            lost(str(error))
        if loop.time() - began > backoff_s[-1]:
            attempt = 0
        await asyncio.sleep(backoff_s[min(attempt, len(backoff_s) - 1)])
        attempt += 1
