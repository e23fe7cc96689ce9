"""Serves debug sessions: on standard input and output, or to one TCP client after the other."""

from __future__ import annotations

import os
import socket
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from queue import Empty, Full, Queue
from threading import Thread
from typing import Final

from elitescript.dap.relay import Relay
from elitescript.dap.worker_process import WorkerProcess
from elitescript.errors import UsageError
from elitescript.protocol.browsers import FirstBytes

READ_BYTES: Final = 1 << 16
INBOX_MAX: Final = 256
"""What has arrived and is not handled yet; then its sender waits."""
LOOPBACK: Final = "127.0.0.1"

_Call = Callable[[], None]


def serve_stdio() -> None:
    """Serve one session on standard input and output; what else is printed goes to standard error."""
    sys.stdout.flush()
    out = os.dup(1)
    os.dup2(2, 1)

    def write(data: bytes) -> None:
        while data:
            data = data[os.write(out, data) :]

    serve(partial(os.read, 0, READ_BYTES), write)
    os.close(out)


def serve_tcp(port: int, announce: Callable[[str], None]) -> None:
    """Serve sessions on a port of this computer, one after the other, for ever.

    Args:
        port: its number; 0 for any free one.
        announce: called with `HOST:PORT` once clients can connect.

    Raises:
        UsageError: the port is in use, or there is none of that number.
    """
    with socket.socket() as listener:
        if os.name == "posix":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((LOOPBACK, port))
        except (OSError, OverflowError) as error:
            raise UsageError(f"port {port} of {LOOPBACK}: {error}") from None
        listener.listen(8)
        announce(f"{LOOPBACK}:{listener.getsockname()[1]}")
        while True:
            client, _ = listener.accept()
            with client:
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                serve(partial(_received, client, FirstBytes()), client.sendall)
                with suppress(OSError):
                    # Ends the thread that reads.
                    client.shutdown(socket.SHUT_RDWR)


def _received(client: socket.socket, first: FirstBytes) -> bytes:
    """Return what a client sends next; nothing, as at its end, from a web browser: pages must not start programs."""
    data = client.recv(READ_BYTES)
    return b"" if first.feed(data) else data


def serve(read: Callable[[], bytes], write: Callable[[bytes], object]) -> None:
    """Serve one session; return when the client has disconnected or is gone.

    Args:
        read: waits for bytes of the client; an empty result or OSError is the end of its input.
        write: sends bytes to it; OSError means that it is gone.
    """
    inbox: Queue[_Call] = Queue(INBOX_MAX)

    def put(call: _Call) -> None:
        while not relay.is_over:
            with suppress(Full):
                inbox.put(call, timeout=0.5)
                return

    def start() -> WorkerProcess:
        def sent(message: dict[str, object]) -> None:
            put(lambda: None if worker.is_killed else relay.worker_sent(message))

        def ended(reason: str) -> None:
            put(lambda: None if worker.is_killed else relay.worker_ended(reason))

        worker = WorkerProcess(sent, ended)
        return worker

    def read_client() -> None:
        data = b"?"
        while data and not relay.is_over:
            try:
                data = read()
            except OSError:
                data = b""
            put(partial(relay.receive, data, time.monotonic()) if data else relay.close)

    relay = Relay(write, start)
    Thread(target=read_client, daemon=True).start()
    try:
        while not relay.is_over:
            deadline_s = relay.deadline_s()
            with suppress(Empty):
                inbox.get(timeout=None if deadline_s is None else max(0.0, deadline_s - time.monotonic()))()
            relay.pass_time(time.monotonic())
    except OSError:
        # The client is gone: nobody reads what is written.
        return
    finally:
        relay.close()
