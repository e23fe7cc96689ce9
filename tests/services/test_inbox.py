"""What waits for the robot: order, fairness, bounds."""

from __future__ import annotations

from math import inf
from random import Random

import pytest

from elitescript.messages.inputs import AddLog, ChannelClosed, ChannelData, Query, RunUnit
from elitescript.services.clients import input_queue as inbox
from elitescript.services.clients.input_queue import PRICES_NS, WORK_NS, InputQueue, price_ns


def programs(origin, count):
    return [RunUnit(origin, "secondary", f"sec s():\n  x = {number}\nend\n") for number in range(count)]


def test_what_fits_goes_in_as_it_came():
    box = InputQueue()
    inputs = [AddLog("a", "1"), AddLog("a", "2"), ChannelData(1, b"x"), AddLog("b", "2"), AddLog("a", "3")]
    for part in (inputs[:2], inputs[2:3], inputs[3:4], [], inputs[4:]):
        box.post(part)
    assert len(box) == 5
    assert box.take() == inputs
    assert len(box) == 0
    assert box.take() == []


def test_more_than_fits_is_spread_over_ticks_in_the_order_of_each_client():
    random = Random(7)
    box, sent = (
        InputQueue(),
        {"a": programs("a", 60), "b": programs("b", 40), "c": [AddLog("c", str(n)) for n in range(90)]},
    )
    left = {name: list(items) for name, items in sent.items()}
    done = {name: [] for name in sent}
    while any(left.values()) or len(box):
        for name in random.sample(sorted(left), len(left)):
            count = random.randrange(9)
            box.post(left[name][:count])
            del left[name][:count]
        taken = box.take()
        assert len([item for item in taken if isinstance(item, RunUnit)]) <= WORK_NS / PRICES_NS[RunUnit] + 1
        for item in taken:
            done[item.origin].append(item)
    assert done == sent


def test_a_client_that_asks_little_is_not_behind_those_who_ask_much():
    box = InputQueue()
    for one in programs("flood", 500):
        box.post([one])
    box.take()
    for number in range(20):
        box.post([AddLog("good", str(number))])
        assert AddLog("good", str(number)) in box.take()
    assert box.waiting_of("flood") > 300
    assert box.waiting_of("good") == 0


def test_questions_of_one_client_are_of_one_client():
    box = InputQueue()
    for number in range(200):
        box.post([Query(f"query#1/{number}", "1", "x")])
    assert len(box.take()) == 1, "one is as much work as a tick has"
    assert box.waiting_of("query#1") == 199


def test_a_robot_that_is_away_gets_only_what_its_connections_send():
    box = InputQueue()
    for item in (AddLog("a", "1"), ChannelData(1, b"x"), ChannelClosed(1)):
        box.post([item])
    assert box.take(None) == [ChannelData(1, b"x"), ChannelClosed(1)]
    assert box.take(None) == []
    assert box.take() == [AddLog("a", "1")]


def test_a_large_program_alone_goes_in():
    box = InputQueue()
    large = RunUnit("a", "program", "x" * 1_000_000)
    box.post([large])
    box.post([AddLog("a", "after")])
    box.post(programs("b", 1))
    assert box.take() == [large]
    assert box.take() == [AddLog("a", "after")], "it is small"
    ticks = 1
    while not box.take():
        ticks += 1
    assert ticks >= price_ns((large,)) // WORK_NS - 2, "the large one is paid for"


def test_what_finds_no_room_is_counted_and_never_of_a_connection(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(inbox, "WAITING_MAX", 3)
    box = InputQueue()
    for item in (*(AddLog("a", text) for text in "12345"), ChannelClosed(7), AddLog("b", "6")):
        box.post([item])
    assert box.refused == 3
    assert box.take() == [*(AddLog("a", text) for text in "123"), ChannelClosed(7)]


def test_what_was_read_together_goes_in_together():
    box = InputQueue(work_ns=50_000)
    box.post(programs("flood", 3))
    package = [AddLog("rtsi#1", str(number)) for number in range(40)]
    box.post(package)
    assert box.take() == programs("flood", 1)
    taken = []
    while not taken:
        taken = box.take()
    assert taken == package


def test_a_robot_that_is_behind_gets_less_to_do_and_what_is_little_all_the_same():
    box = InputQueue()
    box.post(programs("flood", 100))
    assert len(box.take(0.5)) < 4
    box.post([AddLog("good", "x")])
    assert box.take(0.0) == [AddLog("good", "x")]
    assert box.take(0.0) == []


def test_an_inbox_without_a_limit_holds_nothing_back():
    box = InputQueue(work_ns=inf)
    box.post(programs("a", 100))
    box.post(programs("b", 100))
    assert len(box.take()) == 200
