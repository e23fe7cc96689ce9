"""Garbage is collected when the client is quiet, and never inside an answer."""

from __future__ import annotations

import asyncio
import gc
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from elitescript.environment import collecting
from elitescript.environment.collecting import QUIET_S, Collector


@pytest.fixture
def collections(monkeypatch):
    """The collections so far; the collector of Python is as before behind the test."""
    made: list[int] = []
    count = [0]
    monkeypatch.setattr(collecting.gc, "collect", lambda: made.append(count[0]))
    monkeypatch.setattr(collecting.gc, "freeze", lambda: None)
    monkeypatch.setattr(collecting.gc, "disable", lambda: None)
    monkeypatch.setattr(collecting.gc, "get_count", lambda: (count[0], 0, 0))
    return made, count


class Clock:
    """Takes the place of the clock of an event loop."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def time(self) -> float:
        return self.now_s


def run(*steps):
    """Make a collector, and do one thing after the other, each followed by so many seconds of a clock of its own.

    A step gets the collector and the clock, which it moves if it takes time.
    """

    async def go_on():
        loop, clock = asyncio.get_running_loop(), Clock()
        loop.time = clock.time
        collector = Collector()
        for step, wait_s in steps:
            step(collector, clock)
            for _ in range(2):
                # A timer whose time has come is due when the loop has looked at its clock, and then runs.
                await asyncio.sleep(0)
            clock.now_s += wait_s
            for _ in range(2):
                await asyncio.sleep(0)
        collector.close()

    asyncio.run(go_on())


def a_message(collector, _clock):
    collector.message_came()


def test_it_collects_in_a_pause_if_there_is_something(collections):
    made, count = collections
    run((a_message, 2.0 * QUIET_S))
    assert made == [0]
    count[0] = collecting.OBJECTS_MIN + 1
    run((a_message, 0.9 * QUIET_S))
    assert made == [0, count[0]]
    run((a_message, 1.1 * QUIET_S))
    assert made == [0, count[0], count[0], count[0]]


def test_not_right_behind_a_long_answer(collections):
    made, count = collections
    count[0] = collecting.OBJECTS_MIN + 1

    def answer(_collector, clock):
        clock.now_s += 4.0 * QUIET_S

    def note(_collector, _clock):
        made.append(-1)

    run((a_message, 0.0), (answer, 0.0), (note, 1.1 * QUIET_S))
    assert made[1:] == [-1, count[0]]


def test_messages_put_it_off_but_not_for_ever(collections):
    made, count = collections
    count[0] = collecting.OBJECTS_MAX
    run(*[(a_message, 0.0)] * 3)
    assert len(made) == 1
    count[0] += 1
    run((a_message, 0.0))
    assert len(made) == 3


def test_a_process_that_serves_has_no_other_collection():
    was_on = gc.isenabled()
    try:
        Collector()
        assert not gc.isenabled()
    finally:
        gc.unfreeze()
        if was_on:
            gc.enable()


def test_a_collection_leaves_tuples_alone_that_another_thread_is_filling():
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    collector = Collector()
    try:
        with ThreadPoolExecutor(1) as pool:
            filled = pool.submit(lambda: [tuple(item for item in range(100_000)) for _ in range(5)])
            while not filled.done():
                collector._collect()
            assert all(len(found) == 100_000 for found in filled.result())
    finally:
        sys.setswitchinterval(interval)
        gc.unfreeze()
        gc.enable()
