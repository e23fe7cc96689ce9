"""Serial lines of programs: pseudo-terminals and TCP bridges, held by the process that serves."""

from __future__ import annotations

import asyncio
import contextlib
import sys
from collections.abc import AsyncIterator

import pytest

from elitescript.messages.enums import ChannelError
from elitescript.messages.inputs import ChannelClosed, ChannelCredit, ChannelData, ChannelOpened, Input
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import (
    CHANNEL_WINDOW,
    NOT_CONNECTED,
    CloseChannel,
    CreditChannel,
    OpenLine,
    SendChannel,
)
from elitescript.services.channels.broker import Broker
from elitescript.services.channels.serial_ports import UNSENT_MAX
from tests.environment.terminal import Terminal
from tests.services.served import run

pytest.importorskip("serial")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")

SETTINGS = LineSettings(115200, 0, 1, 8)


class Outside:
    """A broker with a terminal on the tool's port and a bridge on that of the box, and what the robot has heard."""

    def __init__(self, port: int) -> None:
        self.heard: list[Input] = []
        self.news = asyncio.Event()
        self.terminal = Terminal()
        self.peers: asyncio.Queue[tuple[asyncio.StreamReader, asyncio.StreamWriter]] = asyncio.Queue()
        lines = {"tool": self.terminal.name, "/dev/ttymxc0": f"socket://127.0.0.1:{port}", "/dev/ttyS2": "/dev/nothing"}
        self.broker = Broker(self._hear, lines)

    def _hear(self, inputs: list[Input]) -> None:
        self.heard += inputs
        self.news.set()

    async def hear(self, kind: type) -> Input:
        """Wait for an input of a kind and forget it."""
        while True:
            for item in self.heard:
                if isinstance(item, kind):
                    self.heard.remove(item)
                    return item
            self.news.clear()
            await self.news.wait()

    async def open(self, number: int, device: str = "tool") -> None:
        self.broker.carry_out([OpenLine(number, device, SETTINGS)])
        assert await self.hear(ChannelOpened) == ChannelOpened(number, True)


@contextlib.asynccontextmanager
async def outside() -> AsyncIterator[Outside]:
    met: asyncio.Queue[tuple[asyncio.StreamReader, asyncio.StreamWriter]] = asyncio.Queue()

    async def meet(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await met.put((reader, writer))

    server = await asyncio.start_server(meet, "127.0.0.1", 0)
    scene = Outside(server.sockets[0].getsockname()[1])
    scene.peers = met
    try:
        yield scene
    finally:
        scene.broker.close_all()
        scene.terminal.close()
        server.close()
        await asyncio.sleep(0)
        await asyncio.sleep(0)


def test_bytes_go_both_ways_over_a_port() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            scene.broker.carry_out([SendChannel(1, b"hello")])
            assert await scene.hear(ChannelCredit) == ChannelCredit(1, 5)
            assert scene.terminal.read(5) == b"hello"
            scene.terminal.write(b"answer")
            assert await scene.hear(ChannelData) == ChannelData(1, b"answer")

    run(test())


def test_bytes_go_both_ways_over_a_bridge() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1, "/dev/ttymxc0")
            reader, writer = await scene.peers.get()
            scene.broker.carry_out([SendChannel(1, b"hello")])
            assert await reader.readexactly(5) == b"hello"
            writer.write(b"answer")
            assert await scene.hear(ChannelData) == ChannelData(1, b"answer")
            writer.close()
            assert await scene.hear(ChannelClosed) == ChannelClosed(1)

    run(test())


def test_a_port_that_is_bound_to_nothing_is_not_connected() -> None:
    heard: list[Input] = []
    Broker(heard.extend).carry_out([OpenLine(1, "tool", SETTINGS)])
    assert heard == [ChannelOpened(1, False, NOT_CONNECTED, ChannelError.NOTHING_BOUND)]


