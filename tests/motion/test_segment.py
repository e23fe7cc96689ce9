"""A planned move as a function of time."""

from __future__ import annotations

import random

import pytest

from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.transforms import transform_from_pose
from elitescript.messages.motion import MoveC, MoveJ
from elitescript.motion.planner import plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import Segment
from tests.motion.moves import (
    ARM,
    LIMITS,
    Q_NEAR_WRIST,
    Q_WORK,
    T_FLANGE_TCP,
    largest_difference,
    line_by,
    shifted,
)

Q_END = (0.8, -1.0, -1.6, -2.9, 1.4, 0.3)
VIA = shifted(Q_WORK, 0.1, 0.05)
FAR = shifted(Q_WORK, 0.1, -0.15, 0.0, 0.2, 0.3, -0.2)
SEGMENTS = {
    "movej": plan_movej(ARM, LIMITS, Q_WORK, MoveJ(Q_END, 1.4, 1.05), T_FLANGE_TCP).segment,
    "movel": plan_movel(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, line_by(Q_WORK, 0.1, 0.15, -0.08, 0.2, 0.1, -0.3)).segment,
    "movel near a singularity": plan_movel(
        ARM, LIMITS, Q_NEAR_WRIST, T_FLANGE_TCP, line_by(Q_NEAR_WRIST, 0.05, 0.2, -0.05, v=0.5)
    ).segment,
    "movel that only turns": plan_movel(
        ARM, LIMITS, Q_WORK, T_FLANGE_TCP, line_by(Q_WORK, 0.0, 0.0, 0.0, 0.0, 0.0, 0.7)
    ).segment,
    "movec": plan_movec(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveC(VIA, FAR, 1.2, 0.25)).segment,
    "movec with free orientation": plan_movec(
        ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveC(VIA, FAR, 1.2, 0.25, is_orientation_fixed=False)
    ).segment,
}


@pytest.fixture(params=SEGMENTS.values(), ids=SEGMENTS.keys())
def segment(request: pytest.FixtureRequest) -> Segment:
    moving: Segment = request.param
    return moving


def test_time_outside_the_move_gives_its_ends_at_rest(segment: Segment) -> None:
    for t_s, q in (
        (-1.0, segment.q_start),
        (0.0, segment.q_start),
        (segment.duration_s, segment.q_end),
        (99.0, segment.q_end),
    ):
        assert segment.sample(t_s) == q
        assert segment.sample_speed(t_s) == (0.0,) * 6
        assert segment.tool_speed(t_s) == (0.0, 0.0)


def test_ends_are_approached_without_a_jump(segment: Segment) -> None:
    # A microsecond before the end the arm is within a nanoradian of it.
    assert largest_difference(segment.sample(1e-6), segment.q_start) < 1e-9
    assert largest_difference(segment.sample(segment.duration_s - 1e-6), segment.q_end) < 1e-9


def test_end_pose_is_reached(segment: Segment) -> None:
    T = ARM.forward_tcp(segment.sample(segment.duration_s), T_FLANGE_TCP)
    assert largest_difference(T, segment.T_base_tcp_end) < 1e-9


def test_samples_do_not_depend_on_the_order(segment: Segment) -> None:
    times = [segment.duration_s * k / 40 for k in range(41)]
    in_order = {t_s: segment.setpoint(t_s) for t_s in times}
    random.Random(2).shuffle(times)
    assert {t_s: segment.setpoint(t_s) for t_s in times} == in_order


def test_setpoint_is_sample_and_speed(segment: Segment) -> None:
    for k in range(11):
        t_s = segment.duration_s * k / 10
        assert segment.setpoint(t_s) == (segment.sample(t_s), segment.sample_speed(t_s))


def test_speed_is_the_derivative_of_the_position(segment: Segment) -> None:
    h = 1e-5
    for k in range(1, 40):
        t_s = segment.duration_s * k / 40
        differences = [
            (b - a) / (2.0 * h) for a, b in zip(segment.sample(t_s - h), segment.sample(t_s + h), strict=True)
        ]
        # A corner of the acceleration inside the difference costs up to 40 rad/s^2 times h / 2.
        assert largest_difference(segment.sample_speed(t_s), differences) < 2.5e-4


def test_tool_speed_is_that_of_the_tcp(segment: Segment) -> None:
    for k in range(1, 20):
        t_s = segment.duration_s * k / 20
        q, qd = segment.setpoint(t_s)
        vx, vy, vz, wx, wy, wz = tcp_twist(ARM, q, qd, T_FLANGE_TCP)
        way, turn = segment.tool_speed(t_s)
        assert way == pytest.approx((vx * vx + vy * vy + vz * vz) ** 0.5, abs=1e-9)
        assert turn == pytest.approx((wx * wx + wy * wy + wz * wz) ** 0.5, abs=1e-9)


def test_kind_tells_the_geometry() -> None:
    assert [SEGMENTS[name].kind for name in ("movej", "movel", "movec")] == ["joint", "line", "arc"]


def test_end_pose_of_a_line_is_the_target_itself() -> None:
    request = line_by(Q_WORK, 0.1, 0.15, -0.08, 0.2, 0.1, -0.3)
    assert SEGMENTS["movel"].T_base_tcp_end == transform_from_pose(request.p_target)


def test_many_times_give_what_one_time_gives(segment: Segment) -> None:
    rng = random.Random(11)
    times = sorted([-1.0, 0.0, segment.duration_s, 99.0, *(rng.uniform(0.0, segment.duration_s) for _ in range(60))])
    assert segment.setpoints(times) == [segment.setpoint(t_s) for t_s in times]
    for end in (0, 1, 2, len(times) - 2):
        assert segment.setpoints(times[end:]) == [segment.setpoint(t_s) for t_s in times[end:]]
    assert segment.setpoints([-2.0, -1.0]) == [segment.setpoint(-1.0)] * 2
