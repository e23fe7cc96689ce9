"""Ports: how many come in, how fast, and what those hear who find no room."""

from __future__ import annotations

import asyncio
import errno
import socket

import pytest

from elitescript.services.clients import listener
from tests.services.served import run, serving


def test_refused_clients_are_told_once_a_burst(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listener, "CLIENTS_MAX", 2)
    monkeypatch.setattr(listener, "BURST_TICKS", 5)

    async def test() -> None:
        async with serving() as scene:
            for _ in range(2):
                await (await scene.connect("dashboard")).line()
            port = scene.server.listeners["dashboard"]
            for _ in range(20):
                late = await scene.connect("dashboard")
                assert await late.reader.read() == b"", "the end comes without a reset"
            assert port.refused == 20
            await scene.until(lambda: len(scene.notes("refused")) == 2)
            first, rest = scene.notes("refused")
            assert "2 clients are connected" in first.text
            assert (first.details["count"], rest.details["count"]) == (1, 19)
            await scene.ticks(10)
            assert len(scene.notes("refused")) == 2

    run(test())


def test_a_storm_of_clients_is_accepted_at_a_pace() -> None:
    async def test() -> None:
        async with serving() as scene:
            port = scene.server.listeners["dashboard"]
            storm = [socket.create_connection(("127.0.0.1", port.number)) for _ in range(300)]
            try:
                # All of them have connected; the operating system holds those who are not accepted.
                most = 0
                seen = port._count + port.refused
                while port._count + port.refused < 300:
                    await scene.ticks()
                    now = port._count + port.refused
                    most, seen = max(most, now - seen), now
                assert most <= 2 * listener.ACCEPTS_PER_TICK
                assert port.count == listener.CLIENTS_MAX
            finally:
                for one in storm:
                    one.close()
            await scene.until(lambda: not port.clients)
            assert (await (await scene.connect("dashboard")).line()).startswith("EliRobot")

    run(test())


def test_a_process_without_sockets_goes_on_when_it_has_some(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listener, "NO_ROOM_S", 0.001)

    async def test() -> None:
        async with serving() as scene:
            loop = asyncio.get_running_loop()
            accept, failures = loop.sock_accept, [errno.EMFILE, errno.ECONNABORTED]

            async def failing(bound):
                found = await accept(bound)
                if failures:
                    found[0].close()
                    raise OSError(failures.pop(0), "no more")
                return found

            monkeypatch.setattr(loop, "sock_accept", failing)
            for _ in range(3):
                await scene.connect("dashboard")
            good = await scene.connect("dashboard")
            assert (await good.line()).startswith("EliRobot")
            assert [note.details["count"] for note in scene.notes("refused")] == [1]

    run(test())
