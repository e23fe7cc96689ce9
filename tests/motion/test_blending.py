"""Blends of two moves: continuous, within limits, inside the sphere, exact at the end."""

from __future__ import annotations

import random
from dataclasses import replace
from math import ceil, cos, dist, hypot, radians, sin, sqrt

import pytest

from elitescript.kinematics.jacobian import tcp_twist
from elitescript.kinematics.rotations import multiply
from elitescript.kinematics.transforms import pose_from_transform, position_of, rotation_of, transform_from_pose
from elitescript.messages.motion import MoveC, MoveJ, MoveL, MoveRequest, Six
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.blending import blended
from elitescript.motion.limits import MotionLimits
from elitescript.motion.planner import APPROACH_SHARE, Plan, plan_movec, plan_movej, plan_movel
from elitescript.motion.segment import BlendedSegment
from tests.motion.moves import ARM, LIMITS, Q_WORK, T_FLANGE_TCP, UNBOUND, largest_difference, six, tcp_pose

STEP_S = 1e-5


def plan(request: MoveRequest, q_start: Six, limits: MotionLimits = LIMITS, *, is_entered: bool = False) -> Plan:
    if isinstance(request, MoveJ):
        return plan_movej(ARM, limits, q_start, request, T_FLANGE_TCP)
    if isinstance(request, MoveC):
        return plan_movec(ARM, limits, q_start, T_FLANGE_TCP, request, is_entered=is_entered)
    assert isinstance(request, MoveL)
    return plan_movel(ARM, limits, q_start, T_FLANGE_TCP, request, is_entered=is_entered)


class Turn:
    """Two moves and the blend between them, at the first period inside the zone."""

    def __init__(self, first: MoveRequest, second: MoveRequest, limits: MotionLimits = LIMITS) -> None:
        self.limits = limits
        self.first = plan(first, Q_WORK, limits)
        self.second = plan(second, self.first.segment.q_end, limits, is_entered=True)
        assert self.first.zone is not None
        self.radius = self.first.zone.radius
        entry_s = self.first.segment.time_at(self.first.zone.begin)
        self.t_s = ceil(entry_s / PERIOD_S - 1e-9) * PERIOD_S
        self.segment = blended(ARM, limits, self.first, self.t_s, self.second, T_FLANGE_TCP)

    @property
    def blend(self) -> BlendedSegment:
        assert self.segment is not None
        return self.segment

    @property
    def speed_before(self) -> float:
        return self.first.segment.profile.at(self.t_s)[1]

    @property
    def waypoint(self) -> tuple[float, ...]:
        return position_of(ARM.forward_tcp(self.first.segment.q_end, T_FLANGE_TCP))

    def check(self) -> None:
        """What holds for every blend."""
        blend, limits = self.blend, self.limits
        before = self.first.segment.setpoint(self.t_s)
        assert largest_difference(before.q, blend.sample(0.0)) < 1e-12
        assert largest_difference(before.qd, blend.sample_speed(0.0)) < 1e-9
        for corner_s in (blend.approach_s, blend.entered_s):
            here, ahead = blend.setpoint(corner_s - 1e-9), blend.setpoint(corner_s)
            assert largest_difference(here.q, ahead.q) < 1e-8
            assert largest_difference(here.qd, ahead.qd) < 1e-6
        assert blend.setpoint(blend.duration_s) == (self.second.segment.q_end, (0.0,) * 6)
        for k in range(200):
            t_s = (blend.duration_s - STEP_S) * (k + 0.5) / 200
            here, ahead = blend.setpoint(t_s), blend.setpoint(t_s + STEP_S)
            mean = [0.5 * (a + b) * STEP_S for a, b in zip(here.qd, ahead.qd, strict=True)]
            ways = [b - a for a, b in zip(here.q, ahead.q, strict=True)]
            assert largest_difference(ways, mean) < 1e-9
            for w, w_ahead, top, a_top in zip(here.qd, ahead.qd, limits.qd_max, limits.qdd_max, strict=True):
                assert abs(w) <= top * 1.002
                assert abs(w_ahead - w) <= a_top * STEP_S * 1.03 + 1e-9
        # Inside the sphere the path stays from the begin of the blend to its end.
        for k in range(60):
            T = ARM.forward_tcp(blend.sample(blend.entered_s * k / 60), T_FLANGE_TCP)
            assert dist(position_of(T), self.waypoint) <= self.radius * (1.0 + 1e-6)

    def tool_acceleration(self) -> float:
        """Largest acceleration of the TCP on approach and corner, m/s^2."""
        largest = 0.0
        for k in range(120):
            t_s = (self.blend.entered_s - STEP_S) * k / 120
            largest = max(largest, dist(self.velocity(t_s), self.velocity(t_s + STEP_S)) / STEP_S)
        return largest

    def velocity(self, t_s: float) -> tuple[float, ...]:
        q, qd = self.blend.setpoint(t_s)
        return tcp_twist(ARM, q, qd, T_FLANGE_TCP)[:3]


