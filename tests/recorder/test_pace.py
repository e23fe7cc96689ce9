"""Gaps, restarts and repeated rows while rows come."""

from __future__ import annotations

import pytest

from elitescript.recorder.pace import LEARNING, Gap, Pace, Restart
from tests.recorder.controller import ticks


def shown(pace: Pace, times: list[float]) -> list:
    found = []
    for t in times:
        one = pace.take(t)
        found += [one] if one is not None else []
        found += pace.settle()
    return found + pace.settle(at_once=True)


def test_an_even_stream_has_none():
    pace = Pace(250.0)
    assert shown(pace, ticks(3.0, 100)) == []
    assert (pace.rows, pace.missing, pace.gaps, pace.restarts) == (100, 0, 0, 0)
    assert pace.rate_hz == 250.0


@pytest.mark.parametrize("count", [3, LEARNING - 1, LEARNING, LEARNING + 5])
def test_a_gap_is_counted_wherever_it_is(count):
    pace = Pace(250.0)
    begin = ticks(1.0, count)
    after = begin[-1] + 0.004 * 8
    assert shown(pace, [*begin, *(after + t for t in ticks(0.0, 40))]) == [Gap(begin[-1], after, 7)]
    assert (pace.rows, pace.missing, pace.gaps) == (count + 40, 7, 1)


def test_a_controller_that_sends_less_often_than_asked_loses_nothing():
    pace = Pace(250.0)
    assert shown(pace, [round(1.0 + 0.008 * index, 6) for index in range(60)]) == []
    assert pace.rate_hz == pytest.approx(125.0)
    assert pace.take(1.0 + 0.008 * 62) == Gap(pytest.approx(1.472), pytest.approx(1.496), 2)


def test_time_that_begins_anew_is_no_gap():
    pace = Pace(250.0)
    assert shown(pace, [*ticks(50.0, 40), *ticks(0.1, 40)]) == [Restart(50.156, 0.1)]
    assert (pace.gaps, pace.restarts) == (0, 1)


def test_rows_with_the_time_of_the_one_before_are_counted_apart():
    pace = Pace(250.0)
    times = [1.0, 1.004, 1.004, 1.004, 1.008, 0.5, 0.5, 1.008]
    assert [pace.repeats(t) for t in times] == [0, 0, 1, 2, 0, 0, 1, 0]
    assert (pace.repeated, pace.rows) == (3, 0)
