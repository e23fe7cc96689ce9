"""Random programs and random single moves, looked at from outside in every control period.

The programs move, drive at a speed, stream, stop and poll, while the slider moves, the task is paused and, in some,
stopped. Whatever they do, the target keeps the limits of the arm, never jumps, and comes to rest where it should.
`ELITESCRIPT_INVARIANTS` sets how many are tried (30 if unset).
"""

from __future__ import annotations

from itertools import pairwise
from math import cos, sin, sqrt
from random import Random

import pytest

from elitescript import VirtualRobot
from elitescript.controller.views.trace import TraceRow
from elitescript.kinematics.transforms import compose, pose_from_transform, transform_from_pose
from elitescript.messages.events import Alarm, Event, MotionEnded, MotionStarted
from elitescript.messages.machine import PauseTask, ResumeTask, SetSpeedScale, StopTask
from elitescript.messages.motion import MoveJ, MoveL
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import RobotModel
from elitescript.runtime.environment import EmptyEnvironment
from tests.findings import Finding
from tests.invariants.cases import CASES
from tests.invariants.random_programs import random_program

pytestmark = pytest.mark.invariants

COUNT = max(CASES, 30)

SPEED_TOLERANCE = 2e-3
"""Relative; Cartesian moves keep the limits at grid points and almost keep them between."""
ACCELERATION_TOLERANCE = 0.06
"""Relative, for the same reason."""
POSE_TOLERANCE = 1e-9
"""m and elements of the rotation matrix, where a line ends."""
LAW_TOLERANCE = 0.01
"""Relative; a period more, because a call returns at the tick after the end."""


class Extremes:
    """The largest shares of the limits that were met."""

    def __init__(self) -> None:
        self.rows = 0
        self.speed = 0.0
        self.acceleration = 0.0
        self.jump_rad = 0.0
        self.ends = 0
        self.stopped = 0

    def take(self, rows: list[TraceRow], model: RobotModel) -> None:
        """Check the rows of a run."""
        self.rows += len(rows)
        for row in rows:
            for q, w, joint in zip(row.q, row.qd, model.joints, strict=True):
                assert joint.q_min - 1e-9 <= q <= joint.q_max + 1e-9, row
                self.speed = max(self.speed, abs(w) / joint.qd_max)
        assert self.speed <= 1.0 + SPEED_TOLERANCE
        for row, later in pairwise(rows):
            for q, w, q_later, w_later, joint in zip(row.q, row.qd, later.q, later.qd, model.joints, strict=True):
                share = abs(w_later - w) / (PERIOD_S * joint.qdd_max)
                # Where the speed is what it says it is, the way is between those at the speeds of both ends.
                jump = abs(q_later - q - 0.5 * (w + w_later) * PERIOD_S)
                assert share <= 1.0 + ACCELERATION_TOLERANCE, (row, later)
                assert jump <= 0.5 * joint.qdd_max * PERIOD_S**2 * (1.0 + ACCELERATION_TOLERANCE), (row, later)
                self.acceleration = max(self.acceleration, share)
                self.jump_rad = max(self.jump_rad, jump)

    def take_ends(self, rows: list[TraceRow], events: list[Event], robot: VirtualRobot) -> None:
        """Check where complete moves that began at standstill, and that no other followed on its way, have ended."""
        by_tick = {round(row.t / PERIOD_S): row for row in rows}
        motions = [event for event in events if isinstance(event, MotionStarted | MotionEnded)]
        for index, (started, ended) in enumerate(pairwise(motions)):
            is_alone = (
                isinstance(started, MotionStarted)
                and isinstance(ended, MotionEnded)
                and not isinstance(motions[index - 1] if index else ended, MotionStarted)
                and not isinstance(motions[index + 2] if index + 2 < len(motions) else started, MotionEnded)
            )
            if not is_alone or not ended.is_complete:
                continue
            request = started.request
            # The row of a tick shows the state of the next.
            row = by_tick.get(ended.tick - 1)
            if row is None or not isinstance(request, MoveJ | MoveL) or request.r > 0.0:
                continue
            self.ends += 1
            assert row.qd == (0.0,) * 6
            if isinstance(request, MoveJ):
                assert row.q == request.q_target
            else:
                reached = robot.model.arm.forward(row.q)
                wanted = transform_from_pose(request.p_target)
                assert max(abs(a - b) for a, b in zip(reached, wanted, strict=True)) < POSE_TOLERANCE


