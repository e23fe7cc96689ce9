"""A client that sends and goes at once: what it sent counts."""

from __future__ import annotations

import asyncio
import socket
import struct

import pytest

from elitescript.messages.inputs import Interpret, RunUnit
from elitescript.services.clients.tcp import Client
from tests.services.served import Scene, run, serving

LINES = 4000
PROGRAM = "\n".join(["def f():", *(f"  x = {number}" for number in range(LINES)), "end", ""]).encode()


def connected(scene: Scene, service: str) -> socket.socket:
    return socket.create_connection(("127.0.0.1", scene.server.ports[service]))


async def heard(scene: Scene, kind: type) -> list[str]:
    """What the robot has heard within some ticks."""
    for _ in range(2500):
        await scene.ticks()
        if found := [item.text for _, item in scene.robot.heard if isinstance(item, kind)]:
            return found
    return []


@pytest.mark.parametrize("service", ["primary", "secondary", "realtime"])
@pytest.mark.parametrize("end", ["close", "reset", "half"])
def test_a_program_is_read_to_its_end(service: str, end: str) -> None:
    async def test() -> None:
        async with serving() as scene:
            raw = connected(scene, service)
            # States that it has not read make a reset of its end.
            await scene.ticks(30)
            raw.sendall(PROGRAM)
            if end == "half":
                raw.shutdown(socket.SHUT_WR)
            elif end == "reset":
                raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            if end != "half":
                raw.close()
            assert await heard(scene, RunUnit) == [PROGRAM.decode().rstrip("\n")]
            raw.close()
            await scene.until(lambda: not scene.server.listeners[service].clients)

    run(test())


@pytest.mark.parametrize("service", ["primary", "secondary", "realtime"])
def test_half_a_megabyte_that_is_sent_and_closed_at_once_arrives_whole(service: str) -> None:
    program = "\n".join(["def f():", *(f"  x = 'text of the line {number:06}'" for number in range(15_000)), "end", ""])

    def send(number: int) -> None:
        with socket.create_connection(("127.0.0.1", number)) as raw:
            raw.sendall(program.encode())

    async def test() -> None:
        async with serving() as scene:
            await asyncio.to_thread(send, scene.server.ports[service])
            assert await heard(scene, RunUnit) == [program.rstrip("\n")]
            await scene.until(lambda: not scene.server.listeners[service].clients)
            assert scene.server.shares.kept == 0

    run(test())


@pytest.mark.parametrize("service", ["primary", "secondary", "realtime"])
def test_a_client_in_the_middle_of_a_program_is_sent_nothing(service: str) -> None:
    """Whatever it has not read when it closes makes its computer throw away what it still holds."""

    def waiting(raw: socket.socket) -> bytes:
        try:
            return raw.recv(1 << 20)
        except BlockingIOError:
            return b""

    async def test() -> None:
        async with serving() as scene:
            raw = connected(scene, service)
            raw.setblocking(False)
            for piece in (b"def f():\n", b"  x = 1\n", b"  y = 2"):
                raw.sendall(piece)
                await scene.until(lambda: scene.server.listeners[service].clients)
                await scene.ticks(20)
            assert waiting(raw) == b""
            raw.sendall(b"\nend\n")
            assert await heard(scene, RunUnit) == ["def f():\n  x = 1\n  y = 2\nend"]
            await scene.ticks(2)
            assert waiting(raw)
            # One that stops in the middle gets its stream all the same.
            raw.sendall(b"def g():\n")
            await scene.ticks(40)
            waiting(raw)
            await scene.ticks(30)
            assert waiting(raw)
            raw.close()

    run(test())


def test_one_that_has_gone_before_it_was_accepted_counts_too() -> None:
    async def test() -> None:
        async with serving() as scene:
            for _ in range(5):
                raw = connected(scene, "primary")
                raw.sendall(PROGRAM)
                raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                raw.close()
            await scene.until(lambda: len(scene.robot.heard) == 5)
            assert all(isinstance(item, RunUnit) for _, item in scene.robot.heard)

    run(test())


def test_statements_count_too() -> None:
    async def test() -> None:
        async with serving() as scene:
            raw = connected(scene, "interpreter")
            raw.sendall(b"".join(b"x = %d\n" % number for number in range(2000)))
            await scene.ticks(5)
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            raw.close()
            await scene.until(lambda: len(scene.robot.heard) == 2000)
            assert all(isinstance(item, Interpret) for _, item in scene.robot.heard)

    run(test())


def test_others_keep_their_stream_meanwhile() -> None:
    async def test() -> None:
        async with serving() as scene:
            raw = connected(scene, "primary")
            raw.setblocking(False)
            await scene.ticks(3)
            sent = raw.send(b"# nothing\n" * 100_000)
            assert sent > 100_000
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            raw.close()
            before = scene.server.output.tick
            await scene.until(lambda: not scene.server.listeners["primary"].clients)
            assert scene.server.output.tick - before > sent // 100_000, "it was read over many ticks"

    run(test())


def test_a_tick_before_the_connection_is_made_does_not_lose_the_greeting() -> None:
    async def test() -> None:
        async with serving() as scene:
            listener = scene.server.listeners["dashboard"]
            client = Client(scene.server, listener.service, listener.connect("dashboard#9"), str.upper, str.upper)
            client.publish(scene.server.output)
            assert client.connection.take()

    run(test())
