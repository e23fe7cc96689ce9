"""A served robot with an SSH port: its log, and its serial line through a bridge."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.messages.events import TextMessage
from elitescript.messages.inputs import ChannelData
from elitescript.messages.line import LineSettings
from elitescript.messages.outputs import OpenLine
from elitescript.services.clients.binding import bind
from elitescript.services.port_numbers import NAMES
from tests.protocol.rtsi_client import input_recipe, message, output_recipe
from tests.services.served import Scene, run
from tests.services.test_serial_bridges import free_port

asyncssh = pytest.importorskip("asyncssh")

LOG = "/opt/elite/data/log/log_history.csv"
START = (
    "bash -lc 'socat tcp-l:{},reuseaddr,fork,nodelay file:/dev/ttyTCI0,nonblock,raw,waitlock=/var/run/tty0 "
    "> /dev/null 2>&1 &'"
)


@contextlib.asynccontextmanager
async def serving_ssh(**options: object) -> AsyncIterator[tuple[Scene, object]]:
    scene = Scene(ssh_password="secret", **options)
    await scene.server.boot()
    scene.server.bind("127.0.0.1", dict.fromkeys((*NAMES, "ssh"), 0))
    await scene.server.open()
    try:
        async with asyncssh.connect(
            "127.0.0.1",
            scene.server.ports["ssh"],
            username="root",
            password="secret",
            known_hosts=None,
            client_keys=None,
            config=None,
            agent_path=None,
        ) as client:
            yield scene, client
    finally:
        for peer in scene.peers:
            await peer.close()
        await scene.server.close()


def test_the_log_has_the_messages_of_the_robot() -> None:
    async def test() -> None:
        async with serving_ssh() as (scene, client):
            scene.robot.say(events=(TextMessage(1, "hello", "main", 1),))
            await scene.ticks(2)
            async with client.start_sftp_client() as sftp, sftp.open(LOG) as file:
                rows = (await file.read()).splitlines()
            assert rows[0] == "time,level,source,code,text"
            assert rows[1].endswith(",info,script,,hello")

    run(test())


def test_a_bridge_carries_the_line_that_a_program_has_enabled() -> None:
    async def test() -> None:
        async def echo(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            while data := await reader.read(100):
                writer.write(data.upper())
            writer.close()

        device = await asyncio.start_server(echo, "127.0.0.1", 0)
        address = f"socket://127.0.0.1:{device.sockets[0].getsockname()[1]}"
        async with device, serving_ssh(lines={"tool": address}) as (scene, client):
            scene.robot.say(requests=(OpenLine(1, "tool", LineSettings(115200, 0, 1, 8)),))
            await scene.until(lambda: any(getattr(item, "is_open", False) for _, item in scene.robot.heard))
            port = free_port()
            assert (await client.run(START.format(port))).exit_status == 0
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(b"hello world")
            assert await reader.readexactly(11) == b"HELLO WORLD"
            writer.close()
            assert not [item for _, item in scene.robot.heard if isinstance(item, ChannelData)]
            assert scene.notes("ssh") == []

    run(test())


def test_a_bridge_to_nothing_connects_and_the_log_says_so_once() -> None:
    async def test() -> None:
        async with serving_ssh() as (scene, client):
            scene.robot.say(requests=(OpenLine(1, "tool", LineSettings(115200, 0, 1, 8)),))
            await scene.ticks(3)
            port = free_port()
            await client.run(START.format(port))
            for _ in range(2):
                _, writer = await asyncio.open_connection("127.0.0.1", port)
                writer.write(b"hello")
                await scene.until(lambda: scene.notes("ssh"))
                writer.close()
            (note,) = scene.notes("ssh")
            assert note.text == "a client bridges the serial port tool, and its bytes go nowhere: nothing is connected"

    run(test())


def test_bridges_end_with_the_server() -> None:
    async def test() -> None:
        async with serving_ssh() as (_, client):
            port = free_port()
            await client.run(START.format(port))
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
        with contextlib.suppress(ConnectionError):
            assert await reader.read() == b""
        writer.close()
        with pytest.raises(ConnectionRefusedError):
            await asyncio.open_connection("127.0.0.1", port)

    run(test())


def test_a_port_that_is_taken_leaves_nothing_open() -> None:
    async def test() -> None:
        scene = Scene(ssh_password="secret")
        await scene.server.boot()
        bound = bind("127.0.0.1", 0)
        taken = bound.getsockname()[1]
        with pytest.raises(UsageError, match=rf"port {taken} \(ssh\) is in use"):
            scene.server.bind("127.0.0.1", dict.fromkeys(NAMES, 0) | {"ssh": taken})
        bound.close()
        assert scene.server.ports == {}
        await scene.server.close()

    run(test())


def test_without_a_password_there_is_no_ssh_port() -> None:
    async def test() -> None:
        scene = Scene()
        await scene.server.boot()
        scene.server.bind("127.0.0.1", dict.fromkeys((*NAMES, "ssh"), 0))
        assert "ssh" not in scene.server.ports
        assert scene.server.host_key == ""
        await scene.server.close()

    run(test())


def login(scene: Scene) -> Any:
    return asyncssh.connect(
        "127.0.0.1",
        scene.server.ports["ssh"],
        username="root",
        password="secret",
        known_hosts=None,
        client_keys=None,
        config=None,
        agent_path=None,
    )


def test_robots_of_one_process_have_files_and_shares_of_their_own() -> None:
    async def test() -> None:
        async with serving_ssh() as (_, client), serving_ssh() as (_, other):
            async with client.start_sftp_client() as sftp, sftp.open("/tmp/mine", "w") as file:
                await file.write("x")
            async with other.start_sftp_client() as sftp:
                assert await sftp.listdir("/tmp") == [".", ".."]

    run(test())


def test_it_answers_while_time_stands_still_in_lockstep() -> None:
    async def test() -> None:
        async with serving_ssh(is_lockstep=True, lockstep_timeout_s=1e9) as (scene, client):
            rtsi = await scene.connect("rtsi")
            rtsi.send(output_recipe(250, ["timestamp"]) + input_recipe(["input_int_register0"]) + message("S"))
            await rtsi.rtsi("U")
            rtsi.send(message("U", b"\1" + bytes(4)))
            await scene.stands()
            assert (await client.run("printenv PATH")).exit_status == 0
            async with client.start_sftp_client() as sftp:
                assert "log" in await sftp.listdir("/opt/elite/data")
            async with login(scene) as other:
                assert (await other.run("printenv PATH")).exit_status == 0

    run(test())