def corner(
    angle: float, r: float, v: float, *, length: float = 0.1, a: float = 1.2, turn: float = 0.0
) -> tuple[MoveL, MoveL]:
    """Two lines with an angle between them, the tool turning about different axes."""
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    waypoint = (x, y - length, z, rx, ry, rz + turn)
    end = (x, y - length - length * cos(angle), z + length * sin(angle), rx + turn, ry, rz + turn)
    return MoveL(waypoint, a, v, 0.0, r), MoveL(end, a, v)


@pytest.mark.parametrize("turn", [0.0, 0.15], ids=["fixed", "turning"])
@pytest.mark.parametrize(("r", "v"), [(0.01, 0.1), (0.01, 0.5), (0.05, 0.25), (0.0005, 0.05)])
@pytest.mark.parametrize("degrees", [0, 5, 30, 60, 90, 120, 150, 175])
def test_lines_of_any_angle_turn_within_the_acceleration(degrees: int, r: float, v: float, turn: float) -> None:
    case = Turn(*corner(radians(degrees), r, v, turn=turn))
    case.check()
    assert case.tool_acceleration() <= 1.2 * (1.0 + 1e-4)
    # It never stands still.
    assert case.blend.profile.at(0.0)[1] > 0.2 * case.speed_before


def test_a_radius_that_covers_the_braking_keeps_the_commanded_speed() -> None:
    case = Turn(*corner(radians(60), 0.03, 0.2))
    assert 2.0 * APPROACH_SHARE * 1.2 * 0.03 > 0.2**2
    assert case.speed_before == 0.2
    assert case.blend.profile.at(0.0)[1] == pytest.approx(0.2)


def test_a_radius_that_does_not_is_entered_at_the_speed_from_which_the_arm_can_stop() -> None:
    case = Turn(*corner(0.0, 0.01, 0.5))
    entered = sqrt(2.0 * APPROACH_SHARE * 1.2 * 0.01)
    assert case.first.segment.profile.speed_at_position(0.09) == pytest.approx(entered, rel=1e-9)
    assert entered - APPROACH_SHARE * 1.2 * PERIOD_S <= case.speed_before <= entered


def test_the_corner_of_two_lines_is_a_parabola() -> None:
    case = Turn(*corner(radians(90), 0.03, 0.2))
    blend = case.blend
    first, last = case.velocity(blend.approach_s), case.velocity(blend.entered_s)
    for share in (0.25, 0.5, 0.75):
        expected = [(1.0 - share) * a + share * b for a, b in zip(first, last, strict=True)]
        assert case.velocity(blend.approach_s + share * blend.corner.length) == pytest.approx(expected, abs=1e-7)


