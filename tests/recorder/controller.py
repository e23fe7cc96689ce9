"""A controller for tests of the recorder: three ports on loopback, everything that arrives kept, rows as it is told."""

from __future__ import annotations

import asyncio
import contextlib
import struct
from collections.abc import AsyncIterator, Callable, Iterable, Mapping

from elitescript.protocol.primary.messages import TEXT
from elitescript.protocol.rtsi.variables import OUTPUTS
from elitescript.recorder.session import Target
from tests.protocol.rtsi_client import message

HOST = "127.0.0.1"
GREETING = b"EliRobot dashboard shell\r\nType help.\r\nType help NAME.\r\n"
ANSWERS = {
    "echo": "Hello ELITE ROBOTS.",
    "version": "2.14.0.1",
    "robot -t": "CS66",
    "robot -s": "ES1234",
    "robot -id": "7",
    "task": "Relative path:cells/pick.task",
}

Values = Callable[[float], Mapping[str, float]]


def nothing(_t: float) -> Mapping[str, float]:
    """All variables are 0."""
    return {}


class FakeController:
    """What the three ports do, and what has arrived at them.

    Attributes:
        connections: of RTSI, one list of times for each that comes: its rows, sent at once. After the last of a list
            the connection is left open and silent, or is closed before another list.
        values: of variables at a time; of all others 0.
        missing: variables that it does not have.
        recipes_max: recipes of a connection; at a further one it hangs up.
        asks_first: whether rows come only when the dashboard has been asked everything once.
        got: bytes by port.
    """

    def __init__(
        self,
        *connections: Iterable[float],
        values: Values = nothing,
        missing: Iterable[str] = (),
        recipes_max: int = 9,
        closes: bool = True,
        after: bytes = b"",
        primary: bytes = b"",
        asks_first: bool = False,
    ) -> None:
        self.connections = [list(times) for times in connections]
        self.values = values
        self.missing = frozenset(missing)
        self.recipes_max = recipes_max
        self.closes = closes
        self.after = after
        self.primary = primary
        self.asks_first = asks_first
        self.asked = asyncio.Event()
        self.got = {"rtsi": bytearray(), "primary": bytearray(), "dashboard": bytearray()}
        self.opened = dict.fromkeys(self.got, 0)

    async def rtsi(self, reader, writer) -> None:
        times = self.connections[min(self.opened["rtsi"], len(self.connections) - 1)]
        is_last = self.opened["rtsi"] >= len(self.connections) - 1
        self.opened["rtsi"] += 1
        recipes: list[tuple[float, list[str]]] = []
        while True:
            head = await reader.readexactly(3)
            body = await reader.readexactly(struct.unpack(">H", head[:2])[0] - 3)
            self.got["rtsi"] += head + body
            letter = chr(head[2])
            if letter == "V":
                writer.write(message("V", b"\x01"))
            elif letter == "v":
                writer.write(message("v", struct.pack(">4I", 2, 14, 0, 1)))
            elif letter == "O":
                names = body[8:].decode().split(",")
                words = ["NOT_FOUND" if name in self.missing else OUTPUTS[name].type.name for name in names]
                number = 0
                if "NOT_FOUND" not in words:
                    if len(recipes) == self.recipes_max:
                        return
                    recipes.append((struct.unpack(">d", body[:8])[0], names))
                    number = len(recipes)
                writer.write(message("O", bytes((number,)) + ",".join(words).encode()))
            elif letter == "S":
                writer.write(message("S", b"\x01"))
                break
        if self.asks_first:
            await self.asked.wait()
        fastest = max(hz for hz, _ in recipes)
        for index, t in enumerate(times):
            for number, (hz, names) in enumerate(recipes, 1):
                if index % round(fastest / hz) == 0:
                    writer.write(message("U", bytes((number,)) + self._package(names, t)))
            if index % 100 == 0:
                await writer.drain()
        writer.write(self.after)
        await writer.drain()
        if is_last or not self.closes:
            self.got["rtsi"] += await reader.read()

    def _package(self, names: list[str], t: float) -> bytes:
        values = {"timestamp": t, **self.values(t)}
        data = b""
        for name in names:
            wire = OUTPUTS[name].type
            value = values.get(name, 0)
            parts = value if isinstance(value, tuple) else (value,) * wire.length
            data += struct.pack(">" + wire.layout, *parts)
        return data

    async def primary_port(self, reader, writer) -> None:
        self.opened["primary"] += 1
        writer.write(self.primary or TEXT.pack(250, (), "hello"))
        self.got["primary"] += await reader.read()

    async def dashboard(self, reader, writer) -> None:
        self.opened["dashboard"] += 1
        writer.write(GREETING)
        while line := await reader.readline():
            self.got["dashboard"] += line
            if line == b"remoteControl -s\n":
                self.asked.set()
            writer.write(ANSWERS.get(line.decode().strip(), "fine").encode() + b"\r\n")


@contextlib.asynccontextmanager
async def served(controller: FakeController, *names: str) -> AsyncIterator[Target]:
    """Open its ports, or some of them; the target for a session. The others are closed."""
    handlers = {"rtsi": controller.rtsi, "primary": controller.primary_port, "dashboard": controller.dashboard}
    servers = {}
    ports = dict.fromkeys(handlers, closed_port())
    tasks = set()
    try:
        for name in names or handlers:

            def accept(reader, writer, handler=handlers[name]):
                async def handle():
                    try:
                        with contextlib.suppress(OSError, EOFError):
                            await handler(reader, writer)
                            # What was written still arrives.
                            writer.close()
                            await writer.wait_closed()
                    finally:
                        writer.transport.abort()

                tasks.add(asyncio.create_task(handle()))

            servers[name] = await asyncio.start_server(accept, HOST, 0)
            ports[name] = servers[name].sockets[0].getsockname()[1]
        yield Target(HOST, ports, backoff_s=(0.01,))
    finally:
        for server in servers.values():
            server.close()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        # Transports close in the next turn of the loop.
        await asyncio.sleep(0)


def closed_port() -> int:
    """A port of this computer at which nobody is."""
    import socket

    with socket.socket() as found:
        found.bind((HOST, 0))
        return found.getsockname()[1]


def ticks(begin: float, count: int) -> list[float]:
    """So many times, 4 ms apart."""
    return [round(begin + 0.004 * index, 6) for index in range(count)]
