"""The TCP at a commanded velocity, period by period."""

from itertools import pairwise
from math import dist
from random import Random

import pytest

from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import IDENTITY, position_of, transform_from_pose
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle
from elitescript.motion.streaming.twist import ToolMotion
from tests.motion.moves import limits_of

MODEL = load_model("CS66")
LIMITS = limits_of("CS66")
ZEROS = (0.0,) * 6
TOOL = transform_from_pose((0.02, -0.03, 0.1, 0.1, 0.2, 0.3))


def motion(T_flange_tcp=IDENTITY):
    return ToolMotion(MODEL.arm, LIMITS, T_flange_tcp, 8.0)


def run(tool, state, target, a, a_rot, ticks):
    rows = [state]
    for _ in range(ticks):
        state = tool.next(state, target, a, a_rot)
        rows.append(state)
        if isinstance(state, Obstacle):
            break
    return rows


def test_the_velocity_is_reached_with_the_accelerations_and_kept_on_a_line():
    tool = motion(TOOL)
    start = tool.begin(Setpoint(MODEL.home, ZEROS))
    rows = run(tool, start, (0.0, 0.1, 0.0, 0.0, 0.0, 0.2), 0.5, 0.4, 250)
    reached = tcp_twist(MODEL.arm, rows[125].q, rows[125].qd, TOOL)
    assert reached == pytest.approx((0.0, 0.1, 0.0, 0.0, 0.0, 0.2), abs=2e-5)
    early = tcp_twist(MODEL.arm, rows[25].q, rows[25].qd, TOOL)
    assert early == pytest.approx((0.0, 0.05, 0.0, 0.0, 0.0, 0.04), abs=2e-5)
    x, y, z = position_of(MODEL.arm.forward_tcp(MODEL.home, TOOL))
    way = 0.1 * (1.0 - 0.1)
    assert dist(position_of(MODEL.arm.forward_tcp(rows[-1].q, TOOL)), (x, y + way, z)) < 2e-6


def test_a_velocity_above_the_limits_of_the_tool_keeps_its_direction():
    twist = motion().within_limits((0.0, 2.0 * LIMITS.tool_speed_max, 0.0, 0.0, 0.0, 1.0))
    assert twist == pytest.approx((0.0, LIMITS.tool_speed_max, 0.0, 0.0, 0.0, 0.5))


@pytest.mark.parametrize("seed", range(30))
def test_no_joint_exceeds_a_limit_whatever_the_velocity_and_the_way_ends_in_front_of_an_obstacle(seed):
    chance = Random(seed)
    tool = motion(TOOL)
    q = tuple(angle + chance.uniform(-0.5, 0.5) for angle in MODEL.home)
    start = Setpoint(q, tuple(chance.uniform(-0.3, 0.3) for _ in range(6)))
    target = tuple(chance.uniform(-0.5, 0.5) for _ in range(3)) + tuple(chance.uniform(-1, 1) for _ in range(3))
    rows = run(tool, tool.begin(start), target, chance.uniform(0.2, 20), chance.uniform(0.2, 20), 20000)
    assert isinstance(rows[-1], Obstacle)
    assert rows[-1].code in ("R110", "R112")
    for before, after in pairwise(rows[:-1]):
        for joint in range(6):
            assert abs(after.qd[joint]) <= LIMITS.qd_max[joint] * (1 + 1e-9)
            change = abs(after.qd[joint] - before.qd[joint])
            assert change <= LIMITS.qdd_max[joint] * PERIOD_S * (1 + 1e-6)
            assert after.q[joint] - before.q[joint] == pytest.approx(
                0.5 * (after.qd[joint] + before.qd[joint]) * PERIOD_S, abs=1e-12
            )
            assert LIMITS.q_min[joint] <= after.q[joint] <= LIMITS.q_max[joint]


def test_a_velocity_that_a_joint_cannot_follow_is_lowered_in_its_direction():
    tool = motion()
    state = tool.begin(Setpoint(MODEL.home, ZEROS))
    target = (0.0, 0.0, 0.0, 0.0, 0.0, LIMITS.tool_turn_speed_max)
    state = run(tool, state, target, 40.0, 100.0, 60)[-1]
    assert state.is_slowed
    assert max(abs(w) / top for w, top in zip(state.qd, LIMITS.qd_max, strict=True)) == pytest.approx(1.0)
    vx, vy, vz, wx, wy, wz = tcp_twist(MODEL.arm, state.q, state.qd)
    assert (vx, vy, vz, wx, wy) == pytest.approx((0.0,) * 5, abs=2e-3)
    assert wz > 1.0
