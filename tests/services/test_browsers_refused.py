"""A page in a web browser reaches no port of a robot."""

from __future__ import annotations

import pytest

from elitescript.services.port_numbers import NAMES
from tests.services.served import Scene, run, serving

SCRIPT = b'def f():\n  textmsg("from a page")\nend\n'
BODIES = {
    "dashboard": b"robotControl -on\r\n",
    "interpreter": b"halt()\n",
    "query": b"req 1 halt()\n",
    "rtsi": b"\x00\x04S" * 10_000,
}
HEAD = b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: text/plain\r\n\r\n"


async def is_closed(scene: Scene, service: str, *pieces: bytes) -> bool:
    """Whether a client that sends so much is closed, and the robot has heard nothing of it."""
    peer = await scene.connect(service)
    for piece in pieces:
        peer.send(piece)
        await scene.ticks(1)
    try:
        while await peer.reader.read(65536):
            pass
    except ConnectionError:
        pass
    await scene.ticks(30)
    return not scene.server.listeners[service].clients and not scene.robot.heard


@pytest.mark.parametrize("service", NAMES)
def test_a_request_ends_its_connection_before_anything_is_read_of_it(service: str) -> None:
    async def test() -> None:
        async with serving() as scene:
            body = BODIES.get(service, SCRIPT)
            assert await is_closed(scene, service, HEAD + body)
            assert await is_closed(scene, service, HEAD[:4], HEAD[4:9], HEAD[9:], body)
            assert await is_closed(scene, service, b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + body)

    run(test())


def test_the_log_says_so_once_for_a_burst() -> None:
    async def test() -> None:
        async with serving() as scene:
            for _ in range(20):
                assert await is_closed(scene, "primary", HEAD + SCRIPT)
            (note,) = scene.notes("refused")
            assert note.is_problem
            assert note.text.startswith("primary: primary#1 from 127.0.0.1:")
            assert note.text.endswith(": closed: it sent a web request (POST), as a web browser does")

    run(test())


def test_others_are_read_as_before() -> None:
    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("primary")
            peer.send(SCRIPT)
            await scene.until(lambda: scene.robot.heard)

    run(test())