def test_a_device_that_is_not_there_is_refused_with_the_reason() -> None:
    async def test() -> None:
        async with outside() as scene:
            scene.broker.carry_out([OpenLine(1, "/dev/ttyS2", SETTINGS)])
            opened = await scene.hear(ChannelOpened)
            assert isinstance(opened, ChannelOpened)
            assert (opened.is_open, "No such file" in opened.reason) == (False, True)
            scene.broker.carry_out([SendChannel(1, b"x"), CreditChannel(1, 1), CloseChannel(1)])

    run(test())


def test_a_bridge_to_nobody_is_refused_with_the_reason() -> None:
    async def test() -> None:
        broker_heard: list[Input] = []
        news = asyncio.Event()

        def hear(inputs: list[Input]) -> None:
            broker_heard.extend(inputs)
            news.set()

        server = await asyncio.start_server(lambda reader, writer: None, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        server.close()
        await server.wait_closed()
        Broker(hear, {"tool": f"socket://127.0.0.1:{port}"}).carry_out([OpenLine(1, "tool", SETTINGS)])
        await news.wait()
        (opened,) = broker_heard
        assert isinstance(opened, ChannelOpened)
        assert not opened.is_open
        assert opened.reason

    run(test())


def test_a_port_can_be_opened_anew() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            scene.broker.carry_out([CloseChannel(1)])
            await scene.open(2)
            scene.terminal.write(b"x")
            assert await scene.hear(ChannelData) == ChannelData(2, b"x")

    run(test())


def test_a_port_is_open_once_and_a_number_stands_for_one_channel() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            scene.broker.carry_out([OpenLine(1, "/dev/ttymxc0", SETTINGS)])
            assert await scene.hear(ChannelOpened) == ChannelOpened(1, False, "channel 1 is in use")
            scene.broker.carry_out([OpenLine(2, "tool", SETTINGS)])
            opened = await scene.hear(ChannelOpened)
            assert isinstance(opened, ChannelOpened)
            assert (opened.channel, opened.is_open) == (2, False)

    run(test())


def test_a_device_that_goes_closes_the_channel_and_may_come_again() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            scene.terminal.hang_up()
            closed = await scene.hear(ChannelClosed)
            assert isinstance(closed, ChannelClosed)
            assert closed.channel == 1
            assert closed.reason

    run(test())


def test_what_was_sent_leaves_after_the_port_was_closed() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            data = bytes(range(250)) * 100
            scene.broker.carry_out([SendChannel(1, data), CloseChannel(1)])
            assert await asyncio.to_thread(scene.terminal.read, len(data)) == data

    run(test())


def test_a_port_that_is_opened_anew_does_not_wait_for_what_was_sent() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            scene.broker.carry_out([SendChannel(1, bytes(60_000)), CloseChannel(1)])
            await scene.open(2)

    run(test())


def test_no_more_comes_than_there_is_room_for() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            received = 0
            chunk = bytes(1024)
            while received < CHANNEL_WINDOW:
                scene.terminal.write(chunk)
                data = await scene.hear(ChannelData)
                assert isinstance(data, ChannelData)
                received += len(data.data)
                while received % 1024:
                    more = await scene.hear(ChannelData)
                    assert isinstance(more, ChannelData)
                    received += len(more.data)
            scene.terminal.write(b"more")
            for _ in range(5):
                await asyncio.sleep(0)
            assert scene.heard == []
            scene.broker.carry_out([CreditChannel(1, 2)])
            assert await scene.hear(ChannelData) == ChannelData(1, b"mo")

    run(test())


def test_who_does_not_keep_to_the_window_loses_the_port() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            scene.broker.carry_out([SendChannel(1, bytes(UNSENT_MAX)), SendChannel(1, bytes(CHANNEL_WINDOW))])
            closed = await scene.hear(ChannelClosed)
            assert closed == ChannelClosed(1, f"{UNSENT_MAX} bytes wait for a port that takes none", ChannelError.OTHER)

    run(test())
