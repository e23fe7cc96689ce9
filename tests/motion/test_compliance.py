"""One period of an arm of which a part is given and the rest yields."""

from random import Random

import pytest

from elitescript.controller.motion.control import motion_limits
from elitescript.kinematics.jacobian import joint_speeds, tcp_twist
from elitescript.kinematics.transforms import IDENTITY, transform_from_pose
from elitescript.messages.timing import PERIOD_S
from elitescript.models.model import load_model
from elitescript.motion.corrections.compliance import Compliance, after_way, solved_near, way_between
from elitescript.motion.segment import Setpoint
from elitescript.motion.streaming.speed import Obstacle
from elitescript.motion.streaming.twist import ToolMotion

MODEL = load_model("CS66")
LIMITS = motion_limits(MODEL)
T_FLANGE_TCP = transform_from_pose((0.02, -0.03, 0.12, 0.1, 0.2, 0.3))
COMPLIANCE = Compliance(ToolMotion(MODEL.arm, LIMITS, T_FLANGE_TCP, 8.0), "force_mode")
REST = (0.0,) * 6


def moving(twist, q=MODEL.home):
    return Setpoint(q, joint_speeds(MODEL.arm, q, twist, T_FLANGE_TCP))


def test_standstill_is_kept_to_the_last_bit():
    now = Setpoint(MODEL.home, REST)
    step = COMPLIANCE.next(now, REST, REST, REST, REST)
    assert step.setpoint == now


@pytest.mark.parametrize("seed", range(20))
def test_a_pose_is_reached_by_newton(seed):
    random = Random(seed)
    q = tuple(angle + random.uniform(-0.3, 0.3) for angle in MODEL.home)
    wanted = after_way(MODEL.arm.forward_tcp(q, T_FLANGE_TCP), tuple(random.uniform(-2e-3, 2e-3) for _ in range(6)))
    found = MODEL.arm.forward_tcp(solved_near(MODEL.arm, T_FLANGE_TCP, wanted, q), T_FLANGE_TCP)
    assert found == pytest.approx(wanted, abs=1e-13)


def test_the_way_between_two_poses_leads_from_one_to_the_other():
    T = transform_from_pose((0.1, 0.2, 0.3, 0.4, 0.5, 0.6))
    way = (0.01, -0.02, 0.03, 0.1, -0.2, 0.3)
    assert way_between(T, after_way(T, way)) == pytest.approx(way)


def test_the_given_way_is_kept_exactly_while_the_rest_yields():
    twist = (0.1, 0.0, 0.0, 0.0, 0.0, 0.2)
    state, free = moving(twist), REST
    start = MODEL.arm.forward_tcp(state.q, T_FLANGE_TCP)
    for _ in range(50):
        way = tuple(PERIOD_S * v for v in twist)
        step = COMPLIANCE.next(state, twist, way, free, (0.0, 0.0, 0.05, 0.0, 0.0, 0.0))
        state, free = step.setpoint, step.free
    end = MODEL.arm.forward_tcp(state.q, T_FLANGE_TCP)
    moved = way_between(start, end)
    assert moved[0] == pytest.approx(50 * PERIOD_S * 0.1, abs=1e-12)
    assert moved[1] == pytest.approx(0.0, abs=1e-12)
    assert moved[2] > 0.009
    assert moved[3:] == pytest.approx((0.0, 0.0, 50 * PERIOD_S * 0.2), abs=1e-11)


def test_a_wild_wish_is_taken_as_far_as_the_joints_can():
    step = COMPLIANCE.next(Setpoint(MODEL.home, REST), REST, REST, REST, (3.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert step.is_bound_kept
    assert max(map(abs, step.setpoint.qd)) == pytest.approx(40.0 * PERIOD_S)
    assert step.free[1:] == REST[1:]
    assert tcp_twist(MODEL.arm, *step.setpoint, T_FLANGE_TCP) == pytest.approx(step.free, abs=1e-4)


def test_gently_means_with_the_deceleration_of_a_stop():
    free = (0.3, 0.0, 0.0, 0.0, 0.0, 0.0)
    now = moving(free)
    step = COMPLIANCE.next(now, REST, REST, free, REST, deceleration=8.0)
    change = max(abs(b - a) for a, b in zip(now.qd, step.setpoint.qd, strict=True))
    assert change == pytest.approx(8.0 * PERIOD_S, rel=0.05)


def test_where_the_given_part_is_too_much_the_joints_keep_their_limits_and_it_says_so():
    bound = (2.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    now = Setpoint(MODEL.home, REST)
    step = COMPLIANCE.next(now, bound, tuple(PERIOD_S * v for v in bound), REST, REST)
    assert not step.is_bound_kept
    assert max(map(abs, step.setpoint.qd)) <= 40.0 * PERIOD_S * (1 + 1e-9)


def test_no_joint_jumps_where_the_wrist_crosses_its_singularity_while_it_brakes():
    now = Setpoint(
        (-1.3989207, -1.8533884, -0.4958708, -0.1146049, 3.1431052, 1.0493933),
        (-2.3704766, -2.5465861, 3.0182637, 3.7410963, 0.6348504, 3.685774),
    )
    bound = (-0.8790903, -0.0711401, -1.0494748, -0.0650492, -3.1524663, 0.2942686)
    way = tuple(PERIOD_S * v for v in (-0.8872773, -0.0699076, -1.0461259, -0.0670787, -3.1600326, 0.2942866))
    free = (0.1883454, -0.4797424, 0.5758012, -0.5189958, 3.4672503, -2.1728898)
    bare = Compliance(ToolMotion(MODEL.arm, LIMITS, IDENTITY, 8.0), "force_mode")
    step = bare.next(now, bound, way, free, REST, is_last_resort=True)
    assert not step.is_bound_kept
    for q, w, q_later, w_later, top in zip(*now, *step.setpoint, LIMITS.qdd_max, strict=True):
        assert abs(q_later - q - 0.5 * PERIOD_S * (w + w_later)) <= 0.5 * top * PERIOD_S**2


def test_an_obstacle_is_one_when_a_stop_would_end_beyond_it():
    near = (*MODEL.home[:5], LIMITS.q_max[5] - 0.01)
    turn = (0.0, 0.0, -0.5, 0.0, 0.0, 0.0)
    twist = tcp_twist(MODEL.arm, near, (0.0, 0.0, 0.0, 0.0, 0.0, 0.5), T_FLANGE_TCP)
    found = COMPLIANCE.next(moving(twist, near), REST, REST, twist, twist)
    assert isinstance(found, Obstacle)
    assert found.code == "R110"
    assert "force_mode takes joint wrist3" in found.text
    assert not isinstance(COMPLIANCE.next(moving(turn, near), REST, REST, turn, turn), Obstacle)


def test_a_singular_arm_is_an_obstacle_and_can_only_halt():
    q = (0.0, -1.0, 0.0, -1.0, 1.0, 0.0)
    found = COMPLIANCE.next(Setpoint(q, REST), REST, REST, REST, (0.0, 0.0, 0.1, 0.0, 0.0, 0.0))
    assert isinstance(found, Obstacle)
    assert "force_mode leads into the elbow singularity" in found.text
    state = Setpoint(q, (0.5, -0.1, 0.0, 0.01, 0.0, 0.0))
    for _ in range(20):
        after = COMPLIANCE.halted(state)
        assert all(abs(b - a) <= 8.0 * PERIOD_S + 1e-12 for a, b in zip(state.qd, after.qd, strict=True))
        state = after
    assert state.qd == REST
