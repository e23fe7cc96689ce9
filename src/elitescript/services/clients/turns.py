"""Turns of a client whose requests are carried out by tasks: the time of its tasks is charged to its share.

A connection of `protocol` works while it is called, so its time is measured there (`tcp`). Requests of `ctl` and of SSH
clients are carried out by tasks of the event loop, which would go on as long as requests are there. `Turns` measures
every step of such a task, and lets it begin its next request only when the client's share of the tick allows that, and
when the client takes what it was answered before.
"""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable, Coroutine, Generator
from typing import Any, Final, TypeVar

from elitescript.services.clients.shares import LIGHT_SHARES, SHARE_NS, Shares

Result = TypeVar("Result")


def _never() -> bool:
    return False


class Turns:
    """Counts what the tasks of one client cost, and lets them wait.

    Args:
        shares: of the robot.
        make_due: lets the next tick run, which is when those that wait go on.
        is_held: whether no request may begin because answers wait to be taken.

    Attributes:
        expected_ns: what the next request will cost, see `shares.Waiting`.
        is_light: whether the client sends little at once: it waits for an answer before it asks again, and may take
            more of a tick in which there is time.
    """

    __slots__ = (
        "_is_held",
        "_is_placed",
        "_make_due",
        "_own_ns",
        "_shares",
        "_since_ns",
        "_steps",
        "_tick",
        "_waiters",
        "expected_ns",
        "is_light",
    )

    def __init__(self, shares: Shares, make_due: Callable[[], object], is_held: Callable[[], bool] = _never) -> None:
        self._shares = shares
        self._make_due = make_due
        self._is_held = is_held
        self._waiters: deque[asyncio.Future[None]] = deque()
        self._is_placed = False
        self._own_ns = 0
        self._tick = shares.tick
        """That `_own_ns` is of."""
        self._since_ns = 0
        """Of the thread's processor time, up to which the present step is charged."""
        self._steps = 0
        self.is_light = False
        # Tasks that were held up take all that they get.
        self.expected_ns = SHARE_NS

    @property
    def steps(self) -> int:
        """Number of steps of tasks so far."""
        return self._steps

    @property
    def is_waiting(self) -> bool:
        """Whether a request waits."""
        return bool(self._waiters)

    @property
    def is_used_up(self) -> bool:
        """Whether the client has had its share of this tick, or the tick has no time left for clients."""
        return self._shares.is_used_up(self._own() // (LIGHT_SHARES if self.is_light else 1))

    def spend(self, spent_ns: int) -> None:
        """Count time that is charged to the robot's tick elsewhere as the client's."""
        self._own_ns = self._own() + spent_ns

    async def next(self) -> None:
        """Return when the client may begin a request; to be awaited in a task of `measured`."""
        self.settle()
        if not (self._is_held() or self.is_used_up):
            if not self._waiters:
                return
            self._wake_first()
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiters.append(waiter)
        self._place()
        await waiter

    def go_on(self) -> None:
        """Let the task that has waited longest begin a request; it lets the next one do so if there is time."""
        self._is_placed = False
        if not self._is_held():
            self._wake_first()
        if self._waiters:
            self._place()

    def _wake_first(self) -> None:
        while self._waiters:
            waiter = self._waiters.popleft()
            if not waiter.done():
                waiter.set_result(None)
                return

    def measured(self, work: Coroutine[Any, Any, Result]) -> Coroutine[Any, Any, Result]:
        """Return a coroutine that does the work and charges each of its steps."""
        return _awaited(_Measured(work, self))

    def begin_step(self) -> None:
        """Begin to count."""
        self._since_ns = time.thread_time_ns()
        self._steps += 1

    def settle(self) -> None:
        """Charge what the present step has cost so far."""
        now_ns = time.thread_time_ns()
        spent_ns, self._since_ns = now_ns - self._since_ns, now_ns
        self._own_ns = self._own() + spent_ns
        self._shares.charge(spent_ns)

    def _own(self) -> int:
        if self._tick != self._shares.tick:
            self._tick, self._own_ns = self._shares.tick, 0
        return self._own_ns

    def _place(self) -> None:
        if not self._is_placed:
            self._is_placed = True
            self._shares.wait(self, is_light=False)
            self._make_due()


class _Measured:
    """Awaits a coroutine step by step."""

    __slots__ = ("_turns", "_work")

    def __init__(self, work: Coroutine[Any, Any, Any], turns: Turns) -> None:
        self._work: Final = work
        self._turns: Final = turns

    def __del__(self) -> None:
        # Work of a task that was cancelled before its first step.
        self._work.close()

    def __await__(self) -> Generator[Any, Any, Any]:
        work, turns = self._work, self._turns
        error: BaseException | None = None
        while True:
            turns.begin_step()
            try:
                awaited = work.send(None) if error is None else work.throw(error)
            except StopIteration as end:
                return end.value
            finally:
                turns.settle()
            error = None
            try:
                yield awaited
            except BaseException as thrown:
                error = thrown


async def _awaited(work: Awaitable[Result]) -> Result:
    return await work
