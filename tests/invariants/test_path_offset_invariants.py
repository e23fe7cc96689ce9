"""Random programs that shift their moves: nothing jumps, limits are kept, and leaping cannot be told from stepping."""

from itertools import pairwise
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.messages.events import Warned
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, StopTask
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.runtime.environment import EmptyEnvironment
from tests.invariants.cases import CASES
from tests.invariants.random_programs import random_program

COUNT = max(CASES // 5, 6)
MODEL = load_model("CS66")
UNTIL_S = 12.0
"""A program that runs longer is cut off, be it in the middle of a braking."""


def shifting(generator):
    """A thread that sets offsets of all kinds: steps, ramps and weaves, in all frames."""

    def number(size):
        return f"{generator.uniform(-size, size):.5f}"

    lines = [
        "  def shifter():",
        "    import math",
        "    path_offset_enable()",
        f"    path_offset_set_alpha_filter({generator.choice((1.0, 0.5, 0.1, 0.02))})",
        f"    path_offset_set_max_offset({generator.choice((0.1, 0.01))}, {generator.choice((0.5, 0.05))})",
    ]
    for _ in range(generator.randrange(1, 5)):
        frame = generator.randrange(1, 4)
        size = generator.choice((0.0005, 0.005, 0.03))
        offset = [number(size) for _ in range(3)] + [number(5 * size) if generator.random() < 0.5 else "0.0"] * 3
        shape = generator.choice(("1", f"math.sin(k * {generator.uniform(0.005, 0.3):.4f})", "k / 60"))
        lines += [
            f"    for k in range({generator.randrange(1, 60)}):",
            f"      f = {shape}",
            f"      path_offset_set([{', '.join(f'{each} * f' for each in offset)}], {frame})",
            f"      sleep({generator.choice((0.004, 0.02, 0.1))})",
            "    end",
        ]
        if generator.random() < 0.3:
            lines.append(f"    path_offset_set([0] * 6, {generator.randrange(1, 4)})")
        if generator.random() < 0.2:
            lines.append(f"    set_tcp([0, {number(0.05)}, 0.1, 0, {number(0.3)}, 0])")
        lines.append(f"    sleep({generator.uniform(0.0, 0.6):.3f})")
        lines.append(f"    textmsg(path_offset_get({generator.randrange(1, 4)}))")
    return [*lines, "  end", "  start_thread(shifter, ())"]


def outcome(seed, pace):
    generator = Random(seed)
    head, *body = random_program(generator).rstrip("\n").split("\n")
    program = "\n".join([head, *shifting(generator), *body]) + "\n"
    robot = VirtualRobot("CS66", world=EmptyEnvironment())
    if generator.random() < 0.4:
        tick = generator.randrange(0, 600)
        robot.controller.put(tick, PauseTask())
        robot.controller.put(tick + generator.randrange(1, 150), ResumeTask())
    if generator.random() < 0.4:
        robot.controller.put(generator.randrange(0, 800), SetSpeedScale(generator.uniform(0.05, 1.0)))
    if generator.random() < 0.2:
        robot.controller.put(generator.randrange(0, 800), StopTask())
    run = robot.run(program, until_s=UNTIL_S, trace=True, pace=pace)
    return program, run.state, run.time_s, run.events, run.trace, run.joints


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(COUNT))
def test_path_offsets_keep_the_invariants(seed):
    program, state, time_s, events, trace, joints = leaped = outcome(seed, None)
    for mine, other in zip(leaped, outcome(seed, lambda tick: None), strict=True):
        assert mine == other, program
    assert state in ("finished", "alarm", "stopped", "time_limit"), program
    for row, following in pairwise(trace):
        parts = zip(MODEL.joints, row.q, row.qd, following.q, following.qd, strict=True)
        for limit, q, w, q_next, w_next in parts:
            where = f"at {row.t} s\n{program}{[event for event in events if isinstance(event, Warned)]}"
            # Between the points of its grid, a Cartesian move keeps the limits to a few percent.
            assert abs(w_next - w) <= limit.qdd_max * PERIOD_S * 1.06, where
            assert abs(w_next) <= limit.qd_max * 1.002, where
            assert limit.q_min - 1e-9 <= q_next <= limit.q_max + 1e-9, where
            assert abs(q_next - q - 0.5 * (w + w_next) * PERIOD_S) <= 0.75 * limit.qdd_max * PERIOD_S**2, where
    if time_s < UNTIL_S:
        assert trace[-1].qd == pytest.approx((0.0,) * 6, abs=1e-12), program
        assert trace[-1].q == joints
