"""The process that debugs: requests as lines of JSON on standard input, responses and events on standard output.

`dap.worker_process` starts it with the descriptor of a pipe whose end is the end of its parent. Calls of programs must
not reach standard output, so the messages have a descriptor of their own.
"""

from __future__ import annotations

import faulthandler
import os
import select
import signal
import sys
from _thread import interrupt_main
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from queue import SimpleQueue
from threading import Thread
from typing import Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.dap.adapter import Adapter
from elitescript.dap.messages import Message
from elitescript.dap.requests.catalogue import HANDLERS
from elitescript.environment.process import end_with_parent, limit_memory

MEMORY: Final = 4 << 30
"""Bytes of memory that a debugged program may have, with its snapshots each: as `elitescript run`."""

READ_BYTES: Final = 1 << 16


class Incoming:
    """Reads requests from a descriptor; implements `adapter.Requests`.

    Args:
        descriptor: where to read.
    """

    __slots__ = ("_calls", "_descriptor", "_messages", "_rest", "_wake", "_woken")

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._messages: deque[Message] = deque()
        self._rest = b""
        self._calls: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._woken, self._wake = os.pipe()

    def begin(self, interrupt: Callable[[], None]) -> None:
        """Have a function called in this thread when requests may have arrived: the parent sends a signal with each."""
        signal.signal(signal.SIGURG, lambda *_: interrupt())

    def next(self) -> Message:
        """Return the next request when it has arrived.

        Raises:
            EOFError: there will be none.
        """
        while not self._messages:
            readable, _, _ = select.select([self._descriptor, self._woken], [], [])
            if self._woken in readable:
                os.read(self._woken, 1)
                self._calls.get()()
            if self._descriptor in readable:
                data = os.read(self._descriptor, READ_BYTES)
                if not data:
                    raise EOFError
                *lines, self._rest = (self._rest + data).split(b"\n")
                self._messages.extend(from_text(line) for line in lines)
        return self._messages.popleft()

    def post(self, call: Callable[[], None]) -> None:
        """Have something called in the thread of `next`, while it waits. May be called from any thread."""
        self._calls.put(call)
        os.write(self._wake, b"!")

    def has_next(self) -> bool:
        """Return whether `next` returns at once. A signal may call it in the middle of itself, which `poll` refuses."""
        return bool(self._messages or select.select([self._descriptor], [], [], 0)[0])


class ThreadedIncoming:
    """Does the same in a thread of its own, for systems where pipes cannot be polled; there is no fork there."""

    __slots__ = ("_descriptor", "_messages")

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._messages: SimpleQueue[Message | Callable[[], None] | None] = SimpleQueue()

    def begin(self, interrupt: Callable[[], None]) -> None:
        """Have a function called in the main thread when requests have arrived."""
        signal.signal(signal.SIGINT, lambda *_: interrupt())
        Thread(target=self._read, daemon=True).start()

    def next(self) -> Message:
        """Return the next request when it has arrived.

        Raises:
            EOFError: there will be none.
        """
        while callable(message := self._messages.get()):
            message()
        if message is None:
            raise EOFError
        return message

    def post(self, call: Callable[[], None]) -> None:
        """Have something called in the thread of `next`, while it waits. May be called from any thread."""
        self._messages.put(call)

    def has_next(self) -> bool:
        """Return whether `next` returns at once."""
        return not self._messages.empty()

    def _read(self) -> None:
        rest = b""
        while data := os.read(self._descriptor, READ_BYTES):
            *lines, rest = (rest + data).split(b"\n")
            for line in lines:
                self._messages.put(from_text(line))
                interrupt_main()
        self._messages.put(None)
        interrupt_main()


def main() -> None:
    """Serve requests until the input ends."""
    faulthandler.enable(all_threads=False)
    end_with_parent(int(sys.argv[1]))
    limit_memory(MEMORY)
    requests, responses = os.dup(0), os.dup(1)
    # What the program reads and prints is not the protocol.
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)

    if hasattr(os, "register_at_fork"):
        # Engines in processes of their own are not to keep the pipes open: the end of this process is seen by them.
        pipes = [requests, responses]

        def forget() -> None:
            while pipes:
                os.close(pipes.pop())

        os.register_at_fork(after_in_child=forget)

    def send(message: Message) -> None:
        data = to_text(message).encode("ascii") + b"\n"
        while data:
            data = data[os.write(responses, data) :]

    incoming = Incoming(requests) if os.name == "posix" else ThreadedIncoming(requests)
    adapter = Adapter(send, incoming, HANDLERS, forks=os.name == "posix")

    def interrupt() -> None:
        try:
            adapter.interrupt()
        except EOFError:
            os._exit(0)

    incoming.begin(interrupt)
    with suppress(EOFError):
        while True:
            adapter.handle(incoming.next())
    # Taking a deep stack of script threads apart takes time, and nothing is left to do.
    os._exit(0)


if __name__ == "__main__":
    main()
