"""The process that debugs: requests as lines of JSON on standard input, responses and events on standard output.

It is started by `dap.worker_process`: `python -P -m elitescript.dap.worker DESCRIPTOR`, with a pipe whose end is the end
of its parent. Calls of programs must not reach standard output, so the messages have a descriptor of their own.
"""

from __future__ import annotations

import faulthandler
import os
import sys
from collections import deque
from typing import Final

from elitescript.codec.json_text import from_text, to_text
from elitescript.dap.adapter import Adapter
from elitescript.dap.messages import Message
from elitescript.environment.process import limit_memory

MEMORY: Final = 4 << 30
"""Bytes of memory that a debugged program may have, with its snapshots each: as `elitescript run`."""


class Incoming:
    """Reads requests from a descriptor, and says without waiting whether there are some.

    Args:
        descriptor: where to read.
    """

    __slots__ = ("_descriptor", "_messages", "_rest", "_waits")

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._messages: deque[Message] = deque()
        self._rest = b""
        self._waits = _waiting_data(descriptor)

    def next(self) -> Message | None:
        """Wait for a request; None at the end of the input."""
        while not self._messages:
            if not self._read():
                return None
        return self._messages.popleft()

    def arrived(self) -> Message | None:
        """Return a request if one has arrived. The end of the input ends the process."""
        if not self._messages and self._waits() and not self._read():
            os._exit(0)
        return self._messages.popleft() if self._messages else None

    def _read(self) -> bool:
        data = os.read(self._descriptor, 1 << 16)
        *lines, self._rest = (self._rest + data).split(b"\n")
        self._messages.extend(from_text(line) for line in lines)
        return bool(data)


def _waiting_data(descriptor: int):  # type: ignore[no-untyped-def]
    """Return a function that says whether a descriptor can be read without waiting."""
    import select

    if hasattr(select, "poll"):
        poll = select.poll()
        poll.register(descriptor, select.POLLIN | select.POLLHUP)
        return lambda: bool(poll.poll(0))
    import msvcrt
    from ctypes import byref, c_ulong, windll

    handle, count = msvcrt.get_osfhandle(descriptor), c_ulong()
    peek = windll.kernel32.PeekNamedPipe
    return lambda: not peek(handle, None, 0, None, byref(count), None) or count.value > 0


def _end_with_parent(descriptor: int) -> None:
    """Let the system end this process and its copies when the parent's end of a pipe closes, where it can."""
    try:
        import fcntl
        from signal import SIG_DFL, SIGIO, signal
    except ImportError:
        return
    signal(SIGIO, SIG_DFL)
    fcntl.fcntl(descriptor, fcntl.F_SETOWN, -os.getpgrp())
    fcntl.fcntl(descriptor, fcntl.F_SETFL, fcntl.fcntl(descriptor, fcntl.F_GETFL) | os.O_ASYNC)


def main() -> None:
    """Serve requests until the input ends."""
    faulthandler.enable(all_threads=False)
    if len(sys.argv) > 1 and os.name == "posix":
        _end_with_parent(int(sys.argv[1]))
    limit_memory(MEMORY)
    requests, responses = os.dup(0), os.dup(1)
    # What the program reads and prints is not the protocol.
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)

    def send(message: Message) -> None:
        data = to_text(message).encode("ascii") + b"\n"
        while data:
            data = data[os.write(responses, data) :]

    incoming = Incoming(requests)
    adapter = Adapter(send, incoming.arrived)
    while (message := incoming.next()) is not None:
        adapter.handle(message)
    # Nothing is left to do, and taking a deep stack of script threads apart takes time.
    os._exit(0)


if __name__ == "__main__":
    main()