def test_a_straight_chain_stays_on_its_line_while_the_tool_turns_evenly() -> None:
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    T = transform_from_pose((x, y, z, rx, ry, rz))

    def turned(way: float) -> Six:
        turn = transform_from_pose((0.0, 0.0, 0.0, 0.0, 0.0, 3.0 * way))
        return pose_from_transform((*multiply(rotation_of(turn), rotation_of(T)), x, y - way, z))

    case = Turn(MoveL(turned(0.05), 1.2, 0.1, 0.0, 0.01), MoveL(turned(0.1), 1.2, 0.1))
    blend = case.blend
    case.check()
    for k in range(101):
        T_now = ARM.forward_tcp(blend.sample(blend.duration_s * k / 100), T_FLANGE_TCP)
        way = y - T_now[10]
        assert abs(T_now[9] - x) < 1e-9 and abs(T_now[11] - z) < 1e-9
        assert largest_difference(T_now, transform_from_pose(turned(way))) < 1e-8
    assert case.velocity(0.5 * blend.entered_s) == pytest.approx((0.0, -0.1, 0.0), abs=1e-9)


JOINTS_A = six(q + d for q, d in zip(Q_WORK, (0.3, 0.2, -0.25, 0.1, 0.1, 0.4), strict=True))
JOINTS_B = six(q + d for q, d in zip(JOINTS_A, (0.3, -0.2, 0.3, -0.2, 0.1, -0.3), strict=True))


def shifted_from(q: Six, *offset: float) -> Six:
    return six(p + d for p, d in zip(tcp_pose(q), (*offset, *(0.0,) * (6 - len(offset))), strict=True))


def second_moves(q: Six) -> dict[str, MoveRequest]:
    end = shifted_from(q, 0.05, -0.08, 0.02)
    return {
        "movej": MoveJ(six(a + d for a, d in zip(q, (0.3, -0.2, 0.3, -0.2, 0.1, -0.3), strict=True)), 1.4, 1.0),
        "movel": MoveL(end, 1.2, 0.25),
        "movec": MoveC(shifted_from(q, 0.05, -0.02), end, 1.2, 0.25),
    }


def first_moves() -> dict[str, MoveRequest]:
    end = shifted_from(Q_WORK, 0.1, -0.08, 0.02)
    return {
        "movej": MoveJ(JOINTS_A, 1.4, 1.0),
        "movel": MoveL(end, 1.2, 0.25),
        "movec": MoveC(shifted_from(Q_WORK, 0.08, -0.02), end, 1.2, 0.25, is_orientation_fixed=False),
    }


def with_radius(request: MoveRequest, r: float, t_s: float = 0.0) -> MoveRequest:
    return replace(request, r=r, t_s=t_s) if t_s else replace(request, r=r)


@pytest.mark.parametrize("r", [0.002, 0.02, 0.2])
@pytest.mark.parametrize("second", ["movej", "movel", "movec"])
@pytest.mark.parametrize("first", ["movej", "movel", "movec"])
def test_any_two_kinds_blend(first: str, second: str, r: float) -> None:
    request = with_radius(first_moves()[first], r)
    case = Turn(request, second_moves(plan(request, Q_WORK).segment.q_end)[second])
    case.check()
    assert case.blend.kind == case.second.segment.kind
    if "movej" not in (first, second):
        limit = max(case.first.tool_acceleration, case.second.tool_acceleration)
        assert case.tool_acceleration() <= limit * 1.02


def test_joint_moves_keep_the_acceleration_of_both() -> None:
    case = Turn(MoveJ(JOINTS_A, 1.4, 1.0, 0.0, 0.02), MoveJ(JOINTS_B, 0.7, 1.0))
    case.check()
    blend = case.blend
    for k in range(50):
        t_s = (blend.entered_s - STEP_S) * k / 50
        here, ahead = blend.setpoint(t_s), blend.setpoint(t_s + STEP_S)
        assert largest_difference(here.qd, ahead.qd) <= 1.4 * STEP_S * (1.0 + 1e-6)


def test_a_short_second_move_lets_the_first_go_on() -> None:
    x, y, z, rx, ry, rz = tcp_pose(Q_WORK)
    first = MoveL((x, y - 0.1, z, rx, ry, rz), 1.2, 0.1, 0.0, 0.04)
    case = Turn(first, MoveL((x, y - 0.1, z + 0.004, rx, ry, rz), 1.2, 0.1))
    case.check()
    assert case.blend.approach_s > 0.2
    assert case.blend.corner.length < 0.15


