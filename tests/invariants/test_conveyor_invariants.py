"""Random programs on random conveyors: nothing jumps, limits are kept, and leaping cannot be told from stepping."""

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

COUNT = CASES // 10
MODEL = load_model("CS66")


UNTIL_S = 6.0
"""A program that runs longer is cut off, be it in the middle of a braking."""


def random_program(generator):
    """A program that goes along with a conveyor a few times."""

    def number(low, high):
        return f"{generator.uniform(low, high):.4f}"

    lines = ["def job():", "  home = get_target_tcp_pose()", "  def near():", "    pose = get_target_tcp_pose()"]
    lines += [f"    pose[{k}] = home[{k}] + {number(-0.08, 0.08)}" for k in range(3)]
    lines += ["    return pose", "  end", f"  set_tcp([0, {number(-0.05, 0.05)}, 0.1, 0, {number(-0.3, 0.3)}, 0])"]
    is_supplied = generator.random() < 0.3
    if is_supplied:
        first, step = generator.randrange(256), generator.randrange(-12, 13)
        lines += [
            "  def belt():",
            f"    count = {first}",
            "    while True:",
            "      encoder_set_tick_count(0, count)",
            f"      count = (count + {step}) % 256",
            f"      sleep({generator.choice((0.004, 0.02, 0.05))})",
            "    end",
            "  end",
            "  encoder_enable_set_tick_count(0, 1)",
            "  start_thread(belt, ())",
        ]
    for _ in range(generator.randrange(1, 4)):
        if generator.random() < 0.5:
            direction = ", ".join(number(-1, 1) for _ in range(3))
            lines.append(f"  track_conveyor_linear([{direction}, 0, 0, 0], {generator.choice((1000, -3000))})")
        else:
            center = ", ".join(number(-0.4, 0.4) for _ in range(6))
            turns = generator.choice(("True", "False"))
            lines.append(f"  track_conveyor_circular([{center}], {generator.choice((2500, -6000))}, {turns})")
        for _ in range(generator.randrange(0, 4)):
            lines.append(
                generator.choice(
                    (
                        "  movel(near(), v=0.2)",
                        f"  sleep({number(0.0, 0.6)})",
                        f"  speedl([0, {number(-0.1, 0.1)}, 0.02, 0, 0, 0.1], 0.5, 0.2)\n  stopl(1)",
                        "  get_joint_torques()",
                        "  encoder_get_tick_count(0)",
                    )
                )
            )
        lines.append("  stop_conveyor_tracking()")
    return "\n".join([*lines, "end"]) + "\n"


def outcome(seed, pace):
    generator = Random(seed)
    program = random_program(generator)
    robot = VirtualRobot("CS66", world=EmptyEnvironment())
    for _ in range(generator.randrange(1, 5)):
        robot.at(generator.uniform(0.0, 2.0), "encoder_speed[0]", generator.uniform(-250.0, 250.0))
    if generator.random() < 0.4:
        tick = generator.randrange(0, 300)
        robot.controller.put(tick, PauseTask())
        robot.controller.put(tick + generator.randrange(1, 150), ResumeTask())
    if generator.random() < 0.4:
        robot.controller.put(generator.randrange(0, 400), SetSpeedScale(generator.uniform(0.05, 1.0)))
    if generator.random() < 0.2:
        robot.controller.put(generator.randrange(0, 400), StopTask())
    run = robot.run(program, until_s=UNTIL_S, trace=True, pace=pace)
    return program, run.state, run.time_s, run.events, run.trace, run.joints


@pytest.mark.invariants
@pytest.mark.parametrize("seed", range(max(COUNT, 10)))
def test_conveyors_keep_the_invariants(seed):
    program, state, time_s, events, trace, joints = leaped = outcome(seed, None)
    for mine, other in zip(leaped, outcome(seed, lambda tick: None), strict=True):
        assert mine == other, program
    assert state in ("finished", "alarm", "stopped", "time_limit"), program
    for row, following in pairwise(trace):
        parts = zip(MODEL.joints, row.q, row.qd, following.q, following.qd, strict=True)
        for limit, q, w, q_next, w_next in parts:
            where = f"at {row.t} s\n{program}{[event for event in events if isinstance(event, Warned)]}"
            assert abs(w_next - w) <= limit.qdd_max * PERIOD_S * (1 + 1e-6), where
            assert abs(w_next) <= limit.qd_max * (1 + 1e-9), where
            assert limit.q_min <= q_next <= limit.q_max, where
            assert abs(q_next - q - 0.5 * (w + w_next) * PERIOD_S) <= 0.25 * limit.qdd_max * PERIOD_S**2, where
    if time_s < UNTIL_S:
        assert trace[-1].qd == pytest.approx((0.0,) * 6, abs=1e-12), program
        assert trace[-1].q == joints
