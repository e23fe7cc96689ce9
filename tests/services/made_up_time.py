"""A served robot by a wall clock that the test moves; clients without sockets, each byte with its time."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from typing import Any

import pytest

from elitescript.services.clients.tcp import Client
from elitescript.services.time import cycle
from tests.services.served import Scene, serving


class Timer:
    """Wakes when the test has moved its clock there."""

    is_exact = True

    def __init__(self, wall: WallClock) -> None:
        self.due_ns = 0
        self.waiter: asyncio.Future[None] | None = None
        wall.timers.append(self)

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        self.due_ns, self.waiter = due_ns, waiter

    def close(self) -> None:
        self.waiter = None


class WallClock:
    """Takes the place of the clock and the timers of this computer."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.now_ns = 1_000_000_000
        self.timers: list[Timer] = []
        patch.setattr(cycle.time, "monotonic_ns", lambda: self.now_ns)
        # What reading costs depends on the computer.
        patch.setattr(cycle.time, "thread_time_ns", lambda: 0)
        patch.setattr(cycle, "best_timer", lambda: Timer(self))

    async def go_to(self, until_ns: int) -> None:
        """Move on, and let everything happen that is due."""
        await self.settle()
        while due := [timer for timer in self.timers if timer.waiter is not None and timer.due_ns <= until_ns]:
            timer = min(due, key=lambda timer: timer.due_ns)
            self.now_ns = max(self.now_ns, timer.due_ns)
            waiter, timer.waiter = timer.waiter, None
            if waiter is not None and not waiter.done():
                waiter.set_result(None)
            await self.settle()
        self.now_ns = max(self.now_ns, until_ns)

    async def settle(self) -> None:
        """Let the event loop do what is due now, until nothing is left to be done."""
        ready: Any = asyncio.get_running_loop()
        await asyncio.sleep(0)
        while ready._ready:
            await asyncio.sleep(0)


class Line:
    """A client at a port, without a socket. Stands in for the transport of the event loop."""

    def __init__(self, scene: Scene, wall: WallClock, service: str) -> None:
        self.wall = wall
        self.written: list[tuple[int, bytes]] = []
        self.is_paused = self.is_over = False
        self.unread = bytearray()
        listener = scene.server.listeners[service]
        listener._count += 1
        origin = f"{service}#{listener._count}"
        connection = listener.connect(origin)
        self.client = Client(scene.server, listener.service, connection, listener._forget, scene.said.append)
        listener.clients[origin] = self.client
        self.client.connection_made(self)
        scene.server.make_due()

    def send(self, data: bytes) -> None:
        """Send bytes; what the robot does not read now stays until it does."""
        self.unread += data
        self._read()

    def _read(self) -> None:
        while self.unread and not self.is_paused and not self.is_over:
            buffer = self.client.get_buffer(len(self.unread))
            size = min(len(buffer), len(self.unread))
            buffer[:size] = self.unread[:size]
            del self.unread[:size]
            self.client.buffer_updated(size)

    # ---------------------------------------------------------------- the transport

    def write(self, data: bytes) -> None:
        self.written.append((self.wall.now_ns, bytes(data)))

    def is_closing(self) -> bool:
        return self.is_over

    def get_write_buffer_size(self) -> int:
        return 0

    def set_write_buffer_limits(self, high: int, low: int) -> None:
        pass

    def get_extra_info(self, name: str) -> Any:
        return ("192.0.2.1", 4711) if name == "peername" else None

    def pause_reading(self) -> None:
        self.is_paused = True

    def resume_reading(self) -> None:
        self.is_paused = False
        asyncio.get_running_loop().call_soon(self._read)

    def close(self) -> None:
        if not self.is_over:
            self.is_over = True
            asyncio.get_running_loop().call_soon(self.client.connection_lost, None)

    abort = close


@contextlib.asynccontextmanager
async def timed(
    patch: pytest.MonkeyPatch, robot: Any, **options: Any
) -> AsyncIterator[tuple[Scene, WallClock, Callable[[str], Line]]]:
    """A served robot, its wall clock, and what connects a client to one of its ports."""
    wall = WallClock(patch)
    async with serving(robot, **options) as scene:
        await wall.settle()
        yield scene, wall, lambda service: Line(scene, wall, service)
