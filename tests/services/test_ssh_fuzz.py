"""SFTP, SCP and SSH sessions of clients that send what comes to mind: the port goes on, and nothing of them is left."""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
import struct
import sys
from typing import Any

import pytest

from elitescript.services.log import LogLine
from tests.services import served
from tests.services.test_ssh_server import INIT, OPEN, Host, RawSftp, asyncssh, hosted, packet, text

pytestmark = pytest.mark.slow

SESSIONS = int(os.environ.get("SSH_FUZZ_SESSIONS", "400"))
SEED = int(os.environ.get("SSH_FUZZ_SEED", "1"))
LIMIT_S = 900.0

PATHS = (
    b"/tmp/x", b"/tmp", b"/", b"", b"/tmp/" + b"n" * 255, b"/tmp/" + b"n" * 256, b"/a" * 40, b"/tmp/\0", b"\xff\xfe",
    b"/tmp/d", b"/tmp/d/e", b"/opt/elite/data/log/log_history.csv", b"/etc/passwd", b"/tmp/../etc", b"/tmp/x/y", b"~",
)  # fmt: skip
EXTENDED = (
    b"posix-rename@openssh.com", b"hardlink@openssh.com", b"fsync@openssh.com", b"lsetstat@openssh.com", b"copy-data",
    b"limits@openssh.com", b"ranges@asyncssh.com", b"statvfs@openssh.com", b"fstatvfs@openssh.com", b"nothing",
)  # fmt: skip
NUMBERS = (0, 1, 2, 255, 2**15, 2**24, 2**31, 2**32 - 1)
LONG_NUMBERS = (0, 1, 2**16, 2**24, 2**25, 2**40, 2**63, 2**64 - 1)
COMMANDS = (
    "scp -t /tmp",
    "scp -f /tmp/x",
    "scp -rpt /",
    "scp",
    "scp -f " + "/x" * 5000,
    "printenv PATH",
    "",
    "\0",
    "é" * 900,
)


def attributes(chance: random.Random) -> bytes:
    flags = chance.choice((0, 1, 2, 4, 8, 15, 2**31, 2**32 - 1))
    body = struct.pack(">I", flags)
    if flags & 1:
        body += struct.pack(">Q", chance.choice(LONG_NUMBERS))
    return body + chance.randbytes(chance.choice((0, 4, 8)))


def request(chance: random.Random) -> bytes:
    """A request of SFTP that makes sense, or nearly."""
    path, number = text(chance.choice(PATHS)), struct.pack(">I", chance.choice(NUMBERS))
    handle = text(chance.choice((bytes(4), b"\0\0\0\1", b"\0\0\0\2", b"", b"none")))
    offset = struct.pack(">Q", chance.choice(LONG_NUMBERS))
    data = text(chance.randbytes(chance.choice((0, 1, 100, 5000))))
    bodies = {
        3: path + struct.pack(">I", chance.choice((1, 2, 3, 10, 26, 42, 2**32 - 1))) + attributes(chance),
        4: handle, 5: handle + offset + number, 6: handle + offset + data, 7: path, 8: handle,
        9: path + attributes(chance), 10: handle + attributes(chance), 11: path, 12: handle, 13: path,
        14: path + attributes(chance), 15: path, 16: path, 17: path, 18: path + text(chance.choice(PATHS)), 19: path,
        20: path + text(chance.choice(PATHS)),
        200: text(chance.choice(EXTENDED)) + chance.choice((handle, path)) + offset + offset + handle + offset,
    }  # fmt: skip
    kind = chance.choice(tuple(bodies))
    made = packet(kind, bodies[kind], chance.choice(NUMBERS))
    if chance.random() < 0.2:
        broken = bytearray(made)
        broken[chance.randrange(len(broken))] = chance.randrange(256)
        made = bytes(broken)
    return made[: chance.randrange(len(made))] if chance.random() < 0.05 else made


async def sftp(client: Any, chance: random.Random) -> None:
    raw = await RawSftp.begin(client)
    raw.channel.write(INIT + OPEN)
    for _ in range(chance.randrange(60)):
        raw.channel.write(request(chance))
        if chance.random() < 0.1:
            await asyncio.sleep(0.005)
    await asyncio.sleep(0.02)
    if chance.random() < 0.7:
        raw.channel.close()


async def command(client: Any, chance: random.Random) -> None:
    process = await client.create_process(chance.choice(COMMANDS), encoding=None)
    process.stdin.write(
        chance.choice((b"", b"\0", b"C0644 5 x\nhello\0", b"C0644 99999999999999 y\n", b"D0755 0 d\n", b"E\n"))
    )
    process.stdin.write(chance.randbytes(chance.choice((0, 10, 3000))))
    await asyncio.sleep(0.02)
    process.close()


async def packets(client: Any, chance: random.Random) -> None:
    """Packets of the connection itself, of every number."""
    for _ in range(chance.randrange(20)):
        client.send_packet(
            chance.choice((2, 3, 4, 80, 90, 91, 93, 94, 96, 97, 98, 99, 100, 192, 255)),
            chance.randbytes(chance.choice((0, 4, 30))),
        )
    await asyncio.sleep(0.01)


async def bytes_alone(host: Host, chance: random.Random) -> None:
    """A client that never gets to log in."""
    _, writer = await asyncio.open_connection("127.0.0.1", host.number)
    writer.write(
        chance.choice((b"", b"SSH-2.0-x\r\n", b"SSH-9.9-x\r\n", b"GET / HTTP/1.1\r\n"))
        + chance.randbytes(chance.randrange(3000))
    )
    await asyncio.sleep(0.02)
    writer.close()


def test_the_port_outlives_fuzzed_sessions_and_nothing_of_them_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(served, "LIMIT_S", LIMIT_S)
    chance = random.Random(SEED)

    async def scene() -> None:
        async with hosted() as host:
            grown = 0
            for number in range(SESSIONS):
                if chance.random() < 0.1:
                    await bytes_alone(host, chance)
                    continue
                client = await host.connect()
                with contextlib.suppress(asyncssh.Error, OSError):
                    await chance.choice((sftp, sftp, sftp, command, packets))(client, chance)
                    if chance.random() < 0.5:
                        await sftp(client, chance)
                (client.abort if chance.random() < 0.5 else client.close)()
                with contextlib.suppress(asyncssh.Error, OSError):
                    await client.wait_closed()
                if number == SESSIONS // 4:
                    grown = sys.getallocatedblocks()
            await host.scene.until(lambda: not host.desk.listener.clients)
            await host.scene.ticks(5)
            assert host.files._open == 0
            assert not host.port._clients
            assert len(host.scene.server.shares._heavy) + len(host.scene.server.shares._light) == 0
            said = [note for note in host.scene.said if isinstance(note, LogLine)]
            assert not [note.text for note in said if note.kind == "bug"]
            # Files that clients have made stay; the log of the test is dropped.
            host.scene.said.clear()
            for name in host.files.names("/tmp"):
                with contextlib.suppress(OSError):
                    host.files.remove(f"/tmp/{name}")
            assert sys.getallocatedblocks() < 1.2 * grown
            async with host.connect() as client:
                assert (await client.run("printenv PATH")).exit_status == 0

    served.run(scene())
