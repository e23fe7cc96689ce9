"""Reading clients past the event loop, while nothing else matters: from an answer to the next package in one go.

A turn of an event loop costs more than the rest of such an exchange. So the sockets of the clients that are waited for
are taken from the loop and read directly. The loop is watched meanwhile: as soon as it has something to do, the sockets
are to be given back and the loop is to get a turn, so nobody is held up, and what came in before an answer is read
before it counts.
"""

from __future__ import annotations

import asyncio
import select
import selectors
import sys
from typing import Final, Protocol


class WatchableLoop(asyncio.SelectorEventLoop):
    """An event loop that can be polled as a socket can.

    Args:
        selector: of its sockets.

    Attributes:
        descriptor: can be read while a socket of the loop is ready.
    """

    def __init__(self, selector: selectors.EpollSelector) -> None:
        self.descriptor = selector.fileno()
        super().__init__(selector)


def watchable_loop() -> asyncio.AbstractEventLoop:
    """Return a new event loop: a `WatchableLoop` where the system has such a thing, which is Linux."""
    if sys.platform == "linux":
        return WatchableLoop(selectors.EpollSelector())
    return asyncio.new_event_loop()


class Readable(Protocol):
    """A client that can be read past the event loop."""

    @property
    def origin(self) -> str:
        """Its name."""

    def hold(self) -> int:
        """Take its socket from the event loop; return the descriptor, or -1 if it is not to be read now."""

    def read_held(self) -> bool:
        """Read its socket once; return False if the event loop is to look at it."""

    def give_back(self) -> None:
        """Leave its socket to the event loop again."""


class DirectReading:
    """Reads clients directly, if the running event loop is a `WatchableLoop`.

    Attributes:
        is_loop_due: whether the loop is to get a turn before anything counts that was read.
    """

    __slots__ = ("_held", "_loop_descriptor", "is_loop_due")

    def __init__(self) -> None:
        loop = asyncio.get_running_loop()
        self._loop_descriptor: Final = loop.descriptor if isinstance(loop, WatchableLoop) else -1
        self._held: dict[str, tuple[Readable, int, select.poll]] = {}
        self.is_loop_due = False

    def read(self, client: Readable, wait_ms: int) -> bool:
        """Wait for what a client sends next, and read it; return False if nothing has come, neither to the loop.

        Args:
            client: stays with this object until `release`.
            wait_ms: how long to wait, ms; all but what sockets bring waits for so long.
        """
        held = self._held.get(client.origin) or self._hold(client)
        if held is None:
            return False
        _, descriptor, poll = held
        ready = poll.poll(wait_ms)
        for found, events in ready:
            # The end of a client, and what has gone wrong with it, are matters of the loop.
            if found != descriptor or events != select.POLLIN or not client.read_held():
                self.is_loop_due = True
        return bool(ready)

    def release(self) -> None:
        """Give all clients back to the event loop, which is about to get a turn."""
        self.is_loop_due = False
        for client, _, _ in self._held.values():
            client.give_back()
        self._held.clear()

    def _hold(self, client: Readable) -> tuple[Readable, int, select.poll] | None:
        if self._loop_descriptor < 0 or (descriptor := client.hold()) < 0:
            return None
        poll = select.poll()
        poll.register(descriptor, select.POLLIN)
        poll.register(self._loop_descriptor, select.POLLIN)
        held = self._held[client.origin] = (client, descriptor, poll)
        return held
