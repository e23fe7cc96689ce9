"""Trapezoids against Ruckig, which finds the quickest motion between two states.

Without a jerk limit its motion is the trapezoid or triangle, so that durations have to agree;
positions in between agree too, since the quickest motion of one joint is unique.
"""

from __future__ import annotations

import random
from math import inf
from typing import Any

import pytest

from elitescript.messages.motion import MoveJ
from elitescript.motion.planner import plan_movej
from elitescript.motion.profile import trapezoid
from tests.motion.moves import ARM, LIMITS, six

ruckig = pytest.importorskip("ruckig")
pytestmark = pytest.mark.peers

CASES = 200


def quickest(start: list[float], end: list[float], v: list[float], a: list[float]) -> Any:
    """Ruckig's trajectory from rest to rest."""
    joints = len(start)
    problem = ruckig.InputParameter(joints)
    problem.current_position, problem.target_position = start, end
    problem.max_velocity, problem.max_acceleration, problem.max_jerk = v, a, [inf] * joints
    trajectory = ruckig.Trajectory(joints)
    ruckig.Ruckig(joints).calculate(problem, trajectory)
    return trajectory


def test_trapezoid_is_the_quickest_motion() -> None:
    rng = random.Random(4)
    for _ in range(CASES):
        length, v, a = 10 ** rng.uniform(-3, 1), 10 ** rng.uniform(-2, 1), 10 ** rng.uniform(-1, 1.5)
        ours, theirs = trapezoid(length, v, a), quickest([0.0], [length], [v], [a])
        assert ours.duration_s == pytest.approx(theirs.duration, rel=1e-9)
        for share in (0.1, 0.4, 0.7, 0.95):
            position, speed, _ = theirs.at_time(share * theirs.duration)
            assert ours.at(share * ours.duration_s) == pytest.approx((position[0], speed[0]), abs=1e-8)


def test_movej_of_one_joint_at_its_limits_is_the_quickest() -> None:
    rng = random.Random(5)
    for _ in range(CASES):
        joint = rng.randrange(6)
        q_start = six(rng.uniform(-3, 3) for _ in range(6))
        q_end = six(q + (index == joint) * rng.uniform(-2, 2) for index, q in enumerate(q_start))
        ours = plan_movej(ARM, LIMITS, q_start, MoveJ(q_end, 1e3, 1e3)).segment
        theirs = quickest(list(q_start), list(q_end), list(LIMITS.qd_max), list(LIMITS.qdd_max))
        assert ours.duration_s == pytest.approx(theirs.duration, rel=1e-9)


def test_movej_of_all_joints_is_never_quicker_than_possible() -> None:
    rng = random.Random(6)
    for _ in range(CASES):
        q_start, q_end = (six(rng.uniform(-3, 3) for _ in range(6)) for _ in range(2))
        ours = plan_movej(ARM, LIMITS, q_start, MoveJ(q_end, 1e3, 1e3)).segment
        theirs = quickest(list(q_start), list(q_end), list(LIMITS.qd_max), list(LIMITS.qdd_max))
        assert theirs.duration * (1.0 - 1e-9) <= ours.duration_s <= 1.05 * theirs.duration
