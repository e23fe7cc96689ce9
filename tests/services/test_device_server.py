"""Devices on real ports and pseudo-terminals."""

from __future__ import annotations

import asyncio
import contextlib
import os

import pytest

from elitescript.errors import UsageError
from elitescript.messages.outputs import CHANNEL_WINDOW
from elitescript.modbus.frames.pdu import read
from elitescript.modbus.frames.rtu import rtu_frame
from elitescript.services.device_server import DeviceServer
from elitescript.testing.world import ModbusDevice, SerialDevice, TcpServer, Wire, World, XmlRpcServer

LIMIT_S = 10.0


class Camera(TcpServer):
    port = 5000

    def line_received(self, connection, line):
        return f"<{line}>"


class Scale(SerialDevice):
    line = "tool"


@contextlib.asynccontextmanager
async def serving(world, **lines):
    async with server_of(world, **lines) as (server, said):
        yield [place.rpartition(" ")[2] for place in server.places], said


@contextlib.asynccontextmanager
async def server_of(world, *, is_running=True, **lines):
    said = []
    ports = {place if isinstance(place, int) else place[1]: 0 for place in world.network.servers}
    server = DeviceServer(world, "127.0.0.1", ports, lines, lambda text, is_problem: said.append((text, is_problem)))
    await server.open()
    task = asyncio.get_running_loop().create_task(server.run()) if is_running else None
    try:
        yield server, said
    finally:
        if task is not None:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task
        server.close()


@contextlib.asynccontextmanager
async def client(port):
    reader, writer = await asyncio.open_connection("127.0.0.1", int(port))
    try:
        yield reader, writer
    finally:
        writer.close()
        with contextlib.suppress(ConnectionError):
            await writer.wait_closed()


def run(test):
    asyncio.run(asyncio.wait_for(test(), LIMIT_S))


def test_a_client_asks_a_device_and_goes():
    world = World(devices=[Camera()])

    async def test():
        async with serving(world) as ((port,), _):
            async with client(port) as (reader, writer):
                for question in (b"where?", b"a", b"b" * 200_000):
                    writer.write(question + b"\n")
                    assert await reader.readexactly(len(question) + 3) == b"<" + question + b">\n"
            while world.network.open_channels:
                await asyncio.sleep(0.01)

    run(test)


def test_a_device_closes_and_refuses():
    class Once(Camera):
        connections_max = 1

        def line_received(self, connection, line):
            connection.send_line("bye")
            connection.close()

    async def test():
        world = World(devices=[Once()])
        async with (
            serving(world) as ((port,), _),
            client(port) as (reader, writer),
            client(port) as (refused, _),
        ):
            with contextlib.suppress(ConnectionError):
                assert await refused.read() == b""
            writer.write(b"x\n")
            assert await reader.read() == b"bye\n"

    run(test)


def test_the_standard_library_calls_a_procedure():
    class Planner(XmlRpcServer):
        port = 8000

        def add(self, a, b):
            return a + b

    async def test():
        from xmlrpc.client import ServerProxy

        async with serving(World(devices=[Planner()])) as ((port,), _):
            with ServerProxy(f"http://127.0.0.1:{port}") as proxy:
                assert await asyncio.to_thread(proxy.add, 2, 3) == 5

    run(test)


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="pseudo-terminals")
def test_a_serial_device_is_a_terminal():
    async def test():
        device = ModbusDevice(line="tool", unit=3, holding_registers=[77])
        async with serving(World(devices=[device])) as ((path,), _):
            terminal = os.open(path, os.O_RDWR | os.O_NOCTTY)
            os.set_blocking(terminal, False)
            os.write(terminal, rtu_frame(3, read(3, 0, 1)))
            data = b""
            while len(data) < 7:
                await asyncio.sleep(0.005)
                with contextlib.suppress(BlockingIOError):
                    data += os.read(terminal, 100)
            os.close(terminal)
            assert data == rtu_frame(3, b"\x03\x02\x00\x4d")

    run(test)


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="pseudo-terminals")
def test_what_writes_to_a_terminal_faster_than_its_line_is_held_up():
    async def test():
        # Time stands still, so the line carries nothing meanwhile.
        async with server_of(World(devices=[Scale()]), is_running=False) as (server, _):
            (end,) = server._terminals
            terminal = os.open(end.path, os.O_RDWR | os.O_NOCTTY)
            os.set_blocking(terminal, False)
            written = 0
            while True:
                try:
                    written += os.write(terminal, bytes(4096))
                except BlockingIOError:
                    if end._room <= 0:
                        break
                    await asyncio.sleep(0)
            os.close(terminal)
            # The window, and what the system holds.
            assert CHANNEL_WINDOW <= written < 4 * CHANNEL_WINDOW

    run(test)


def test_a_client_that_does_not_read_holds_its_device_up():
    class Flood(Camera):
        sent = 0

        def opened(self, connection):
            self.every(0.004, self.more, connection)

        def more(self, connection):
            if connection.link.is_open and self.sent < 128 * 65_536:
                self.sent += 65_536
                connection.send(bytes(65_536))

    async def test():
        flood = Flood()
        async with serving(World(devices=[flood])) as ((port,), _), client(port) as (reader, _):
            reader._transport.pause_reading()
            while flood.sent < 128 * 65_536:
                await asyncio.sleep(0.004)
            (connection,) = flood.connections
            # All that the system does not hold waits in the device.
            assert len(connection.link._outgoing) > 32 * 65_536

    run(test)


def test_wires_work_on_signals_that_are_only_remembered():
    class Button(Camera):
        def line_received(self, connection, line):
            self.cell.set("standard_digital_out[0]", True)
            self.cell.watch("standard_digital_in[1]", lambda level: connection.send_line(f"in {level}"))

    async def test():
        world = World(devices=[Button(), Wire(when="standard_digital_out[0]", then="standard_digital_in[1]")])
        async with serving(world) as ((port,), _), client(port) as (reader, writer):
            writer.write(b"press\n")
            assert await reader.readline() == b"in True\n"

    run(test)


def test_a_device_that_fails_is_disconnected_and_the_others_go_on():
    class Broken(Camera):
        port = 5001

        def line_received(self, connection, line):
            raise ValueError("oops")

    async def test():
        async with serving(World(devices=[Camera(), Broken()])) as ((good, bad), said):
            async with client(bad) as (reader, writer):
                writer.write(b"x\n")
                assert await reader.read() == b""
            async with client(good) as (reader, writer):
                writer.write(b"x\n")
                assert await reader.readline() == b"<x>\n"
            ((text, is_problem),) = said
            assert "device Broken: ValueError: oops; the device is disconnected" in text and is_problem

    run(test)


def test_a_port_that_cannot_be_had_is_said():
    async def test():
        async with serving(World(devices=[Camera()])) as ((port,), _):
            server = DeviceServer(World(devices=[Camera()]), "127.0.0.1", {5000: int(port)}, {}, print)
            with pytest.raises(UsageError, match=rf"port {port} at 127\.0\.0\.1: .*another one: --port 5000=NUMBER"):
                await server.open()

    run(test)
