"""Random trees that run, with inputs that change: none fails for reasons of ours, and leaping equals stepping."""

from __future__ import annotations

from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.environment.task_files import script_of_data
from elitescript.language.compiler import compile_unit
from elitescript.program_tree import task_bytes
from tests.program_tree.trees import random_task

LIMIT_S = 60.0
"""Robot time of a run; the endless parts of a tree end with it."""


def outcome(seed: int, *, is_stepped: bool) -> tuple[object, ...]:
    """Return all that can be seen of a run: end, time, events, joints and outputs."""
    random = Random(seed)
    data = task_bytes(random_task(random, 10, is_runnable=True))
    source, errors = script_of_data("cell.task", {"cell.task": data}.get)
    assert errors == ()
    robot = VirtualRobot("CS66", joints=(0.0, -1.5, -1.5, -1.5, 1.5, 0.0))
    for number in (3, 4):
        t = 0.0
        for level in range(random.randrange(4)):
            t += random.uniform(0.1, 3.0)
            robot.at(t, f"standard_digital_in[{number}]", level % 2 == 0)
    pace = (lambda tick: None) if is_stepped else None
    run = robot.run(compile_unit(source), until_s=LIMIT_S, pace=pace)
    return run.state, run.time_s, tuple(map(str, run.alarms)), run.joints, [str(event) for event in run.events]


@pytest.mark.parametrize("seed", range(12))
def test_a_random_tree_runs_to_its_end(seed: int) -> None:
    state, _, alarms, _, _ = outcome(seed, is_stepped=False)
    assert alarms == ()
    assert state in ("finished", "stopped", "time_limit")


@pytest.mark.parametrize("seed", range(100, 103))
def test_leaping_equals_stepping(seed: int) -> None:
    assert outcome(seed, is_stepped=False) == outcome(seed, is_stepped=True)


@pytest.mark.slow
@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(1000, 1300))
def test_many_random_trees(seed: int) -> None:
    leaped = outcome(seed, is_stepped=False)
    assert leaped[2] == ()
    assert leaped == outcome(seed, is_stepped=True)
