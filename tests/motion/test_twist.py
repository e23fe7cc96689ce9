"""The TCP at a commanded velocity, period by period."""

from itertools import pairwise
from math import dist
from random import Random

import pytest

from elitescript.kinematics.jacobian import joint_speeds, singularity, tcp_twist
from elitescript.kinematics.transforms import IDENTITY, position_of, transform_from_pose
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle, obstacle_at
from elitescript.motion.streaming.twist import ToolMotion, TwistState, _towards
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


def scaled(six, factor):
    return tuple(value * factor for value in six)


def moved(q, qd, time_s):
    return tuple(angle + w * time_s for angle, w in zip(q, qd, strict=True))


def next_by_the_book(tool, state, target, a, a_rot):
    """The law of `ToolMotion.next`, as its module says it; None in front of an obstacle."""
    arm, limits = tool.arm, tool.limits
    twist = _towards(state.twist, target, a * PERIOD_S, a_rot * PERIOD_S)
    q_ahead = moved(state.q, state.qd, PERIOD_S)
    wanted = None if singularity(arm, q_ahead).blocked else joint_speeds(arm, q_ahead, twist, tool.T_flange_tcp)
    if wanted is None:
        return None
    least, most = 0.0, 1.0
    for w, w_wanted, top, a_top in zip(state.qd, wanted, limits.qd_max, limits.qdd_max, strict=True):
        if w_wanted:
            sign, change = (1.0 if w_wanted > 0.0 else -1.0), a_top * PERIOD_S
            most = min(most, top / abs(w_wanted), (sign * w + change) / abs(w_wanted))
            least = max(least, (sign * w - change) / abs(w_wanted))
    is_slowed = most < 1.0
    if most >= 0.0 and least <= most:
        qd = wanted if most == 1.0 else scaled(wanted, most)
        twist = twist if most == 1.0 else scaled(twist, most)
    else:
        qd = scaled(wanted, min([1.0] + [top / abs(w) for w, top in zip(wanted, limits.qd_max, strict=True) if w]))
    share = tool._share_of_change(state.qd, qd)
    if share < 1.0:
        qd = tuple(w + share * (w_new - w) for w, w_new in zip(state.qd, qd, strict=True))
        is_slowed = True
    q = moved(state.q, [0.5 * (w + w_new) for w, w_new in zip(state.qd, qd, strict=True)], PERIOD_S)
    if obstacle_at(q, qd, tool.deceleration, limits) is not None:
        return None
    q_stop = moved(q, qd, 0.5 * max(map(abs, qd)) / tool.deceleration)
    for distance, distance_stop in zip(tool._distances(q), tool._distances(q_stop), strict=True):
        if distance * distance_stop <= 0.0 and distance != distance_stop:
            return None
    if singularity(arm, q_stop).blocked:
        return None
    return TwistState(q, qd, tcp_twist(arm, q, qd, tool.T_flange_tcp) if share < 1.0 else twist, is_slowed)


@pytest.mark.parametrize("seed", range(20))
def test_every_bit_is_that_of_the_law(seed):
    chance = Random(seed)
    tool = motion(TOOL)
    q = tuple(angle + chance.uniform(-0.5, 0.5) for angle in MODEL.home)
    state = tool.begin(Setpoint(q, tuple(chance.uniform(-0.3, 0.3) for _ in range(6))))
    for tick in range(400):
        if tick % 20 == 0:
            target = tuple(chance.uniform(-0.6, 0.6) for _ in range(3)) + tuple(chance.uniform(-3, 3) for _ in range(3))
            a, a_rot = chance.uniform(0.2, 20), chance.uniform(0.2, 20)
        expected, after = next_by_the_book(tool, state, target, a, a_rot), tool.next(state, target, a, a_rot)
        assert isinstance(after, Obstacle) == (expected is None)
        if isinstance(after, Obstacle):
            break
        assert repr(after) == repr(expected)
        state = after
    assert tick > 20
