"""A controller of three ports for tests, independent of our own server: it records every byte that it is sent."""

from __future__ import annotations

import asyncio
import contextlib
import json
import struct
from collections.abc import AsyncIterator, Callable
from typing import Any

from elitescript.conversation.messages import read_message
from elitescript.protocol.primary.packets import SUB_MESSAGES, pack_state
from elitescript.studio.connected.controller import ConnectedController
from elitescript.studio.connected.source import ConnectedSource
from elitescript.studio.connected.target import Target
from tests.protocol.rtsi_client import SIZES
from tests.protocol.snapshots import description, snapshot

TYPES = {
    "timestamp": "DOUBLE",
    "actual_joint_positions": "VECTOR6D",
    "actual_TCP_pose": "VECTOR6D",
    "robot_mode": "INT32",
    "safety_status": "INT32",
    "runtime_state": "UINT32",
    "target_speed_fraction": "DOUBLE",
}
"""Variables of an older controller."""

REPLIES = {
    "echo": "Hello ELITE ROBOTS",
    "robot -t": "CS66",
    "robot -s": "1234",
    "version": "2.9.0",
    "task": "Relative path:pick.task",
    "remoteControl -s": "Remote control is on",
    "robotControl -on": "Powering on",
    "robotControl -off": "Powering off",
    "brakeRelease": "Brake Releasing...",
    "play": "Starting program",
    "pause": "Pausing task",
    "stop": "Stopping task",
    "unlockProtectiveStop": "Protective stop unlocking...",
    "popup -c": "Closing popup",
}
JOINTS = (0.1, -1.2, 1.3, -1.4, 1.5, 0.6)

Serve = Callable[[asyncio.StreamReader, asyncio.StreamWriter], Any]


