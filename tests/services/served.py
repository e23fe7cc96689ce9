"""A served robot for a test: real sockets on free ports of loopback, a fake robot behind them."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any

from elitescript.messages.events import Event
from elitescript.services.log import LogLine
from elitescript.services.port_numbers import NAMES
from elitescript.services.robot_link import InProcessLink
from elitescript.services.robots import served_robot
from tests.services.fake_robot import FakeRobot

LIMIT_S = 10.0
"""Nothing takes so long; a test that would hang fails."""
loop_factory: Callable[[], asyncio.AbstractEventLoop] = asyncio.new_event_loop
"""Makes the event loops of tests."""


class Scene:
    """A server with its robot, and what it was heard to say."""

    def __init__(self, robot: Any = None, **options: Any) -> None:
        self.robot = robot or FakeRobot()
        self.said: list[Event | LogLine] = []
        self.peers: list[Peer] = []
        self.server = served_robot("CS66", InProcessLink(self.robot), lambda _, what: self.said.append(what), **options)

    def notes(self, kind: str) -> list[LogLine]:
        return [note for note in self.said if isinstance(note, LogLine) and note.kind == kind]

    async def connect(self, service: str) -> Peer:
        reader, writer = await asyncio.open_connection("127.0.0.1", self.server.ports[service])
        peer = Peer(reader, writer)
        self.peers.append(peer)
        return peer

    async def ticks(self, count: int = 1) -> None:
        for _ in range(count):
            await self.server.next_output()

    async def stands(self) -> None:
        """Wait until time stands still in lockstep."""
        while not self.server._time.is_standing:
            await asyncio.sleep(0)

    async def until(self, condition: Any) -> None:
        """Wait, tick by tick, until a condition holds."""
        while not condition():
            await self.ticks()


class Peer:
    """A client."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer

    def send(self, data: bytes) -> None:
        self.writer.write(data)

    async def line(self) -> str:
        return (await self.reader.readline()).decode()

    async def rtsi(self, letter: str = "") -> tuple[str, bytes]:
        """The next message; the next of a kind, if one is named."""
        while True:
            size = int.from_bytes(await self.reader.readexactly(2))
            body = await self.reader.readexactly(size - 2)
            if not letter or chr(body[0]) == letter:
                return chr(body[0]), body[1:]

    async def primary(self, kind: int = 0) -> bytes:
        """The next whole message of the primary port; the next of a type, if one is named."""
        while True:
            head = await self.reader.readexactly(4)
            message = head + await self.reader.readexactly(int.from_bytes(head) - 4)
            if not kind or message[4] == kind:
                return message

    def half_close(self) -> None:
        self.writer.write_eof()

    def reset(self) -> None:
        """End with a reset instead of a goodbye."""
        import socket
        import struct

        raw = self.writer.get_extra_info("socket")
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.writer.transport.abort()

    async def close(self) -> None:
        self.writer.close()
        with contextlib.suppress(ConnectionError):
            await self.writer.wait_closed()


@contextlib.asynccontextmanager
async def serving(robot: Any = None, **options: Any) -> AsyncIterator[Scene]:
    scene = Scene(robot, **options)
    await scene.server.boot()
    scene.server.bind("127.0.0.1", dict.fromkeys(NAMES, 0))
    await scene.server.open()
    try:
        yield scene
    finally:
        for peer in scene.peers:
            await peer.close()
        await scene.server.close()


def run(test: Coroutine[Any, Any, None]) -> None:
    """Run a test in an event loop of its own, for a limited time."""
    with asyncio.Runner(loop_factory=loop_factory) as runner:
        runner.run(asyncio.wait_for(test, LIMIT_S))
