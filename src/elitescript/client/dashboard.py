"""A client of the dashboard shell: one command at a time, one reply each."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Final

from elitescript.client.connecting import CommandError, LinkError, connected
from elitescript.errors import PeerError
from elitescript.protocol.dashboard.verbs import VERBS

REPLY_S: Final = 5.0
"""Longest time for a reply."""
GREETING_LINES_MAX: Final = 20
"""Lines in front of the reply to the first command (*documented*: three)."""
UNASKED_MAX: Final = 1 << 16
"""Bytes between two replies that are passed over; more is no controller."""
HELLO: Final = "Hello ELITE ROBOTS"
"""Reply to `echo`; newer firmware has a full stop behind it."""

READING: Final = frozenset(
    {
        "echo",
        "version",
        "robot -t",
        "robot -s",
        "robot -id",
        "robotMode",
        "safety -s",
        "safety -m",
        "speed",
        "task",
        "task -s",
        "task -r",
        "task -ss",
        "configuration",
        "configuration -s",
        "remoteControl -s",
        "variable -get",
        "quit",
    }
)
"""Verbs with their options that change nothing."""


def is_reading(line: str) -> bool:
    """Return whether a command changes nothing at the controller."""
    words = line.split()
    if not words or "\n" in line or "\r" in line:
        return False
    if len(words) == 1:
        return words[0] in READING
    has_argument = any(row.option == words[1] and row.argument for row in VERBS.get(words[0], ()))
    return " ".join(words[:2]) in READING and (len(words) == 2 or has_argument)


class DashboardClient:
    """One connection; `dashboard_client` opens it.

    Args:
        reader: from the controller.
        writer: to it.
        may_command: whether commands may be sent that change something.
    """

    __slots__ = ("_is_broken", "_lock", "_may_command", "_reader", "_writer")

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, may_command: bool) -> None:
        self._reader = reader
        self._writer = writer
        self._may_command = may_command
        self._lock = asyncio.Lock()
        self._is_broken = False

    @property
    def is_busy(self) -> bool:
        """Whether a command waits for its reply: the next one would have to wait too."""
        return self._lock.locked()

    async def greet(self) -> None:
        """Read past the greeting, of whatever length, up to the reply of a first command.

        Raises:
            LinkError: no such reply comes.
            PeerError: it is no dashboard.
        """
        async with self._lock:
            self._writer.write(b"echo\n")
            for _ in range(GREETING_LINES_MAX):
                if (await self._line(REPLY_S, "echo")).startswith(HELLO):
                    return
        raise PeerError("dashboard: the controller does not answer to `echo`")

    async def ask(self, line: str, timeout_s: float = REPLY_S) -> str:
        """Send a command; return the line of its reply, without its end.

        Args:
            line: verb, options and argument, such as `task -s`; its reply has one line.
            timeout_s: for the reply.

        Raises:
            CommandError: the command would change something and this connection only reads; or it has several lines.
            LinkError: no reply came: the connection is out of step, and over.
            PeerError: the controller sends without end, unasked.
        """
        if not (self._may_command or is_reading(line)):
            raise CommandError(f"this connection only reads: it may not send {line.split(maxsplit=2)[:2]}")
        if "\n" in line or "\r" in line:
            raise CommandError("a dashboard command is one line")
        async with self._lock:
            if self._is_broken:
                raise LinkError("dashboard: the connection is out of step")
            await self._pass_over()
            self._writer.write(line.encode() + b"\n")
            return await self._line(timeout_s, line)

    async def _pass_over(self) -> None:
        """Read past what came without a command: it is no reply to the next one."""
        passed = 0
        try:
            async with asyncio.timeout(0):
                while data := await self._reader.read(UNASKED_MAX):
                    passed += len(data)
                    if passed >= UNASKED_MAX:
                        self._is_broken = True
                        raise PeerError(
                            "dashboard: the controller sends without being asked: the connection was closed"
                        )
        except TimeoutError:
            return
        except OSError:
            # The reply that does not come says so.
            return

    async def _line(self, timeout_s: float, command: str) -> str:
        whole = False
        try:
            async with asyncio.timeout(timeout_s):
                data = await self._reader.readuntil(b"\n")
            whole = True
        except TimeoutError:
            raise LinkError(f"dashboard: no reply to `{command}` within {timeout_s:g} s") from None
        except asyncio.LimitOverrunError:
            raise PeerError(f"dashboard: the reply to `{command}` has no end") from None
        except (OSError, EOFError):
            raise LinkError("dashboard: the controller has closed the connection") from None
        finally:
            # Also when the caller was cancelled: the reply would be taken for that of the next command.
            self._is_broken = not whole
        return data.decode("utf-8", "replace").rstrip("\r\n")


@contextlib.asynccontextmanager
async def dashboard_client(host: str, port: int, *, may_command: bool = False) -> AsyncIterator[DashboardClient]:
    """Connect to the dashboard shell; hang up at the end of the block.

    Raises:
        LinkError: there is no connection, it has ended, or the peer is no dashboard.
    """
    async with connected(host, port, "dashboard") as (reader, writer):
        client = DashboardClient(reader, writer, may_command=may_command)
        await client.greet()
        yield client
