"""Random point files in whole programs: limits, continuity, the end, and leaping equals stepping."""

from __future__ import annotations

from itertools import pairwise
from math import sin
from random import Random
from typing import Any, NamedTuple

import pytest

from elitescript import VirtualRobot
from elitescript.devices.memory import MemoryEnvironment
from elitescript.kinematics.transforms import pose_from_transform, transform_from_pose
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from tests.invariants.cases import CASES

COUNT = CASES // 6
MODEL = load_model("CS66")
START = (0.3, -1.5, -1.6, -1.5, 1.5, 0.2)


def random_file(chance: Random, is_cartesian: bool) -> tuple[bytes, list[tuple[float, ...]]]:
    """A smooth path from `START`, as the text of a file, and its points as they were before they were written."""
    count = chance.randrange(2, 150)
    step_s = chance.choice((0.002, 0.004, 0.01))
    size = chance.choice((0.02, 0.1)) if is_cartesian else chance.choice((0.05, 0.3))
    waves = [(chance.uniform(-size, size), chance.uniform(0.3, 8.0)) for _ in range(6)]
    start = pose_from_transform(MODEL.arm.forward(START)) if is_cartesian else START
    rows = [tuple(s + a * sin(w * k * step_s) for s, (a, w) in zip(start, waves, strict=True)) for k in range(count)]
    blank = chance.choice((" ", ", ", "\t", ","))
    lines = [blank.join(f"{x:.9f}" for x in row) for row in rows]
    for _ in range(chance.randrange(3)):
        lines.insert(chance.randrange(len(lines) + 1), chance.choice(("", "# here", "   ")))
    return "\n".join(lines).encode(), rows


def program_of(is_cartesian: bool, interval_ms: int, first: int, last: int) -> str:
    """Load, go to the first point, play."""
    return "\n".join(
        [
            "def play():",
            f'  i = load_micro_line_file("p.txt", {interval_ms}, {int(is_cartesian)})',
            f"  movej(get_micro_line_values_by_index(i, 0, {max(1, first)}))",
            f"  moveml(i, {first}, {last})",
            "  textmsg(get_target_tcp_pose())",
            "  sleep(0.02)",
            "end\n",
        ]
    )


class Outcome(NamedTuple):
    """What came of a run."""

    program: str
    state: str
    time_s: float
    events: Any
    trace: Any
    joints: Any
    wanted: tuple[float, ...]
    """The last point."""
    is_cartesian: bool


def outcome(seed: int, pace: Any, *, is_disturbed: bool) -> Outcome:
    chance = Random(seed)
    is_cartesian = chance.random() < 0.5
    data, rows = random_file(chance, is_cartesian)
    first = chance.choice((0, 0, 1, len(rows) // 3))
    last = chance.choice((0, 0, len(rows), max(first, 1, len(rows) // 2)))
    program = program_of(is_cartesian, chance.choice((2, 4, 7, 20)), first, last)
    robot = VirtualRobot("CS66", seed=seed, world=MemoryEnvironment({"p.txt": data}), joints=START)
    if is_disturbed:
        for _ in range(chance.randrange(1, 4)):
            robot.controller.put(chance.randrange(0, 200), SetSpeedScale(chance.choice((0.05, 0.4, 0.7, 1.0))))
        if chance.random() < 0.7:
            tick = chance.randrange(0, 150)
            robot.controller.put(tick, PauseTask())
            robot.controller.put(tick + chance.randrange(0, 200), ResumeTask())
    run = robot.run(program, until_s=60.0, trace=True, trace_step_s=0.004, pace=pace)
    wanted = rows[(last or len(rows)) - 1]
    return Outcome(program, run.state, run.time_s, run.events, run.trace, run.joints, wanted, is_cartesian)


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(COUNT, 10)))
def test_leaping_equals_stepping(seed: int) -> None:
    leaped = outcome(seed, None, is_disturbed=True)
    stepped = outcome(seed, lambda tick: None, is_disturbed=True)
    for mine, other in zip(leaped, stepped, strict=True):
        assert mine == other
    assert leaped.state == "finished", leaped.program


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(COUNT, 10)))
def test_limits_continuity_and_end(seed: int) -> None:
    run = outcome(seed, None, is_disturbed=False)
    assert run.state == "finished", run.program
    limits = [(joint.qd_max, joint.qdd_max) for joint in MODEL.joints]
    for before, now in pairwise(run.trace):
        for (qd_max, qdd_max), q, q_next, v, w in zip(limits, before.q, now.q, before.qd, now.qd, strict=True):
            assert abs(w) <= qd_max * (1.0 + 1e-9)
            assert abs(w - v) <= qdd_max * PERIOD_S * (1.0 + 1e-6)
            assert abs(q_next - q - 0.5 * (v + w) * PERIOD_S) <= qdd_max * PERIOD_S**2
    if run.is_cartesian:
        T_wanted = transform_from_pose(run.wanted)  # type: ignore[arg-type]
        assert MODEL.arm.forward(run.joints) == pytest.approx(T_wanted, abs=1e-8)
    else:
        assert run.joints == pytest.approx(run.wanted, abs=1e-9)