def disturbed_run(seed: int) -> tuple[VirtualRobot, list[TraceRow], list[Event], str]:
    """A random program with whatever may happen to it from outside."""
    chance = Random(f"program {seed}")
    robot = VirtualRobot("CS66", seed=seed, world=EmptyEnvironment())
    for _ in range(chance.randrange(0, 4)):
        robot.at(chance.uniform(0.0, 4.0), f"standard_digital_in[{chance.randrange(4)}]", chance.random() < 0.7)
    for _ in range(chance.randrange(0, 4)):
        robot.controller.put(chance.randrange(0, 800), SetSpeedScale(chance.choice((0.3, 0.6, 1.0))))
    if chance.random() < 0.6:
        tick = chance.randrange(0, 500)
        robot.controller.put(tick, PauseTask())
        robot.controller.put(tick + chance.randrange(0, 200), ResumeTask())
    if chance.random() < 0.3:
        robot.controller.put(chance.randrange(0, 700), StopTask())
    run = robot.run(random_program(chance), until_s=200.0, trace=True)
    return robot, list(run.trace), list(run.events), run.state


@pytest.mark.timeout(600 + COUNT)
def test_random_programs_keep_every_limit_and_never_jump(finding: Finding) -> None:
    extremes = Extremes()
    for seed in range(COUNT):
        robot, rows, events, state = disturbed_run(seed)
        # A motion at a speed may lead to the end of a joint's range or a singularity, which is a protective stop.
        alarms = {event.code for event in events if isinstance(event, Alarm)}
        assert state in ("finished", "stopped") or alarms == {"R140"}, seed
        extremes.take(rows, robot.model)
        extremes.take_ends(rows, events, robot)
        # However it ended, the arm has come to rest and stays there.
        at_rest = robot.state
        assert at_rest.qd_target == (0.0,) * 6
        robot.advance(0.1)
        assert robot.state.q_target == at_rest.q_target
        extremes.stopped += state == "stopped"
    assert extremes.ends > 0.2 * COUNT
    assert extremes.stopped > 0.05 * COUNT
    how = f"{COUNT} programs, {extremes.rows} periods"
    finding("joint speed in random programs", how, f"{100 * extremes.speed:.2f} % of the limit")
    finding("joint acceleration in random programs", how, f"{100 * extremes.acceleration:.2f} % of the limit")
    finding(
        "position against the integral of speed",
        how,
        f"{1e3 * extremes.jump_rad:.3f} mrad; a period at the acceleration limit makes 0.320 mrad",
    )
    finding("end of moves to a target", f"{extremes.ends} moves", f"joints exact, poses within {POSE_TOLERANCE:g} m")


def test_single_moves_last_as_the_trapezoid_law_says(finding: Finding) -> None:
    chance = Random("single moves")
    worst, lawful = 0.0, 0
    for _ in range(COUNT):
        robot = VirtualRobot(chance.choice(("CS63", "CS66", "CS620")), world=EmptyEnvironment())
        kind = chance.choice(("movej", "movel", "movec"))
        a, v = 10 ** chance.uniform(-0.5, 0.6), 10 ** chance.uniform(-1.3, 0.2)
        home = robot.model.home
        if kind == "movej":
            turns = [chance.uniform(-1.5, 1.5) for _ in range(6)]
            way = max(map(abs, turns))
            text = f"movej({[q + turn for q, turn in zip(home, turns, strict=True)]}, a={a}, v={v})"
        elif kind == "movel":
            shift = [chance.uniform(-0.08, 0.08) for _ in range(3)]
            way = sqrt(sum(x * x for x in shift))
            T = transform_from_pose((0.0, 0.0, 0.0, *(chance.gauss(0.0, 0.2) for _ in range(3))))
            x, y, z, *turn = pose_from_transform(compose(robot.model.arm.forward(home), T))
            text = f"movel({[x + shift[0], y + shift[1], z + shift[2], *turn]}, a={a}, v={v})"
        else:
            radius, angle = chance.uniform(0.02, 0.08), chance.uniform(0.5, 3.0)
            way = radius * angle
            x, y, z, *turn = pose_from_transform(robot.model.arm.forward(home))
            via, to = (
                [x - radius * (1.0 - cos(part)), y + radius * sin(part), z, *turn] for part in (0.4 * angle, angle)
            )
            v = min(v, sqrt(robot.model.max_tool_acceleration * radius))
            text = f"movec({via}, {to}, a={a}, v={v}, mode=1)"
        run = robot.run(text)
        if run.state != "finished" or run.warnings:
            continue
        law_s = way / v + v / a if way >= v * v / a else 2.0 * sqrt(way / a)
        lawful += 1
        assert law_s * (1.0 - LAW_TOLERANCE) <= run.time_s <= law_s * (1.0 + LAW_TOLERANCE) + PERIOD_S, text
        worst = max(worst, law_s - run.time_s, run.time_s - PERIOD_S - law_s)
    assert lawful > 0.5 * COUNT
    finding(
        "duration of single moves against the trapezoid law",
        f"{lawful} moves without a warning",
        f"{1e3 * max(0.0, worst):.3f} ms beyond the period in which the call returns",
    )
