"""The cycle of a served robot: ticks of 4 ms against the wall clock, in an event loop.

Ticks in which nothing is due are leapt over: the cycle sleeps until the next one that is, or until something comes in,
which belongs to the tick that is next then. A tick that is not due is never late.

A tick has two moments: it begins when it is due, and what it gives leaves `OUTLET_NS` later. How long the robot takes
differs from tick to tick, the more so when its process or the caches have to be woken up; what leaves at an appointed
time does not show it. When it is known before what a tick gives, there is nothing to do at its beginning: the cycle
sleeps until the outlet, unless something comes in before the beginning.

The timers of an event loop have a resolution of 1 ms; on Linux a `timerfd` wakes us within 0.1 ms instead. A tick that
begins late is counted; ticks that have been missed are made up for, one after the other, so that robot time and wall
clock agree again. If more than `CATCH_UP_TICKS` have been missed, because the computer was away or ticks last longer
than their period, all of them are *left out*: robot time stands still for so long, with a line in the log.
"""

from __future__ import annotations

import asyncio
import os
import sys
import time
from collections.abc import Callable
from typing import Any, Final, Protocol

from elitescript.messages.timing import TICKS_PER_S
from elitescript.services.time.prompt import PromptFuture

PERIOD_NS: Final = 4_000_000
LATE_NS: Final = PERIOD_NS
"""A tick that begins this much after its time is counted as an overrun."""
OUTLET_NS: Final = 1_000_000
"""After the moment at which a tick is due; most robots have given their output by then."""
CATCH_UP_TICKS: Final = 125
"""Missed ticks that are made up for, 0.5 s; more would reach clients in one burst."""
LEAP_MAX_TICKS: Final = 10 * TICKS_PER_S
"""So many ticks are leapt over at most."""


class Timer(Protocol):
    """Wakes a waiter at a time of `time.monotonic_ns`."""

    @property
    def is_exact(self) -> bool:
        """Whether it wakes well within a millisecond."""

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        """Set the result of the waiter at that time."""

    def close(self) -> None:
        """Give back what the operating system has lent."""


