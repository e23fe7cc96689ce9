"""A program from the disk of a controller, at the SSH port of our own server."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from elitescript.errors import UsageError
from elitescript.recorder.fetching import fetch_program
from tests.recorder.controller import HOST, closed_port

asyncssh = pytest.importorskip("asyncssh")
LOG = "/opt/elite/data/log/log_history.csv"


@contextmanager
def controller() -> Iterator[tuple[int, bytes]]:
    """The port, and the line that makes its key known."""
    from tests.services.test_ssh_server import ROW, hosted

    found: list = []
    ready = threading.Event()

    async def serve() -> None:
        async with hosted() as host:
            end = asyncio.Event()
            async with host.connect() as client:
                key = client.get_server_host_key().export_public_key().decode()
            found.extend([host.number, f"[{HOST}]:{host.number} {key}".encode(), asyncio.get_running_loop(), end])
            ready.set()
            await end.wait()

    assert ROW == b"time,level,source,code,text\n"
    thread = threading.Thread(target=lambda: asyncio.run(serve()))
    thread.start()
    assert ready.wait(20.0)
    try:
        yield found[0], found[1]
    finally:
        found[2].call_soon_threadsafe(found[3].set)
        thread.join()


def test_a_file_is_read_and_what_is_not_to_be_had_is_said():
    with controller() as (port, known):
        assert fetch_program(HOST, port, "secret", LOG, known) == b"time,level,source,code,text\n"
        for password, path, hosts, text in (
            ("secret", "/away.script", known, r"/away\.script: No such file.*; name its file with --program"),
            ("guess", LOG, known, "the password of root is refused"),
            ("secret", LOG, b"", "its key is not known here"),
        ):
            with pytest.raises(UsageError, match=text):
                fetch_program(HOST, port, password, path, hosts)


def test_no_port_is_said():
    with pytest.raises(UsageError, match=f"the program cannot be fetched .SSH port {HOST}:"):
        fetch_program(HOST, closed_port(), "secret", LOG, b"")
