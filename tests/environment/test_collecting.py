"""Garbage is collected when the client is quiet, and never inside an answer."""

from __future__ import annotations

import asyncio
import gc
import sys
from concurrent.futures import ThreadPoolExecutor
from time import sleep

import pytest

from elitescript.environment import collecting
from elitescript.environment.collecting import Collector


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


def run(*steps):
    """Make a collector, and do one thing after the other, each followed by so many seconds."""

    async def go_on():
        collector = Collector()
        for step, wait_s in steps:
            step(collector)
            await asyncio.sleep(wait_s)
        collector.close()

    asyncio.run(go_on())


def test_it_collects_in_a_pause_if_there_is_something(collections, monkeypatch):
    made, count = collections
    monkeypatch.setattr(collecting, "QUIET_S", 0.01)
    run((Collector.message_came, 0.02))
    assert made == [0]
    count[0] = collecting.OBJECTS_MIN + 1
    run((Collector.message_came, 0.02))
    assert made == [0, count[0], count[0]]


def test_not_right_behind_a_long_answer(collections, monkeypatch):
    made, count = collections
    monkeypatch.setattr(collecting, "QUIET_S", 0.005)
    count[0] = collecting.OBJECTS_MIN + 1
    run((Collector.message_came, 0.0), (lambda collector: sleep(0.02), 0.0), (lambda collector: made.append(-1), 0.02))
    assert made[1:] == [-1, count[0]]


def test_messages_put_it_off_but_not_for_ever(collections):
    made, count = collections
    count[0] = collecting.OBJECTS_MAX
    run(*[(Collector.message_came, 0.0)] * 3)
    assert len(made) == 1
    count[0] += 1
    run((Collector.message_came, 0.0))
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