class FakeController:
    """Answers as an older controller does; tests may replace how each port is served.

    Attributes:
        sent: bytes that each port got.
        values: of the RTSI variables.
        serve: how each port is served.
    """

    def __init__(self) -> None:
        self.sent = {"rtsi": b"", "primary": b"", "dashboard": b""}
        self.values: dict[str, Any] = {
            "timestamp": 100.0,
            "actual_joint_positions": JOINTS,
            "actual_TCP_pose": (0.4, 0.1, 0.5, 3.1, 0.0, 1.5),
            "robot_mode": 7,
            "safety_status": 1,
            "runtime_state": 3,
            "target_speed_fraction": 0.5,
        }
        self.serve: dict[str, Serve] = {"rtsi": self.rtsi, "primary": self.primary, "dashboard": self.dashboard}
        self.state = pack_state(SUB_MESSAGES, snapshot(), description())
        self.replies: dict[str, str | None] = dict(REPLIES)
        """Of the dashboard; it does not answer to what has None."""
        self.ports: dict[str, int] = {}
        self.letters: list[str] = []
        """Commands on the RTSI port."""
        self._servers: list[asyncio.Server] = []
        self._writers: set[asyncio.StreamWriter] = set()
        self._tasks: set[asyncio.Task[None]] = set()

    async def open(self) -> None:
        for name in self.sent:
            server = await asyncio.start_server(self._answer(name), "127.0.0.1", self.ports.get(name, 0))
            self.ports[name] = server.sockets[0].getsockname()[1]
            self._servers.append(server)

    async def close(self) -> None:
        for server in self._servers:
            server.close()
        self._servers.clear()
        self.hang_up()
        await asyncio.sleep(0)

    def hang_up(self) -> None:
        for writer in self._writers:
            writer.transport.abort()

    def _answer(self, name: str) -> Callable[[asyncio.StreamReader, asyncio.StreamWriter], None]:
        async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            with contextlib.suppress(OSError, EOFError):
                await self.serve[name](reader, writer)
            self._writers.discard(writer)
            writer.transport.abort()

        def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            # At once: a task that has not begun when the test ends would leave its connection open.
            self._writers.add(writer)
            task = asyncio.create_task(answer(reader, writer))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

        return accept

    async def rtsi(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        streams: list[asyncio.Task[None]] = []
        recipes: list[tuple[int, list[str]]] = []
        try:
            while True:
                head = await reader.readexactly(3)
                body = await reader.readexactly(int.from_bytes(head[:2]) - 3)
                self.sent["rtsi"] += head + body
                letter = chr(head[2])
                self.letters.append(letter)
                if letter == "O":
                    names = body[8:].decode().split(",")
                    types = [TYPES.get(name, "NOT_FOUND") for name in names]
                    ident = 0 if "NOT_FOUND" in types else len(recipes) + 1
                    if ident:
                        recipes.append((ident, names))
                    answer = bytes([ident]) + ",".join(types).encode()
                elif letter == "v":
                    answer = struct.pack(">4I", 2, 9, 0, 1)
                else:
                    answer = b"\x01"
                writer.write(struct.pack(">HB", 3 + len(answer), head[2]) + answer)
                if letter == "S":
                    streams.append(asyncio.create_task(self._stream(writer, recipes)))
        finally:
            for stream in streams:
                stream.cancel()

    async def _stream(self, writer: asyncio.StreamWriter, recipes: list[tuple[int, list[str]]]) -> None:
        while True:
            self.values["timestamp"] += 0.04
            for ident, names in recipes:
                writer.write(self.package(ident, names))
            await asyncio.sleep(0.01)

    def package(self, ident: int, names: list[str]) -> bytes:
        body = bytes([ident])
        for name in names:
            code, count = SIZES[TYPES[name]]
            value = self.values[name]
            body += struct.pack(f">{count}{code}", *(value if count > 1 else [value]))
        return struct.pack(">HB", 3 + len(body), ord("U")) + body

    async def primary(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        async def states() -> None:
            while True:
                writer.write(self.state)
                await asyncio.sleep(0.05)

        sending = asyncio.create_task(states())
        try:
            while data := await reader.read(1000):
                self.sent["primary"] += data
        finally:
            sending.cancel()

    async def dashboard(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writer.write(b"EliRobot dashboard shell, version 2.9.0.0.\r\nType help.\r\nType help name.\r\n")
        while line := await reader.readline():
            self.sent["dashboard"] += line
            text = line.decode().strip()
            reply = self.replies.get(text, f"Unknown command: {text}")
            if reply is not None:
                writer.write(reply.encode() + b"\r\n")


class Page:
    """What a page was sent, and how it speaks."""

    def __init__(self, source: ConnectedSource) -> None:
        self.source = source
        self.messages: list[dict[str, Any]] = []
        self.frames: list[bytes] = []

    def __call__(self, message: Any) -> None:
        if isinstance(message, bytes):
            self.frames.append(message)
        else:
            self.messages.append(message)

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [message for message in self.messages if message["type"] == kind]

    async def until(self, condition: Callable[[], Any], limit_s: float = 5.0) -> None:
        async with asyncio.timeout(limit_s):
            while not condition():
                await asyncio.sleep(0.005)

    async def say(self, **fields: Any) -> None:
        await self.source.take(read_message(json.dumps(fields)))

    async def ask(self, **fields: Any) -> dict[str, Any]:
        """Say something that is answered; return the answer."""
        number = len(self.of("done")) + len(self.of("refused")) + 1000
        await self.say(**fields, ask=number)
        found: list[dict[str, Any]] = []

        def answered() -> bool:
            found[:] = [message for message in self.messages if message.get("ask") == number]
            return bool(found)

        await self.until(answered)
        return found[0]

    def controller(self) -> dict[str, Any]:
        return self.of("moment")[-1]["controller"]


@contextlib.asynccontextmanager
async def shown(
    target: Target, pages: int = 1, backoff_s: tuple[float, ...] = (0.02,)
) -> AsyncIterator[tuple[ConnectedController, list[Page]]]:
    """Pages that show a controller."""
    controller = ConnectedController(target, backoff_s)
    await controller.open()
    made = [Page(ConnectedSource(controller)) for _ in range(pages)]
    try:
        for page in made:
            await page.source.start(page)
        yield controller, made
    finally:
        for page in made:
            await page.source.close()
        await controller.close()


@contextlib.asynccontextmanager
async def faked(may_control: bool = False, **options: Any) -> AsyncIterator[tuple[FakeController, Page]]:
    """A page that shows a fake controller."""
    fake = FakeController()
    await fake.open()
    try:
        async with shown(Target("127.0.0.1", fake.ports, may_control=may_control), **options) as (_, pages):
            yield fake, pages[0]
    finally:
        await fake.close()


def run(test: Any) -> None:
    """Run a test in an event loop of its own, for a limited time."""
    asyncio.run(asyncio.wait_for(test, 20.0))
