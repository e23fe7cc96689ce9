"""Turns of clients whose requests are carried out by tasks, with a clock that counts what the test says."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from types import SimpleNamespace

import pytest

from elitescript.services.clients import turns as turns_module
from elitescript.services.clients.shares import READ_BUDGET_NS, SHARE_NS, Shares
from elitescript.services.clients.turns import Turns
from tests.services.served import run


class Clock:
    """Processor time, as the test counts it."""

    def __init__(self) -> None:
        self.ns = 0

    def thread_time_ns(self) -> int:
        return self.ns


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(turns_module, "time", SimpleNamespace(thread_time_ns=clock.thread_time_ns))
    return clock


class Flood:
    """A client that asks without end; each request takes as much time as the clock is advanced."""

    def __init__(self, clock: Clock, shares: Shares, ns: int, is_held: Callable[[], bool] = lambda: False) -> None:
        self.clock, self.ns, self.done = clock, ns, 0
        self.turns = Turns(shares, lambda: None, is_held)
        self.task = asyncio.ensure_future(self.turns.measured(self.work()))

    async def work(self) -> None:
        while True:
            await self.turns.next()
            self.clock.ns += self.ns
            self.done += 1


async def settle() -> None:
    """Let every task go as far as it can."""
    for _ in range(20):
        await asyncio.sleep(0)


def test_a_client_has_its_share_of_each_tick(clock: Clock) -> None:
    async def scene() -> None:
        shares = Shares()
        flood = Flood(clock, shares, 100_000)
        await settle()
        first = flood.done
        assert first == SHARE_NS // 100_000 + 1
        for tick in range(1, 10):
            shares.begin_tick()
            await settle()
            assert flood.done == first * (tick + 1)
        flood.task.cancel()

    run(scene())


def test_many_clients_take_no_more_than_the_tick_has_and_each_comes(clock: Clock) -> None:
    async def scene() -> None:
        shares = Shares()
        floods = [Flood(clock, shares, 100_000) for _ in range(20)]
        await settle()
        begin = clock.ns
        for _ in range(100):
            shares.begin_tick()
            await settle()
        assert (clock.ns - begin) / 100 <= READ_BUDGET_NS + 100_000
        done = [flood.done for flood in floods]
        assert min(done) >= 0.2 * max(done)
        for flood in floods:
            flood.task.cancel()

    run(scene())


def test_tasks_of_one_client_share_its_turns(clock: Clock) -> None:
    async def scene() -> None:
        shares = Shares()
        flood = Flood(clock, shares, 50_000)
        other = Flood(clock, shares, 50_000)
        other.turns = flood.turns
        other.task.cancel()
        other.task = asyncio.ensure_future(flood.turns.measured(other.work()))
        for _ in range(10):
            shares.begin_tick()
            await settle()
        assert min(flood.done, other.done) > 10
        assert clock.ns <= 11 * (SHARE_NS + 100_000)
        for task in (flood.task, other.task):
            task.cancel()

    run(scene())


def test_nothing_begins_while_answers_wait_to_be_taken(clock: Clock) -> None:
    async def scene() -> None:
        shares, is_held = Shares(), True
        flood = Flood(clock, shares, 100_000, lambda: is_held)
        for _ in range(5):
            shares.begin_tick()
            await settle()
        assert flood.done == 0
        assert not shares.is_settled
        is_held = False
        shares.begin_tick()
        await settle()
        assert flood.done > 0
        flood.task.cancel()

    run(scene())


def test_steps_are_charged_and_results_and_errors_pass(clock: Clock) -> None:
    async def scene() -> None:
        shares = Shares()
        turns = Turns(shares, lambda: None)
        waiter = asyncio.get_running_loop().create_future()

        async def work() -> str:
            clock.ns += 5
            try:
                await waiter
            except ZeroDivisionError:
                clock.ns += 7
                return "caught"
            return ""

        task = asyncio.ensure_future(turns.measured(work()))
        await asyncio.sleep(0)
        assert shares.spent_ns == 5
        clock.ns += 1000
        waiter.set_exception(ZeroDivisionError())
        assert await task == "caught"
        assert shares.spent_ns == 12
        cancelled = asyncio.ensure_future(turns.measured(asyncio.sleep(100)))
        await asyncio.sleep(0)
        cancelled.cancel()
        with pytest.raises(asyncio.CancelledError):
            await cancelled

    run(scene())
