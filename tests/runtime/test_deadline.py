"""The end of the time that a command may take."""

from __future__ import annotations

import pytest

from elitescript.runtime.threads.deadline import Deadline
from elitescript.runtime.threads.scheduler import Scheduler
from tests.runtime.machine import Bench


def idle() -> Scheduler:
    """A scheduler whose only thread sleeps for ever."""
    return Bench().start("def main():\n  sleep(1000)\nend\n").host._scheduler


@pytest.mark.parametrize("timeout_s", [0.0, -1.0])
def test_without_a_time_it_never_comes(timeout_s: float) -> None:
    scheduler = idle()
    deadline = Deadline(scheduler, timeout_s)
    scheduler.begin_tick(10**9)
    assert deadline.tick is None and not deadline.is_over


@pytest.mark.parametrize(("timeout_s", "ticks"), [(0.0001, 1), (0.004, 1), (0.1, 25)])
def test_it_comes_after_its_time_and_one_tick_at_least(timeout_s: float, ticks: int) -> None:
    scheduler = idle()
    deadline = Deadline(scheduler, timeout_s)
    assert deadline.tick == scheduler.now + ticks
    scheduler.begin_tick(scheduler.now + ticks - 1)
    assert not deadline.is_over
    scheduler.begin_tick(scheduler.now + 1)
    assert deadline.is_over


def test_ticks_that_are_made_up_for_do_not_bring_it_nearer() -> None:
    scheduler = idle()
    scheduler.begin_tick(10)
    scheduler.lag_ticks = 75
    deadline = Deadline(scheduler, 0.2)
    for tick in range(11, 85):
        scheduler.begin_tick(tick)
        scheduler.lag_ticks = 85 - tick
        assert not deadline.is_over
    scheduler.begin_tick(85)
    scheduler.lag_ticks = 0
    assert deadline.tick == 10 + 75 + 50
    scheduler.begin_tick(134)
    assert not deadline.is_over
    scheduler.begin_tick(135)
    assert deadline.is_over


def test_what_began_in_time_ends_in_time_when_later_ticks_are_made_up_for() -> None:
    scheduler = idle()
    scheduler.begin_tick(10)
    deadline = Deadline(scheduler, 0.2)
    scheduler.lag_ticks = 75
    scheduler.begin_tick(59)
    assert not deadline.is_over
    scheduler.begin_tick(60)
    assert deadline.is_over


def test_pauses_put_it_off() -> None:
    scheduler = idle()
    scheduler.begin_tick(10)
    deadline = Deadline(scheduler, 0.4)
    for begin, end in ((20, 50), (60, 1000)):
        scheduler.begin_tick(begin)
        scheduler.pause()
        scheduler.begin_tick(end - 1)
        scheduler.resume()
        scheduler.begin_tick(end)
    assert deadline.tick == 110 + 30 + 940
    assert not deadline.is_over
    scheduler.begin_tick(1080)
    assert deadline.is_over