def test_a_blend_takes_at_most_half_of_either_move() -> None:
    case = Turn(*corner(radians(40), 0.09, 0.1, length=0.1))
    assert case.radius == pytest.approx(0.05)
    assert [note.kind for note in case.first.notes] == ["radius_shortened"]
    assert "r = 0.09 m" in case.first.notes[0].text and "0.05 m" in case.first.notes[0].text
    assert case.blend.profile.start <= 0.05 + 1e-12


def test_a_prescribed_duration_of_the_second_move_is_kept_from_the_begin_of_the_blend() -> None:
    first, second = corner(radians(90), 0.02, 0.2)
    case = Turn(first, MoveL(second.p_target, 1.2, 0.2, 1.7))
    case.check()
    assert case.blend.duration_s == pytest.approx(1.7, abs=1e-9)


def test_a_prescribed_duration_of_the_first_move_is_kept_up_to_the_blend() -> None:
    first, second = corner(radians(90), 0.02, 0.2)
    timed = MoveL(first.p_target, 1.2, 0.2, 1.3, 0.02)
    case = Turn(timed, second)
    case.check()
    alone = plan(MoveL(first.p_target, 1.2, 0.2, 1.3), Q_WORK)
    assert case.first.segment.duration_s == alone.segment.duration_s == 1.3
    assert largest_difference(case.first.segment.sample(case.t_s), alone.segment.sample(case.t_s)) < 1e-12


def test_no_second_way_means_no_blend() -> None:
    first, _ = corner(0.0, 0.02, 0.2)
    assert Turn(first, MoveL(first.p_target, 1.2, 0.2)).segment is None


def test_weak_joints_lower_the_speed_of_the_second_move_and_stay_within_limits() -> None:
    weak = replace(UNBOUND, qdd_max=(1.5,) * 6)
    for degrees in (0, 90, 150):
        first, second = corner(radians(degrees), 0.02, 0.3)
        case = Turn(first, second, weak)
        if case.segment is not None:
            case.check()
            strong = Turn(first, second).blend.profile.at(0.0)[1]
            # A period earlier or later makes a little difference.
            assert case.blend.profile.at(0.0)[1] <= strong * 1.02


def test_samples_do_not_depend_on_the_order() -> None:
    blend = Turn(*corner(radians(70), 0.02, 0.2, turn=0.1)).blend
    times = [blend.duration_s * k / 40 for k in range(-1, 42)]
    in_order = {t_s: blend.setpoint(t_s) for t_s in times}
    random.Random(3).shuffle(times)
    assert {t_s: blend.setpoint(t_s) for t_s in times} == in_order


def test_tool_speed_is_that_of_the_tcp() -> None:
    case = Turn(*corner(radians(70), 0.03, 0.2))
    blend = case.blend
    for k in range(1, 20):
        t_s = blend.duration_s * k / 20
        speed = hypot(*case.velocity(t_s))
        bound = blend.tool_speed(t_s)[0]
        # In the corner it is a bound: a stop may be planned from it.
        assert speed <= bound + 1e-9
        if t_s > blend.entered_s:
            assert bound == pytest.approx(speed, abs=1e-9)


def test_random_pairs_keep_everything() -> None:
    rng = random.Random("pairs")
    blends = 0
    for _ in range(60):
        request = with_radius(first_moves()[rng.choice(["movej", "movel", "movec"])], 10 ** rng.uniform(-4, -0.5))
        q_end = plan(request, Q_WORK).segment.q_end
        x, y, z, *angles = tcp_pose(q_end)
        end = six(
            (
                *(p + rng.uniform(-0.08, 0.08) for p in (x, y, z)),
                *(p + rng.choice((0.0, rng.uniform(-0.3, 0.3))) for p in angles),
            )
        )
        a, v = 10 ** rng.uniform(-0.5, 0.5), 10 ** rng.uniform(-2, 0)
        second: MoveRequest = rng.choice(
            (MoveL(end, a, v), MoveJ(six(q + rng.uniform(-0.4, 0.4) for q in q_end), a, v))
        )
        case = Turn(request, second)
        if case.segment is not None:
            case.check()
            blends += 1
    assert blends > 50
