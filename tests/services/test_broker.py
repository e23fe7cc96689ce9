"""Outgoing connections of programs: real sockets on loopback."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import socket
import threading
from collections.abc import AsyncIterator

import pytest

from elitescript.messages.inputs import AddLog, ChannelClosed, ChannelCredit, ChannelData, ChannelOpened, Input
from elitescript.messages.outputs import CHANNEL_WINDOW, CloseChannel, CreditChannel, OpenChannel, SendChannel
from elitescript.services.channels.broker import CHANNELS_MAX, LOOK_UPS_MAX, Broker, reason_of
from elitescript.services.clients.binding import bind
from tests.services.served import run


class Outside:
    """A broker, the computer that its connections go to, and what the robot has heard."""

    def __init__(self) -> None:
        self.heard: list[Input] = []
        self.peers: asyncio.Queue[tuple[asyncio.StreamReader, asyncio.StreamWriter]] = asyncio.Queue()
        self.news = asyncio.Event()
        self.broker = Broker(self._hear)
        self.port = 0
        self.writers: list[asyncio.StreamWriter] = []

    def _hear(self, inputs: list[Input]) -> None:
        self.heard += inputs
        self.news.set()

    async def met(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.writers.append(writer)
        await self.peers.put((reader, writer))

    async def hear(self, kind: type) -> Input:
        """Wait for an input of a kind and forget it."""
        while True:
            for item in self.heard:
                if isinstance(item, kind):
                    self.heard.remove(item)
                    return item
            self.news.clear()
            await self.news.wait()

    async def open(self, channel: int) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        self.broker.carry_out([OpenChannel(channel, "tcp", "127.0.0.1", self.port, 2.0)])
        assert await self.hear(ChannelOpened) == ChannelOpened(channel, True)
        return await self.peers.get()


@contextlib.asynccontextmanager
async def outside() -> AsyncIterator[Outside]:
    scene = Outside()
    server = await asyncio.start_server(scene.met, "127.0.0.1", 0)
    scene.port = server.sockets[0].getsockname()[1]
    try:
        yield scene
    finally:
        scene.broker.close_all()
        for writer in scene.writers:
            writer.transport.abort()
        server.close()
        await asyncio.sleep(0)
        await asyncio.sleep(0)


def test_bytes_go_both_ways() -> None:
    async def test() -> None:
        async with outside() as scene:
            reader, writer = await scene.open(1)
            scene.broker.carry_out([SendChannel(1, b"request_program\n")])
            assert await reader.readline() == b"request_program\n"
            assert await scene.hear(ChannelCredit) == ChannelCredit(1, 16)
            writer.write(b"def p():\n")
            assert await scene.hear(ChannelData) == ChannelData(1, b"def p():\n")

    run(test())


def test_what_a_peer_sends_at_once_comes_after_the_news_that_it_is_open() -> None:
    async def test() -> None:
        async with outside() as scene:
            scene.broker.carry_out([OpenChannel(1, "tcp", "127.0.0.1", scene.port, 2.0)])
            _, writer = await scene.peers.get()
            writer.write(b"hello")
            await scene.hear(ChannelData)
            assert scene.heard[0] == ChannelOpened(1, True)

    run(test())


def test_a_program_that_does_not_read_stops_its_peer() -> None:
    async def test() -> None:
        async with outside() as scene:
            _, writer = await scene.open(1)
            writer.write(bytes(3 * CHANNEL_WINDOW))
            got = 0
            while got < CHANNEL_WINDOW:
                data = await scene.hear(ChannelData)
                got += len(data.data)
            assert got == CHANNEL_WINDOW
            for _ in range(20):
                await asyncio.sleep(0)
            assert not scene.heard
            scene.broker.carry_out([CreditChannel(1, 100)])
            assert len((await scene.hear(ChannelData)).data) == 100

    run(test())


def test_a_peer_that_does_not_read_gives_no_credit() -> None:
    async def test() -> None:
        async with outside() as scene:
            reader, writer = await scene.open(1)
            writer.transport.pause_reading()
            sent = 0
            while True:
                scene.broker.carry_out([SendChannel(1, bytes(CHANNEL_WINDOW))])
                sent += CHANNEL_WINDOW
                await asyncio.sleep(0)
                if not any(isinstance(item, ChannelCredit) for item in scene.heard):
                    break
                scene.heard.clear()
            writer.transport.resume_reading()
            left = sent
            while left:
                left -= len(await reader.read(left))
            assert await scene.hear(ChannelCredit) == ChannelCredit(1, CHANNEL_WINDOW)

    run(test())


def test_the_end_of_a_peer_is_told_after_its_last_bytes() -> None:
    async def test() -> None:
        async with outside() as scene:
            _, writer = await scene.open(1)
            writer.write(b"bye")
            writer.close()
            await scene.hear(ChannelClosed)
            assert scene.heard == [ChannelData(1, b"bye")]
            assert scene.broker.count == 0

    run(test())


def test_what_was_sent_before_the_close_arrives() -> None:
    async def test() -> None:
        async with outside() as scene:
            reader, _ = await scene.open(1)
            scene.broker.carry_out([SendChannel(1, b"last"), CloseChannel(1)])
            assert await reader.read() == b"last"
            assert not any(isinstance(item, ChannelClosed) for item in scene.heard)

    run(test())


def test_a_peer_that_ends_its_half_gets_what_was_sent_before() -> None:
    sent = 4 * CHANNEL_WINDOW

    async def test() -> None:
        async with outside() as scene:
            reader, writer = await scene.open(1)
            writer.transport.pause_reading()
            scene.broker.carry_out([SendChannel(1, bytes(sent))])
            writer.write(b"all")
            writer.write_eof()
            assert (await scene.hear(ChannelClosed)).reason == ""
            assert [item for item in scene.heard if isinstance(item, ChannelData)] == [ChannelData(1, b"all")]
            assert scene.broker.count == 0
            scene.broker.carry_out([SendChannel(1, b"late"), CreditChannel(1, 5), CloseChannel(1)])
            writer.transport.resume_reading()
            assert len(await reader.read(-1)) == sent
            for _ in range(20):
                await asyncio.sleep(0)
            assert not any(isinstance(item, ChannelClosed) for item in scene.heard)

    run(test())


def test_a_peer_that_ends_its_half_and_does_not_read_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("elitescript.services.channels.broker.LINGER_S", 0.01)

    async def test() -> None:
        async with outside() as scene:
            _, writer = await scene.open(1)
            writer.transport.pause_reading()
            for _ in range(3):
                scene.broker.carry_out([SendChannel(1, bytes(4 * CHANNEL_WINDOW))])
            writer.write_eof()
            assert (await scene.hear(ChannelClosed)).reason == ""
            (leaving,) = scene.broker._leaving
            while not leaving.is_gone:
                await asyncio.sleep(0.001)

    run(test())


def test_connections_of_programs_are_watched() -> None:
    async def test() -> None:
        async with outside() as scene:
            await scene.open(1)
            raw = scene.broker._channels[1]._transport.get_extra_info("socket")
            assert raw.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)

    run(test())


def test_those_that_linger_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("elitescript.services.channels.broker.LEAVING_MAX", 1)
    sent = 16 * 1024 * 1024

    async def test() -> None:
        async with outside() as scene:
            peers = []
            for channel in (1, 2):
                peers.append(await scene.open(channel))
                monkeypatch.setattr("elitescript.services.channels.broker.UNSENT_MAX", sent)
                scene.broker.carry_out([SendChannel(channel, bytes(sent)), CloseChannel(channel)])
            with pytest.raises((ConnectionResetError, asyncio.IncompleteReadError)):
                await peers[0][0].readexactly(sent)
            assert len(await peers[1][0].readexactly(sent)) == sent
            (said,) = [item for item in scene.heard if isinstance(item, AddLog)]
            assert said.is_warning
            assert said.text.startswith("not delivered: ")
            assert said.text.endswith(f" bytes to 127.0.0.1:{scene.port}")

    run(test())


def test_a_refused_connection_says_why() -> None:
    async def test() -> None:
        async with outside() as scene:
            listening = bind("127.0.0.1", 0)
            port = listening.getsockname()[1]
            listening.close()
            scene.broker.carry_out([OpenChannel(1, "tcp", "127.0.0.1", port, 2.0)])
            answer = await scene.hear(ChannelOpened)
            assert not answer.is_open
            assert answer.reason == "connection refused"
            assert scene.broker.count == 0

    run(test())


@pytest.mark.parametrize(
    ("error", "reason", "number"),
    [
        (ConnectionResetError(104, "Connection reset by peer"), "connection reset by peer", 104),
        (BrokenPipeError(32, "Broken pipe"), "broken pipe", 32),
        (TimeoutError(110, "Connection timed out"), "connection timed out", 110),
        (OSError(113, "Connect call failed ('10.0.0.1', 502)"), "no route to host", 113),
        (OSError(101, "Connect call failed"), "network is unreachable", 101),
        (OSError(112, "Connect call failed"), "host is down", 112),
        (OSError("Multiple exceptions: [Errno 111] Connect call failed, [Errno 101] no"), "connection refused", 111),
        (socket.gaierror(socket.EAI_NONAME, "Name or service not known"), "Name or service not known", 113),
        (socket.gaierror(socket.EAI_AGAIN, "Temporary failure"), "Temporary failure", 5),
        (PermissionError(13, "Permission denied"), "permission denied", 5),
        (OSError("no idea"), "no idea", 5),
        (ValueError(), "ValueError", 5),
    ],
)
def test_reasons_are_in_the_words_of_the_operating_system(error: Exception, reason: str, number: int) -> None:
    assert reason_of(error) == (reason, number)


def test_nonsense_is_refused() -> None:
    async def test() -> None:
        async with outside() as scene:
            for request in (
                OpenChannel(1, "tcp", "127.0.0.1", 70000, 1.0),
                OpenChannel(2, "serial", "x", 1, 1.0),
                OpenChannel(3, "tcp", "a\0b", 1, 1.0),
                OpenChannel(4, "tcp", "x" * 300, 1, 1.0),
            ):
                scene.broker.carry_out([request])
                assert not (await scene.hear(ChannelOpened)).is_open
            scene.broker.carry_out([SendChannel(9, b"x"), CloseChannel(9), CreditChannel(9, 5)])

    run(test())


def test_there_are_not_more_channels_than_allowed() -> None:
    async def test() -> None:
        async with outside() as scene:
            for number in range(CHANNELS_MAX):
                await scene.open(number)
            scene.broker.carry_out([OpenChannel(999, "tcp", "127.0.0.1", scene.port, 2.0)])
            assert await scene.hear(ChannelOpened) == ChannelOpened(999, False, f"{CHANNELS_MAX} connections are open")

    run(test())


def test_an_attempt_that_is_closed_says_nothing() -> None:
    async def test() -> None:
        async with outside() as scene:
            scene.broker.carry_out([OpenChannel(1, "tcp", "127.0.0.1", scene.port, 2.0), CloseChannel(1)])
            for _ in range(20):
                await asyncio.sleep(0)
            assert scene.heard == []

    run(test())


def test_names_that_nobody_answers_for_hold_up_nobody_else(monkeypatch):
    answer = threading.Event()
    real = socket.getaddrinfo

    def slow(host, *arguments, **options):
        if host.startswith("slow") and not options.get("flags"):
            answer.wait(10.0)
            raise socket.gaierror(socket.EAI_NONAME, "not known")
        return real(host, *arguments, **options)

    monkeypatch.setattr(socket, "getaddrinfo", slow)

    async def test():
        async with outside() as scene:
            try:
                for number in range(1, 4 * LOOK_UPS_MAX + 1):
                    scene.broker.carry_out([OpenChannel(number, "tcp", f"slow{number}", scene.port, 60.0)])
                    if number > LOOK_UPS_MAX:
                        refusal = await scene.hear(ChannelOpened)
                        assert refusal.reason == f"{LOOK_UPS_MAX} names are being looked up already"
                    else:
                        await asyncio.sleep(0)
                        # Whoever gives up does not end what the name server keeps busy.
                        scene.broker.carry_out([CloseChannel(number)])
                assert await asyncio.get_running_loop().run_in_executor(None, lambda: 5) == 5
                await scene.open(1000)
            finally:
                answer.set()

    run(test())


def test_a_connection_that_has_gone_leaves_nothing_behind_for_later():
    async def test():
        async with outside() as scene:
            reader, _ = await scene.open(1)
            kind = type(scene.broker._channels[1])
            scene.broker.carry_out([CloseChannel(1)])
            assert await reader.read() == b""
            await asyncio.sleep(0)
            scene.broker._leaving.clear()
            gc.collect()
            assert not [found for found in gc.get_objects() if isinstance(found, kind)]

    run(test())
