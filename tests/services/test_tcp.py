"""Clients that do what they should not: each harms itself alone."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import time
from typing import Any

import pytest

from elitescript.messages.outputs import Output
from elitescript.messages.timing import PERIOD_S
from elitescript.protocol.rtsi.connection import RtsiConnection
from elitescript.services.clients import listener, tcp
from tests.protocol import rtsi_client
from tests.services.served import Peer, Scene, run, serving


async def stream(scene: Scene, frequency_hz: float = 250.0, names: list[str] | None = None) -> Peer:
    """An RTSI client that gets packages."""
    peer = await scene.connect("rtsi")
    peer.send(rtsi_client.output_recipe(frequency_hz, names or ["timestamp"]) + rtsi_client.message("S"))
    await peer.rtsi("U")
    return peer


async def reads_on_time(scene: Scene, peer: Peer, packages: int = 25) -> None:
    """A client gets every package, one a tick."""
    first = rtsi_client.values((await peer.rtsi("U"))[1], ["DOUBLE"])[0]
    for _ in range(packages):
        last = rtsi_client.values((await peer.rtsi("U"))[1], ["DOUBLE"])[0]
    assert round((last - first) * 250) == packages


def test_a_flood_of_requests_leaves_the_others_their_time() -> None:
    async def test() -> None:
        async with serving() as scene:
            good = await stream(scene)
            flood = await scene.connect("rtsi")
            before = scene.server.output.tick
            data = rtsi_client.message("V", b"\0\1") * 20_000
            flood.send(data)
            read = 0
            while read < 4 * 20_000:
                chunk = await flood.reader.read(65536)
                assert chunk
                read += len(chunk)
            assert scene.server.output.tick - before > 5, "it was served over many ticks"
            await reads_on_time(scene, good)

    run(test())


def test_a_client_that_asks_and_does_not_read_is_not_read_either() -> None:
    async def test() -> None:
        async with serving() as scene:
            good = await stream(scene)
            deaf = await scene.connect("dashboard")
            deaf.writer.transport.pause_reading()
            client = next(iter(scene.server.listeners["dashboard"].clients.values()))
            for _ in range(400):
                deaf.send(b"help\n" * 100)
                await asyncio.sleep(0)
                if client.is_behind:
                    break
            await scene.until(lambda: client.is_behind)
            await reads_on_time(scene, good)
            transport: Any = client._transport
            assert transport.get_write_buffer_size() < 2 * tcp.BACKLOG_MAX

    run(test())


def test_a_stream_that_is_not_read_loses_packages_and_goes_on_when_it_is() -> None:
    async def test() -> None:
        async with serving() as scene:
            good = await stream(scene)
            slow = await stream(scene, names=rtsi_client.STANDARD_OUTPUTS * 20)
            raw = slow.writer.get_extra_info("socket")
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client = scene.server.listeners["rtsi"].clients["rtsi#2"]
            slow.writer.transport.pause_reading()
            own: Any = client._transport
            own.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
            await scene.until(lambda: client.dropped > 3)
            await reads_on_time(scene, good)
            assert len(scene.notes("slow")) == 1
            slow.writer.transport.resume_reading()
            await slow.rtsi("U")
            await scene.until(lambda: not client.is_behind)

    run(test())


def test_a_client_that_takes_nothing_for_long_is_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tcp, "STALLED_TICKS", 5)

    async def test() -> None:
        async with serving() as scene:
            slow = await stream(scene, names=rtsi_client.STANDARD_OUTPUTS * 20)
            client = scene.server.listeners["rtsi"].clients["rtsi#1"]
            slow.writer.transport.pause_reading()
            own: Any = client._transport
            own.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
            await scene.until(lambda: scene.notes("cut_off"))
            await scene.until(lambda: not scene.server.listeners["rtsi"].clients)
            slow.writer.transport.resume_reading()

    run(test())


def test_a_disconnect_in_the_middle_of_a_package_is_the_end_of_one_client() -> None:
    async def test() -> None:
        async with serving() as scene:
            good = await stream(scene)
            for cut in (1, 2, 5, 20):
                bad = await scene.connect("rtsi")
                bad.send(rtsi_client.output_recipe(250.0, rtsi_client.STANDARD_OUTPUTS)[:cut])
                if cut % 2:
                    bad.reset()
                else:
                    await bad.close()
            await reads_on_time(scene, good)
            await scene.until(lambda: len(scene.notes("gone")) == 4 or scene.server.output.tick > 2000)
            assert scene.server.listeners["rtsi"].clients.keys() == {"rtsi#1"}

    run(test())


def test_too_many_clients_are_turned_away(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listener, "CLIENTS_MAX", 3)

    async def test() -> None:
        async with serving() as scene:
            for _ in range(3):
                assert (await (await scene.connect("dashboard")).line()).startswith("EliRobot")
            late = await scene.connect("dashboard")
            with contextlib.suppress(ConnectionResetError):
                assert await late.reader.read() == b""
            assert len(scene.notes("refused")) == 1

    run(test())


def test_a_mistake_of_ours_costs_one_client_its_connection(monkeypatch: pytest.MonkeyPatch) -> None:
    publish = RtsiConnection.publish

    def broken(self: RtsiConnection, output: Output) -> None:
        if self.origin == "rtsi#2":
            raise RuntimeError("a mistake")
        publish(self, output)

    monkeypatch.setattr(RtsiConnection, "publish", broken)

    async def test() -> None:
        async with serving() as scene:
            good = await stream(scene)
            await scene.connect("rtsi")
            await scene.until(lambda: scene.notes("bug"))
            assert "RuntimeError: a mistake" in scene.notes("bug")[0].text
            await reads_on_time(scene, good)

    run(test())


def test_a_busy_connection_is_not_read() -> None:
    """A program larger than what is read in a tick arrives whole, a piece a tick."""

    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("primary")
            body = "".join(f"  x = {number}\n" for number in range(20_000))
            peer.send(f"def big():\n{body}end\n".encode())
            await scene.until(scene.robot.units)
            assert scene.robot.units()[0].count("\n") >= 20_001

    run(test())


def test_goodbye_arrives_before_the_end() -> None:
    async def test() -> None:
        async with serving() as scene:
            peer = await scene.connect("dashboard")
            peer.send(b"quit\n")
            data = await peer.reader.read()
            assert data.endswith(b"Bye.\r\n")

    run(test())


def test_floods_of_all_kinds_at_once_cost_no_tick() -> None:
    async def test() -> None:
        async with serving() as scene:
            good = await stream(scene)
            begin_s = time.monotonic() - time.process_time()
            floods = {
                "rtsi": rtsi_client.message("U", b"\x01" + bytes(4)) * 20_000,
                "primary": bytes(range(256)) * 400,
                "dashboard": b"robotMode\n" * 10_000,
                "interpreter": b"x = 1\n" * 10_000,
                "query": b"req 1 get_joint_temp(1)\n" * 4_000,
            }
            for service, data in floods.items():
                for number in range(6):
                    peer = await scene.connect(service)
                    if service == "rtsi":
                        peer.send(rtsi_client.message("I", f"input_int_register{number}".encode()))
                    peer.send(data)
            storm = [await scene.connect("readonly") for _ in range(100)]
            await reads_on_time(scene, good, 200)
            # A computer that is busy accepts a storm later.
            door = scene.server.listeners["readonly"]
            await scene.until(lambda: door.refused + door.count >= len(storm))
            assert door.count == listener.CLIENTS_MAX
            # Ticks that this computer was away for, with both cores busy elsewhere, are not lost to the floods.
            away_s = time.monotonic() - time.process_time() - begin_s
            assert scene.server.left_out * PERIOD_S <= away_s
            assert all(scene.server.waiting_of(f"rtsi#{number}") <= 2 * tcp.POSTED_MAX for number in range(2, 8))

    run(test())
