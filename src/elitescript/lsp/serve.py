"""Serves one client, on standard input and output or on a TCP port of this computer."""

from __future__ import annotations

import asyncio
import logging
import os
import sys
import threading
from collections.abc import Callable
from typing import Any, Final

from elitescript.assist.diagnostics import diagnostics
from elitescript.assist.document import Document
from elitescript.environment.collecting import Collector
from elitescript.lsp.frames import Frames
from elitescript.lsp.processes import is_alive
from elitescript.lsp.server import Server
from elitescript.protocol.browsers import FirstBytes

HOST: Final = "127.0.0.1"
READ_BYTES: Final = 1 << 16
ALIVE_EVERY_S: Final = 3.0
"""Time between two looks whether the process of the editor is still there, s."""

SWITCH_S: Final = 0.0005
"""Time for which a thread holds the interpreter while another one waits for it, s."""

_FIRST: Final = "def p():\n  movej([0, -1.57, 0, -1.57, 0, 0], v=1.0)\nend\n"


class _Output:
    """Writes messages to a descriptor."""

    __slots__ = ("_descriptor", "_failed")

    def __init__(self, descriptor: int, failed: Callable[[], None]) -> None:
        self._descriptor = descriptor
        self._failed = failed

    def write(self, data: bytes) -> None:
        left = memoryview(data)
        try:
            while left:
                left = left[os.write(self._descriptor, left) :]
        except OSError:
            # The client is gone.
            self._failed()


def serve_stdio() -> int:
    """Serve the client on standard input and output until it ends; return the exit code.

    Standard output belongs to the protocol: what else is printed goes to standard error.
    """
    output = os.dup(1)
    os.dup2(2, 1)

    async def serve() -> int:
        loop = asyncio.get_running_loop()
        ended: asyncio.Future[int] = loop.create_future()
        end = _end_once(ended)
        server = _server(end, _Output(output, lambda: end(1)))
        frames = Frames()
        collector = Collector()

        def take(data: bytes) -> None:
            _feed(server, collector, frames, data)
            if not data:
                end(0 if server.connection.is_shut_down else 1)

        def read() -> None:
            # `sys.stdin` has a lock, which a thread that reads would hold when the process ends.
            data = b"-"
            while data:
                try:
                    data = os.read(0, READ_BYTES)
                except OSError:
                    data = b""
                try:
                    loop.call_soon_threadsafe(take, data)
                except RuntimeError:
                    return

        threading.Thread(target=read, name="input", daemon=True).start()
        return await _until(ended, server)

    return asyncio.run(serve())


def serve_tcp(port: int) -> int:
    """Serve the first client of a TCP port until it ends; return the exit code. Further ones are refused.

    Web browsers are hung up on. A line `ready on 127.0.0.1:PORT` says that the port is open; 0 is any free one.
    """

    async def serve() -> int:
        loop = asyncio.get_running_loop()
        ended: asyncio.Future[int] = loop.create_future()
        end = _end_once(ended)
        server = _server(end, None)
        collector = Collector()

        async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            if server.protocol.writer is not None:
                writer.close()
                return
            try:
                data = await _first_of(reader)
                if not data or server.protocol.writer is not None:
                    writer.close()
                    return
                server.protocol.set_writer(writer)
                frames = Frames()
                while data:
                    _feed(server, collector, frames, data)
                    data = await reader.read(READ_BYTES)
            except ConnectionError:
                if server.protocol.writer is not writer:
                    return
            end(0 if server.connection.is_shut_down else 1)

        listener = await asyncio.start_server(connected, HOST, port)
        try:
            print(f"ready on {HOST}:{listener.sockets[0].getsockname()[1]}", flush=True)
            code = await _until(ended, server)
            if isinstance(server.protocol.writer, asyncio.StreamWriter):
                server.protocol.writer.close()
            return code
        finally:
            listener.close()

    return asyncio.run(serve())


async def _first_of(reader: asyncio.StreamReader) -> bytes:
    """Return the first bytes of a client; none of a web browser: a page must not speak to the server, nor end it."""
    first, data = FirstBytes(), b""
    while not first.is_decided and (more := await reader.read(READ_BYTES)):
        first.feed(more)
        data += more
    return b"" if first.found else data


def _server(end: Callable[[int], None], output: Any) -> Server:
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="elitescript lsp: %(levelname)s: %(message)s")
    server = Server()
    server.connection.ended = end
    if output is not None:
        server.protocol.set_writer(output)
    # The rules and the catalogue load now, and not while the first text waits for its findings.
    diagnostics(Document("first.script", _FIRST))
    # The thread of findings gives way to an answer soon: each message takes several turns.
    sys.setswitchinterval(SWITCH_S)
    return server


def _feed(server: Server, collector: Collector, frames: Frames, data: bytes) -> None:
    collector.message_came()
    for message in frames.feed(data):
        server.connection.receive(message)


def _end_once(ended: asyncio.Future[int]) -> Callable[[int], None]:
    def end(code: int) -> None:
        if not ended.done():
            ended.set_result(code)

    return end


async def _until(ended: asyncio.Future[int], server: Server) -> int:
    """Return the exit code when the client has ended, or its process is gone."""
    try:
        while True:
            done, _ = await asyncio.wait([ended], timeout=ALIVE_EVERY_S)
            if done:
                return ended.result()
            if server.process_id is not None and not is_alive(server.process_id):
                return 1
    finally:
        server.close()
