"""Ticks against the wall clock."""

from __future__ import annotations

import asyncio
import os
import socket
import sys
import time
from collections.abc import Callable

import pytest

from elitescript.services.time import cycle
from elitescript.services.time.cycle import (
    CATCH_UP_TICKS,
    LEAP_MAX_TICKS,
    OUTLET_NS,
    PERIOD_NS,
    Cycle,
    LoopTimer,
    Timer,
    TimerFdTimer,
    best_timer,
)
from tests.services.served import run


class Clock:
    """Wall time that goes on only when somebody waits, or when the test says so."""

    def __init__(self, *, is_exact: bool = True) -> None:
        self.now_ns = 1_000_000_000
        self.is_exact = is_exact

    def monotonic_ns(self) -> int:
        return self.now_ns

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        self.now_ns = max(self.now_ns, due_ns)
        waiter.set_result(None)

    def close(self) -> None:
        pass


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(cycle.time, "monotonic_ns", clock.monotonic_ns)
    return clock


def test_ticks_come_every_period(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        begin_ns = clock.now_ns
        for number in range(1, 100):
            await ticks.next()
            assert clock.now_ns - begin_ns == number * PERIOD_NS
        assert (ticks.overruns, ticks.left_out) == (0, 0)

    asyncio.run(test())


def test_ticks_that_are_not_due_are_leapt_over_and_never_late(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        begin_ns = clock.now_ns
        assert await ticks.next(50) == 50
        assert clock.now_ns - begin_ns == 50 * PERIOD_NS
        # Long behind: what is leapt over then has gone by already.
        clock.now_ns += 30 * PERIOD_NS
        assert await ticks.next(100) == 100
        assert clock.now_ns - begin_ns == 150 * PERIOD_NS
        assert await ticks.next(None) == LEAP_MAX_TICKS
        assert clock.now_ns - begin_ns == (150 + LEAP_MAX_TICKS) * PERIOD_NS
        assert (ticks.overruns, ticks.left_out, ticks.lag_ticks, ticks.worst_ns) == (0, 0, 0, 0)

    asyncio.run(test())


def test_a_tick_that_is_due_late_is_counted_once(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        await ticks.next()
        clock.now_ns += 23 * PERIOD_NS
        assert await ticks.next(20) == 20
        assert (ticks.overruns, ticks.lag_ticks, ticks.worst_ns) == (1, 3, 3 * PERIOD_NS)
        assert await ticks.next(10) == 10
        assert (ticks.overruns, ticks.lag_ticks) == (1, 0)

    asyncio.run(test())


class HeldClock(Clock):
    """One whose time the test alone moves on."""

    waiter: asyncio.Future[None]

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        self.due_ns, self.waiter = due_ns, waiter


@pytest.mark.parametrize(
    "part, has_outlet, passed, runs",
    [
        (0.0, False, 0, 1),
        (1.0, False, 1, 2),
        (1.5, False, 1, 2),
        (7.999, False, 7, 8),
        (19.5, False, 19, 20),
        (25.0, False, 19, 20),
        (7.0, True, 6, 8),
        (7.2, True, 6, 8),
        (7.3, True, 7, 8),
    ],
)
def test_what_comes_in_belongs_to_the_tick_that_is_next_then(
    monkeypatch: pytest.MonkeyPatch, part: float, has_outlet: bool, passed: int, runs: int
) -> None:
    clock = HeldClock()
    monkeypatch.setattr(cycle.time, "monotonic_ns", clock.monotonic_ns)

    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=clock)
        begin_ns = clock.now_ns
        waiting = asyncio.create_task(ticks.next(20, has_outlet=has_outlet))
        await asyncio.sleep(0)
        assert ticks.passed == 0
        clock.now_ns += round(part * PERIOD_NS)
        assert ticks.passed == passed
        assert ticks.make_due() == ticks.make_due() == runs
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        clock.now_ns = max(clock.now_ns, begin_ns + runs * PERIOD_NS)
        if runs < 20:
            assert clock.due_ns == begin_ns + runs * PERIOD_NS
            assert not waiting.done()
        clock.waiter.done() or clock.waiter.set_result(None)
        assert await waiting == runs
        assert (ticks.passed, ticks.make_due()) == (0, 1)

    asyncio.run(test())


class TwoMoments(HeldClock):
    """One that knows for which moments it was asked."""

    def __init__(self) -> None:
        super().__init__()
        self.asked_ns: list[int] = []

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        super().wake_at(due_ns, waiter)
        self.asked_ns.append(due_ns)


@pytest.mark.parametrize(
    "part, tick, moments",
    [
        (None, 1, [OUTLET_NS]),
        (-0.5, 1, [OUTLET_NS, 0]),
        (0.0, 2, [OUTLET_NS]),
        (0.2, 2, [OUTLET_NS]),
    ],
)
def test_a_tick_that_is_known_is_woken_up_for_at_its_outlet(
    monkeypatch: pytest.MonkeyPatch, part: float | None, tick: int, moments: list[int]
) -> None:
    """`part` is when something comes in, in periods from the beginning of the tick; `tick` the one that it is for."""
    clock = TwoMoments()
    monkeypatch.setattr(cycle.time, "monotonic_ns", clock.monotonic_ns)

    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=clock)
        due_ns = clock.now_ns + PERIOD_NS
        waiting = asyncio.create_task(ticks.next(has_outlet=True, is_known=True))
        await asyncio.sleep(0)
        if part is not None:
            clock.now_ns = due_ns + round(part * PERIOD_NS)
            assert ticks.make_due() == ticks.make_due() == tick
        clock.now_ns = clock.due_ns
        clock.waiter.set_result(None)
        assert await waiting == 1
        assert [at_ns - due_ns for at_ns in clock.asked_ns] == moments
        assert ticks.is_at_outlet == (len(moments) == 1)
        assert (ticks.overruns, ticks.make_due()) == (0, 1)

    asyncio.run(test())


def test_a_tick_that_is_known_and_late_is_counted_from_its_outlet(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=clock)
        await ticks.next(has_outlet=True, is_known=True)
        assert ticks.is_at_outlet
        # Its beginning has gone by already: then it begins as any other.
        clock.now_ns += 3 * PERIOD_NS
        await ticks.next(has_outlet=True, is_known=True)
        assert (ticks.is_at_outlet, ticks.overruns, ticks.lag_ticks) == (False, 1, 2)

    asyncio.run(test())


def test_no_tick_begins_within_a_call_that_makes_it_due(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = HeldClock()

    def monotonic_ns() -> int:
        # Time goes on between any two looks at the clock.
        clock.now_ns += 2
        return clock.now_ns

    monkeypatch.setattr(cycle.time, "monotonic_ns", monotonic_ns)

    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=clock)
        begin_ns = clock.now_ns + 2
        ran: list[int] = []
        due: list[tuple[int, list[int]]] = []

        async def go_on() -> None:
            while True:
                ran.append(await ticks.next(20))

        task = asyncio.create_task(go_on())
        await asyncio.sleep(0)
        clock.now_ns = begin_ns + 7 * PERIOD_NS - 3
        # What clients send comes from the event loop, not from a task.
        asyncio.get_running_loop().call_soon(lambda: due.append((ticks.make_due(), list(ran))))
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert due == [(7, [])]
        assert clock.due_ns == begin_ns + 7 * PERIOD_NS
        clock.waiter.set_result(None)
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert ran == [7]
        task.cancel()

    asyncio.run(test())


def test_a_late_tick_is_counted_and_those_after_it_make_up_for_it(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        begin_ns = clock.now_ns
        await ticks.next()
        clock.now_ns += 5 * PERIOD_NS
        for _ in range(9):
            await ticks.next()
        assert clock.now_ns - begin_ns == 10 * PERIOD_NS
        assert ticks.overruns == 4
        assert ticks.worst_ns == 4 * PERIOD_NS
        assert ticks.left_out == 0

    asyncio.run(test())


def test_a_cycle_tells_by_how_many_ticks_it_is_behind(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        await ticks.next()
        clock.now_ns += 4 * PERIOD_NS
        lags = []
        for _ in range(5):
            await ticks.next()
            lags.append(ticks.lag_ticks)
        assert lags == [3, 2, 1, 0, 0]
        clock.now_ns += 2 * CATCH_UP_TICKS * PERIOD_NS
        await ticks.next()
        assert ticks.lag_ticks == 0, "time that is left out is not made up for"

    asyncio.run(test())


def test_before_a_late_tick_is_read_what_has_arrived_by_then(clock: Clock) -> None:
    async def test() -> None:
        near, far = socket.socketpair()
        with near, far:
            near.setblocking(False)
            seen = []
            loop = asyncio.get_running_loop()
            loop.add_reader(near, lambda: seen.append(near.recv(16)))
            ticks = Cycle(clock)
            await ticks.next()
            clock.now_ns += 4 * PERIOD_NS
            await ticks.next()
            # More arrives while the next tick is late already.
            far.send(b"a")
            await ticks.next()
            assert seen == [b"a"]
            loop.remove_reader(near)

    asyncio.run(test())


def test_a_tick_that_is_a_little_late_is_no_overrun(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        await ticks.next()
        clock.now_ns += PERIOD_NS + PERIOD_NS // 2
        await ticks.next()
        assert ticks.overruns == 0
        assert ticks.worst_ns == PERIOD_NS // 2

    asyncio.run(test())


def test_after_a_long_absence_ticks_are_left_out_and_this_is_said(clock: Clock) -> None:
    async def test() -> None:
        said: list[int] = []
        ticks = Cycle(clock, said.append)
        await ticks.next()
        missed = CATCH_UP_TICKS + 100
        clock.now_ns += (missed + 1) * PERIOD_NS
        await ticks.next()
        assert said == [missed]
        assert ticks.left_out == missed
        back_ns = clock.now_ns
        await ticks.next()
        assert clock.now_ns == back_ns + PERIOD_NS

    asyncio.run(test())


def test_what_was_missed_before_a_restart_is_forgotten(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        await ticks.next()
        clock.now_ns += 20 * PERIOD_NS
        ticks.restart()
        now_ns = clock.now_ns
        await ticks.next()
        assert clock.now_ns == now_ns + PERIOD_NS
        assert ticks.overruns == 0

    asyncio.run(test())


def test_what_a_tick_gives_leaves_at_an_appointed_time(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=clock)
        begin_ns = clock.now_ns
        for number, work_ns in enumerate((0, 300_000, OUTLET_NS - 1), 1):
            await ticks.next()
            clock.now_ns += work_ns
            await ticks.outlet()
            assert clock.now_ns - begin_ns == number * PERIOD_NS + OUTLET_NS

    asyncio.run(test())


def test_who_is_later_than_that_is_not_held_up(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=clock)
        await ticks.next()
        clock.now_ns += OUTLET_NS + 5
        now_ns = clock.now_ns
        await ticks.outlet()
        assert clock.now_ns == now_ns

    asyncio.run(test())


def test_a_timer_that_is_not_exact_is_not_asked_for_outlets(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock, outlet_timer=Clock(is_exact=False))
        await ticks.next()
        now_ns = clock.now_ns
        await ticks.outlet()
        assert clock.now_ns == now_ns

    asyncio.run(test())


def test_others_are_served_between_ticks_that_are_made_up_for(clock: Clock) -> None:
    async def test() -> None:
        ticks = Cycle(clock)
        await ticks.next()
        clock.now_ns += 10 * PERIOD_NS
        turns = 0

        async def other() -> None:
            nonlocal turns
            while True:
                turns += 1
                await asyncio.sleep(0)

        task = asyncio.create_task(other())
        for _ in range(8):
            await ticks.next()
        task.cancel()
        assert turns >= 7

    asyncio.run(test())


ALARMS: list[Callable[[], Timer]] = [LoopTimer]
if sys.platform == "linux":
    ALARMS.append(TimerFdTimer)


@pytest.mark.parametrize("make", ALARMS)
def test_real_alarms_do_not_ring_early(make: Callable[[], Timer]) -> None:
    async def test() -> None:
        alarm = make()
        try:
            for _ in range(3):
                waiter = asyncio.get_running_loop().create_future()
                due_ns = time.monotonic_ns() + PERIOD_NS
                alarm.wake_at(due_ns, waiter)
                await waiter
                # The timers of a loop may ring within its resolution; a cycle then waits once more.
                assert time.monotonic_ns() >= due_ns - 1_100_000
        finally:
            alarm.close()
            alarm.close()

    run(test())


@pytest.mark.skipif(sys.platform != "linux", reason="timerfd is a Linux thing")
def test_in_a_steady_cycle_the_timer_is_set_once_and_stops_when_nobody_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    settings: list[tuple[int, int]] = []
    read_end, write_end = os.pipe()
    os.set_blocking(read_end, False)
    monkeypatch.setattr(cycle, "_open_timer", lambda: (read_end, lambda due, period: settings.append((due, period))))

    def ring(count: int = 1) -> None:
        os.write(write_end, count.to_bytes(8, sys.byteorder))

    async def test() -> None:
        alarm, loop = TimerFdTimer(), asyncio.get_running_loop()
        for due_ns in (10 * PERIOD_NS, 11 * PERIOD_NS, 13 * PERIOD_NS):
            waiter = loop.create_future()
            alarm.wake_at(due_ns, waiter)
            ring(2 if due_ns == 11 * PERIOD_NS else 1)
            await waiter
        assert settings == [(10 * PERIOD_NS, PERIOD_NS)]
        ring()
        while len(settings) < 2:
            await asyncio.sleep(0)
        waiter = loop.create_future()
        alarm.wake_at(15 * PERIOD_NS, waiter)
        assert settings[1:] == [(0, 0), (15 * PERIOD_NS, PERIOD_NS)]
        alarm.close()

    try:
        run(test())
    finally:
        os.close(write_end)


@pytest.mark.skipif(sys.platform != "linux", reason="timerfd is a Linux thing")
def test_linux_has_the_exact_alarm() -> None:
    async def test() -> None:
        alarm = best_timer()
        assert isinstance(alarm, TimerFdTimer)
        alarm.close()

    run(test())


def test_without_it_the_loop_will_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> None:
        raise OSError("not here")

    monkeypatch.setattr(cycle, "_open_timer", none)

    async def test() -> None:
        assert isinstance(best_timer(), LoopTimer)

    run(test())
