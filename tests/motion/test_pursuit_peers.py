"""Catching up takes the time, and goes the way, that Ruckig finds for the same two states and bounds."""

from math import inf
from random import Random

import pytest

from elitescript.motion.timing.pursuit import CatchUp

ruckig = pytest.importorskip("ruckig")
pytestmark = pytest.mark.peers


def test_is_the_quickest_law():
    generator = Random(21)
    for _ in range(500):
        a, v = generator.uniform(0.2, 5.0), generator.uniform(0.1, 1.0)
        lag, rate = generator.uniform(-0.5, 0.5), generator.uniform(-v, v)
        problem = ruckig.InputParameter(1)
        problem.current_position, problem.current_velocity = [lag], [rate]
        problem.target_position, problem.target_velocity = [0.0], [0.0]
        problem.max_velocity, problem.max_acceleration, problem.max_jerk = [v], [a], [inf]
        trajectory = ruckig.Trajectory(1)
        ruckig.Ruckig(1).calculate(problem, trajectory)
        law = CatchUp(lag, rate, a, v)
        assert law.duration_s == pytest.approx(trajectory.duration, rel=1e-9, abs=1e-9)
        for share in (0.1, 0.35, 0.6, 0.85):
            position, speed, _ = trajectory.at_time(share * trajectory.duration)
            assert law.at(share * law.duration_s) == pytest.approx((position[0], speed[0]), abs=1e-8)