class Cycle:
    """Says when the next tick is due, and counts those that begin late.

    Args:
        timer: what wakes it; the best there is if None.
        on_left_out: called with the number of ticks that are left out.
        outlet_timer: what wakes it for the outlets; another one of the same kind if None.

    Attributes:
        overruns: ticks that began late by a period or more.
        lag_ticks: whole periods by which the present tick began late; those that are left out do not count.
        left_out: ticks that never were, because the computer was away or too slow.
        worst_ns: the latest beginning of a tick since `worst_ns` was last set to 0.
        is_at_outlet: whether `next` has returned at the outlet of the tick: it has begun with nothing that is given.
    """

    __slots__ = (
        "_due_ns",
        "_is_wanted",
        "_leap",
        "_on_left_out",
        "_outlet_timer",
        "_passed_after_ns",
        "_timer",
        "_waiter",
        "is_at_outlet",
        "lag_ticks",
        "left_out",
        "overruns",
        "worst_ns",
    )

    def __init__(
        self,
        timer: Timer | None = None,
        on_left_out: Callable[[int], None] | None = None,
        outlet_timer: Timer | None = None,
    ) -> None:
        self._timer = timer or best_timer()
        self._outlet_timer = outlet_timer or best_timer()
        self._on_left_out = on_left_out
        self._due_ns = 0
        self._leap = 1
        """How many ticks on the one that `next` waits for is from the one before."""
        self._passed_after_ns = 0
        """After its beginning a tick that is leapt over has given what it would have given."""
        self._waiter: asyncio.Future[None] | None = None
        self._is_wanted = True
        """Whether the tick that is waited for is to be woken up for at its beginning."""
        self.is_at_outlet = False
        self.overruns = 0
        self.lag_ticks = 0
        self.left_out = 0
        self.worst_ns = 0

    def restart(self) -> None:
        """Make the next tick due a period from now; what was missed before is not made up for."""
        self._due_ns = 0

    async def next(self, ticks: int | None = 1, *, has_outlet: bool = False, is_known: bool = False) -> int:
        """Return when the next tick begins; others are served before it in any case.

        Before a tick that begins late, all that has arrived by the time of `lag_ticks` is read; what arrives later is
        not for this tick.

        Args:
            ticks: how many ticks on the next one is that is due; None if there is none.
            has_outlet: whether what ticks give leaves at `outlet`, that of the ticks between too.
            is_known: whether it is known what the next tick gives if nothing comes in before it; `is_at_outlet` then.

        Returns:
            How many ticks on the one is that begins; fewer after `make_due`, or than `LEAP_MAX_TICKS`.
        """
        now_ns = time.monotonic_ns()
        if self._due_ns == 0:
            self._due_ns = now_ns
        self._leap = LEAP_MAX_TICKS if ticks is None else min(ticks, LEAP_MAX_TICKS)
        self._due_ns += self._leap * PERIOD_NS
        has_exact_outlet = has_outlet and self._outlet_timer.is_exact
        self._passed_after_ns = OUTLET_NS if has_exact_outlet else 0
        self.is_at_outlet = False
        begin_ns = self._due_ns
        if is_known and has_exact_outlet and self._leap == 1 and now_ns < self._due_ns:
            now_ns = await self._until_outlet()
            if self.is_at_outlet:
                begin_ns += OUTLET_NS
        elif now_ns >= self._due_ns:
            await asyncio.sleep(0)
            now_ns = time.monotonic_ns()
        else:
            now_ns = await self._until_due()
        gone_on, self._leap = self._leap, 1
        self._note(now_ns - begin_ns, now_ns)
        if self.lag_ticks and not self.is_at_outlet:
            # The loop looks for what has arrived in the first of these rounds, and hands it on in the second.
            await asyncio.sleep(0)
            await asyncio.sleep(0)
        return gone_on

    @property
    def passed(self) -> int:
        """How many of the ticks that are being leapt over have given what they would have given."""
        return 0 if self._leap == 1 else self._begun(time.monotonic_ns() - self._passed_after_ns)

    def make_due(self) -> int:
        """Let the next tick run, if the cycle is about to leap over it.

        Returns:
            How many ticks on it is from the last one that `next` has returned for.
        """
        if not self._is_wanted:
            now_ns = time.monotonic_ns()
            if now_ns >= self._due_ns:
                # It has begun.
                return 2
            self._is_wanted = True
            if self._waiter is not None:
                self._timer.wake_at(self._due_ns, self._waiter)
        elif self._leap > 1:
            left = self._leap - self._begun(time.monotonic_ns()) - 1
            if left:
                self._due_ns -= left * PERIOD_NS
                self._leap -= left
                if self._waiter is not None:
                    # It is the timer that lets time go on: no tick begins within this call.
                    self._timer.wake_at(self._due_ns, self._waiter)
        return self._leap

    def _begun(self, now_ns: int) -> int:
        """Return how many of the ticks that are being leapt over would have begun at a time."""
        return min(max((now_ns - self._due_ns) // PERIOD_NS + self._leap, 0), self._leap - 1)

    async def _until_due(self) -> int:
        """Wait for the tick that is due, which may become an earlier one meanwhile; return what time it is then."""
        while (now_ns := time.monotonic_ns()) < self._due_ns:
            self._waiter = PromptFuture()
            self._timer.wake_at(self._due_ns, self._waiter)
            await self._waiter
        return now_ns

    async def _until_outlet(self) -> int:
        """Wait for the outlet of the tick that is due; for its beginning alone if `make_due` is called before that.

        Returns:
            What time it is then.
        """
        self._is_wanted = False
        try:
            while (now_ns := time.monotonic_ns()) < self._due_ns + OUTLET_NS:
                if self._is_wanted:
                    return await self._until_due()
                self._waiter = PromptFuture()
                self._outlet_timer.wake_at(self._due_ns + OUTLET_NS, self._waiter)
                await self._waiter
            self.is_at_outlet = not self._is_wanted
            return now_ns
        finally:
            self._is_wanted = True

    async def outlet(self) -> None:
        """Return when what the present tick gives is to leave; at once if that was before, or no timer is so exact."""
        if self._outlet_timer.is_exact:
            await _until(self._due_ns + OUTLET_NS, self._outlet_timer)

    def close(self) -> None:
        """End: no tick comes after this."""
        self._timer.close()
        self._outlet_timer.close()

    def _note(self, late_ns: int, now_ns: int) -> None:
        self.worst_ns = max(self.worst_ns, late_ns)
        self.lag_ticks = 0
        if late_ns < LATE_NS:
            return
        self.overruns += 1
        missed = late_ns // PERIOD_NS
        if missed > CATCH_UP_TICKS:
            self.left_out += missed
            self._due_ns = now_ns
            if self._on_left_out is not None:
                self._on_left_out(missed)
        else:
            self.lag_ticks = missed


class LoopTimer:
    """Wakes by the timers of the event loop."""

    __slots__ = ("_timer",)

    is_exact: Final = False

    def __init__(self) -> None:
        self._timer: asyncio.TimerHandle | None = None

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        loop = asyncio.get_running_loop()
        self.close()
        self._timer = loop.call_at(loop.time() + (due_ns - time.monotonic_ns()) / 1e9, _wake, waiter)

    def close(self) -> None:
        if self._timer is not None:
            self._timer.cancel()


class TimerFdTimer:
    """Wakes by a Linux timer that is a file.

    It expires every period from the time at which it is first asked for, so that in a steady cycle it need not be set
    again. When it expires and there is no waiter it stops.

    Raises:
        OSError: there is none.
    """

    __slots__ = ("_fd", "_loop", "_next_ns", "_set", "_waiter")

    is_exact: Final = True

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._waiter: asyncio.Future[None] | None = None
        self._next_ns = 0
        self._fd, self._set = _open_timer()
        self._loop.add_reader(self._fd, self._expired)

    def wake_at(self, due_ns: int, waiter: asyncio.Future[None]) -> None:
        self._waiter = waiter
        if due_ns != self._next_ns:
            self._next_ns = due_ns
            self._set(due_ns, PERIOD_NS)

    def close(self) -> None:
        if self._fd >= 0:
            self._loop.remove_reader(self._fd)
            os.close(self._fd)
            self._fd = -1

    def _expired(self) -> None:
        try:
            count = os.read(self._fd, 8)
        except BlockingIOError:
            return
        waiter, self._waiter = self._waiter, None
        if waiter is None:
            self._next_ns = 0
            self._set(0, 0)
        else:
            self._next_ns += PERIOD_NS * int.from_bytes(count, sys.byteorder)
            _wake(waiter)


def best_timer() -> Timer:
    """Return the most exact timer that this computer and the running event loop have."""
    if sys.platform == "linux":
        try:
            return TimerFdTimer()
        except (OSError, AttributeError, NotImplementedError):
            pass
    return LoopTimer()


async def _until(due_ns: int, timer: Timer) -> int:
    """Wait for a time of `time.monotonic_ns`; return what time it is then."""
    while (now_ns := time.monotonic_ns()) < due_ns:
        waiter = PromptFuture()
        timer.wake_at(due_ns, waiter)
        await waiter
    return now_ns


def _wake(waiter: asyncio.Future[None]) -> None:
    if not waiter.done():
        waiter.set_result(None)


def _open_timer() -> tuple[int, Callable[[int, int], Any]]:
    """Return a timer on the clock of `time.monotonic_ns`, and its setter: absolute time and period, ns; 0 stops it."""
    if sys.version_info >= (3, 13):
        fd = os.timerfd_create(time.CLOCK_MONOTONIC, flags=os.TFD_NONBLOCK | os.TFD_CLOEXEC)
        return fd, lambda due_ns, period_ns: os.timerfd_settime_ns(
            fd, flags=os.TFD_TIMER_ABSTIME, initial=due_ns, interval=period_ns
        )
    import ctypes

    clock_monotonic, absolute = 1, 1
    libc = ctypes.CDLL(None, use_errno=True)
    opened: int = libc.timerfd_create(clock_monotonic, os.O_NONBLOCK | os.O_CLOEXEC)
    if opened < 0:
        raise OSError(ctypes.get_errno(), "timerfd_create")
    # struct itimerspec: interval and first time, each in seconds and nanoseconds.
    spec = (ctypes.c_long * 4)()
    settime = libc.timerfd_settime

    def set_timer(due_ns: int, period_ns: int) -> None:
        spec[0], spec[1] = divmod(period_ns, 1_000_000_000)
        spec[2], spec[3] = divmod(due_ns, 1_000_000_000)
        settime(opened, absolute, spec, None)

    return opened, set_timer
