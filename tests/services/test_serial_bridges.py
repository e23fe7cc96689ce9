"""TCP ports that carry serial lines."""

from __future__ import annotations

import asyncio
import contextlib
import socket

import pytest

from elitescript.errors import UsageError
from elitescript.messages.inputs import ChannelData, ChannelOpened
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import OpenLine, SendChannel
from elitescript.services.ssh import serial_bridges
from elitescript.services.ssh.line_taps import LineTaps
from elitescript.services.ssh.serial_bridges import SerialBridges
from tests.services.served import run


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return int(probe.getsockname()[1])


def open_taps() -> LineTaps:
    taps = LineTaps(lambda text: None)
    taps.outgoing([OpenLine(7, "tool", LineSettings(9600, 0, 1, 8))])
    taps.incoming([ChannelOpened(7, True)])
    return taps


async def sent(taps: LineTaps) -> bytes:
    """What comes from clients next."""
    while True:
        for request in taps.outgoing([]):
            if isinstance(request, SendChannel):
                return request.data
        await asyncio.sleep(0)


def test_bytes_go_both_ways_and_the_bridge_outlives_its_clients() -> None:
    async def scene() -> None:
        taps, port = open_taps(), free_port()
        bridges = SerialBridges("127.0.0.1", taps)
        number = await bridges.start(port, "tool")
        assert bridges.find(port) == number and bridges.find(port + 1) == 0
        for _ in range(2):
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(b"hello")
            assert await sent(taps) == b"hello"
            assert taps.incoming([ChannelData(7, b"world")]) == []
            assert await reader.readexactly(5) == b"world"
            writer.close()
            await writer.wait_closed()
        bridges.close_all()

    run(scene())


def test_killing_a_bridge_ends_its_connections_and_frees_its_port() -> None:
    async def scene() -> None:
        taps, port = open_taps(), free_port()
        bridges = SerialBridges("127.0.0.1", taps)
        number = await bridges.start(port, "tool")
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"x")
        assert await sent(taps) == b"x"
        assert bridges.kill(number)
        assert not bridges.kill(number)
        with pytest.raises(ConnectionError):
            assert await reader.read() == b""
            raise ConnectionResetError
        writer.close()
        with pytest.raises(ConnectionRefusedError):
            await asyncio.open_connection("127.0.0.1", port)
        again = await bridges.start(port, "tool")
        assert again != number
        bridges.close_all()

    run(scene())


def test_a_port_that_is_taken_or_privileged_is_refused() -> None:
    async def scene() -> None:
        bridges = SerialBridges("127.0.0.1", open_taps())
        with socket.create_server(("127.0.0.1", 0)) as other:
            port = other.getsockname()[1]
            with pytest.raises(UsageError, match=f"serial port tool cannot be bridged at port {port}: .*in use"):
                await bridges.start(port, "tool")
        for port in (22, 1023, 65536):
            with pytest.raises(UsageError, match=f"serial port box must be at a port from 1024 to 65535, not {port}"):
                await bridges.start(port, "/dev/ttymxc0")

    run(scene())


def test_bridges_and_their_clients_are_bounded() -> None:
    async def scene() -> None:
        bridges = SerialBridges("127.0.0.1", open_taps())
        port = free_port()
        await bridges.start(port, "tool")
        ends = [await asyncio.open_connection("127.0.0.1", port) for _ in range(serial_bridges.CLIENTS_MAX)]
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        with contextlib.suppress(ConnectionError):
            assert await reader.read() == b""
        for _, end in (*ends, (reader, writer)):
            end.close()
        for _ in range(serial_bridges.BRIDGES_MAX - 1):
            await bridges.start(free_port(), "tool")
        with pytest.raises(UsageError, match="8 bridges are open"):
            await bridges.start(free_port(), "tool")
        bridges.close_all()

    run(scene())


def test_a_client_that_sends_faster_than_the_line_is_not_read_on() -> None:
    async def scene() -> None:
        taps, port = open_taps(), free_port()
        bridges = SerialBridges("127.0.0.1", taps)
        await bridges.start(port, "tool")
        _, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(bytes(8 << 20))
        (bridge,) = bridges._bridges.values()
        while not bridge.clients or bridge.clients[0]._is_reading:
            await asyncio.sleep(0)
        waiting = len(taps._taps["tool"].pending)
        for _ in range(100):
            await asyncio.sleep(0)
        assert len(taps._taps["tool"].pending) == waiting < 1 << 20
        writer.transport.abort()
        bridges.close_all()

    run(scene())
