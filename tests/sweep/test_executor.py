"""Child processes: those that die or hang cost what they were at, and nothing else."""

from __future__ import annotations

import os
import random
import signal
import time
from pathlib import Path
from typing import Any

import pytest

from elitescript.errors import ElitescriptError, UsageError
from elitescript.sweep.engines.executor import Executor, Result, _Work

JOB = "tests.sweep.jobs:squares"


def squares_of(
    wanted: list[range], jobs: int = 1, max_wall_s: float | None = 30.0, **description: Any
) -> dict[int, Result]:
    with Executor(JOB, description, jobs=jobs, max_wall_s=max_wall_s) as executor:
        results = [result for piece in executor.results(wanted) for result in piece]
    assert len(results) == sum(map(len, wanted))
    return {result.number: result for result in results}


def test_every_number_comes_once_whatever_is_killed_from_outside() -> None:
    chance = random.Random(5)
    found: list[Result] = []
    killed = 0
    with Executor(JOB, {}, jobs=2) as executor:
        for piece in executor.results([range(100), range(200, 1300)]):
            assert [result.number for result in piece] == list(range(piece[0].number, piece[-1].number + 1))
            found += piece
            if killed < 3 and chance.random() < 0.3:
                os.kill(chance.choice(executor.processes), signal.SIGKILL)
                killed += 1
    assert killed == 3
    numbers = [*range(100), *range(200, 1300)]
    assert sorted(found) == [Result(number, number * number) for number in numbers]


def test_what_ends_its_process_is_found_and_costs_itself_alone(tmp_path: Path) -> None:
    found = squares_of([range(40)], kills=[7], kills_once=[20], folder=str(tmp_path))
    assert found.pop(7) == Result(7, "about 7", "crashed")
    assert found == {number: Result(number, number * number) for number in range(40) if number != 7}


def test_what_hangs_is_found_and_costs_itself_alone() -> None:
    found = squares_of([range(12)], max_wall_s=0.3, hangs=[2])
    assert found.pop(2) == Result(2, "about 2", "hung")
    assert found == {number: Result(number, number * number) for number in range(12) if number != 2}


def test_a_job_may_have_no_description() -> None:
    with Executor("benchmarks.cluster:nothing", None, jobs=1) as executor:
        assert executor.results_of([7]) == [Result(-1, 7)]


def test_work_without_a_number() -> None:
    with Executor(JOB, {"hangs": [3]}, jobs=1, max_wall_s=0.3) as executor:
        assert executor.result_of({"of": 5}) == Result(-1, 25)
        assert executor.result_of({"of": 3}) == Result(-1, None, "hung")
        assert executor.results_of([{"of": 6}, {"of": 7}]) == [Result(-1, 36), Result(-1, 49)]
        assert executor.about(3) == Result(-1, "about 3")


class Child:
    """A child that has been silent for long."""

    is_busy = True

    def __init__(self, since_s: float) -> None:
        self.since_s = since_s

    def is_late(self, now_s: float, max_wall_s: float) -> bool:
        return now_s - self.since_s >= max_wall_s


def test_what_has_come_while_this_process_did_something_else_is_read_before_a_child_is_late() -> None:
    executor = Executor(JOB, {}, jobs=1, max_wall_s=0.3)
    child: Any = Child(time.monotonic() - 5.0)
    executor._children = [child]
    executor._news.put((child, [["value", 1]]))
    assert executor._next_news() == (child, [["value", 1]], "")
    assert executor._next_news() == (child, [], "hung")
    executor._news.put((child, None))
    assert executor._next_news() == (child, [], "crashed")


def test_time_in_which_this_process_was_stopped_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    executor = Executor(JOB, {}, jobs=1, max_wall_s=0.3)
    now_s = iter((10.0, 90.0, 90.0, 90.1))
    child: Any = Child(9.9)
    executor._children = [child]

    def late_news() -> float:
        if child.since_s > 80.0:
            executor._news.put((child, [["value", 1]]))
        return next(now_s)

    monkeypatch.setattr("elitescript.sweep.engines.executor.time.monotonic", late_news)
    assert executor._next_news() == (child, [["value", 1]], "")
    assert child.since_s == 90.0


def test_a_job_that_refuses_or_has_a_mistake_ends_all() -> None:
    with pytest.raises(UsageError, match="not with me"):
        squares_of([range(3)], refuses="not with me")
    with pytest.raises(ElitescriptError, match="RuntimeError: number 1 fails"):
        squares_of([range(3)], fails=[1])
    with Executor("tests.sweep.nothing:job", {}, jobs=1) as executor:  # noqa: SIM117
        with pytest.raises(ElitescriptError, match=r"tests\.sweep\.nothing"):
            list(executor.results([range(3)]))


def test_numbers_of_a_dead_process_come_again_one_by_one_and_then_as_ranges() -> None:
    work = _Work([range(1000)])
    assert work.next_range(500) == range(500)
    assert work.lost(range(10, 500), "crashed") == []
    alone = [work.next_range(500) for _ in range(64)]
    assert alone == [range(number, number + 1) for number in range(10, 74)]
    assert work.next_range(500) == range(74, 500)
    assert work.next_range(500) == range(500, 1000)
    assert work.waiting == 0
    # Alone it may die once by what happens to it from outside.
    assert work.lost(range(10, 11), "crashed") == []
    assert work.lost(range(10, 11), "crashed") == [Result(10, None, "crashed")]
    assert work.lost(range(11, 12), "hung") == [Result(11, None, "hung")]
