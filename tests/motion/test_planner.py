"""Requests become moves with the right duration, or are refused with the right numbers."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, dist, inf, nan, pi, sqrt

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.jacobian import singularity
from elitescript.kinematics.rotations import multiply, rotation_from_rotvec
from elitescript.kinematics.transforms import (
    interpolate,
    pose_from_transform,
    position_of,
    rotation_of,
    transform_from_pose,
)
from elitescript.messages.motion import MoveC, MoveJ, MoveL, Six
from elitescript.motion.planner import MoveNoteKind, Plan, plan_movec, plan_movej, plan_movel
from tests.motion.moves import (
    ARM,
    LIMITS,
    Q_NEAR_WRIST,
    Q_WORK,
    T_FLANGE_TCP,
    UNBOUND,
    largest_difference,
    limits_of,
    line_by,
    shifted,
    six,
    tcp_pose,
    wrist_passage,
)

A, V = 1.396263, 1.047197


def joints_by(*offset: float, a: float = A, v: float = V, t_s: float = 0.0) -> MoveJ:
    offsets = (*offset, *(0.0,) * (6 - len(offset)))
    return MoveJ(six(x + d for x, d in zip(Q_WORK, offsets, strict=True)), a, v, t_s)


def movej(request: MoveJ, limits: object = LIMITS) -> Plan:
    return plan_movej(ARM, limits, Q_WORK, request)  # type: ignore[arg-type]


def movel(request: MoveL, q_start: Six = Q_WORK, limits: object = LIMITS) -> Plan:
    return plan_movel(ARM, limits, q_start, T_FLANGE_TCP, request)  # type: ignore[arg-type]


def movec(request: MoveC, limits: object = LIMITS) -> Plan:
    return plan_movec(ARM, limits, Q_WORK, T_FLANGE_TCP, request)  # type: ignore[arg-type]


class TestMoveJ:
    def test_long_move_obeys_the_trapezoid_of_the_leading_joint(self) -> None:
        plan = movej(joints_by(0.5, 0.1, -1.5))
        assert plan.notes == ()
        assert plan.segment.duration_s == pytest.approx(1.5 / V + V / A)
        assert plan.segment.sample_speed(0.5 * plan.segment.duration_s) == pytest.approx(
            (V / 3, V / 15, -V, 0, 0, 0), abs=1e-12
        )

    def test_short_move_obeys_the_triangle(self) -> None:
        assert movej(joints_by(0.01, 0.3)).segment.duration_s == pytest.approx(2.0 * sqrt(0.3 / A))

    def test_end_is_the_target_bit_for_bit(self) -> None:
        request = joints_by(0.1, 0.7, 1.3, -0.2, 1e-9)
        segment = movej(request).segment
        assert segment.sample(segment.duration_s) == request.q_target
        assert segment.q_end == request.q_target

    def test_all_joints_start_and_end_together(self) -> None:
        segment = movej(joints_by(0.5, 0.1, -1.5, 0.3, -0.4, 0.6)).segment
        for share in (0.01, 0.5, 0.99):
            q = segment.sample(share * segment.duration_s)
            done = [(x - a) / (b - a) for x, a, b in zip(q, segment.q_start, segment.q_end, strict=True)]
            assert done == pytest.approx([done[0]] * 6, rel=1e-9)
            assert all(segment.sample_speed(share * segment.duration_s))

    def test_duration_is_kept_exactly_and_speed_and_acceleration_ignored(self) -> None:
        for t_s in (0.9, 2.0, 123.456):
            plan = movej(joints_by(0.5, 0.1, -1.5, a=1e-3, v=1e-3, t_s=t_s))
            assert plan.segment.duration_s == t_s
            assert plan.notes == ()

    def test_duration_that_is_too_short_gives_the_shortest_and_a_note(self) -> None:
        plan = movej(joints_by(0.5, 0.1, -1.5, t_s=0.1))
        v, a = LIMITS.qd_max[2], LIMITS.qdd_max[2]
        assert plan.segment.duration_s == pytest.approx(1.5 / v + v / a)
        (note,) = plan.notes
        assert note.kind is MoveNoteKind.T_TOO_SHORT == "t_too_short"
        assert "t = 0.1 s is too short" in note.text
        assert f"{plan.segment.duration_s:.4f} s" in note.text

    def test_speed_above_the_limit_of_a_following_joint_is_lowered(self) -> None:
        # wrist1 leads and may turn at 230 deg/s, the base follows with 80 % of it and may not exceed 150 deg/s.
        segment = movej(joints_by(1.6, 0.0, 0.0, 2.0, a=20.0, v=10.0)).segment
        speed = segment.sample_speed(0.5 * segment.duration_s)
        assert speed[0] == pytest.approx(LIMITS.qd_max[0], rel=1e-12)
        assert speed[3] == pytest.approx(LIMITS.qd_max[0] / 0.8, rel=1e-12)

    def test_acceleration_above_the_limit_is_lowered(self) -> None:
        limits = limits_of("CS66", qdd_max=(2.0, 40.0, 40.0, 40.0, 40.0, 40.0))
        segment = movej(joints_by(0.8, 0.0, 0.0, 1.0, a=40.0, v=3.0), limits).segment
        assert segment.sample_speed(0.01)[0] == pytest.approx(0.02, rel=1e-9)

    def test_target_where_the_arm_stands_takes_the_time_that_is_asked_for(self) -> None:
        for t_s in (0.0, 5.0):
            plan = movej(joints_by(t_s=t_s))
            assert plan.segment.duration_s == t_s
            assert plan.segment.sample(0.0) == Q_WORK

    def test_target_outside_the_range_names_the_joint(self) -> None:
        with pytest.raises(MotionError, match=r"at the target, joint wrist2 would be at 8\.5000 rad") as caught:
            movej(joints_by(0.0, 0.0, 0.0, 0.0, 7.0))
        assert caught.value.code == "R110"
        assert caught.value.value == 8.5
        assert caught.value.unit == "rad"

    def test_arm_may_come_back_from_outside_its_range(self) -> None:
        outside = six((7.0, *Q_WORK[1:]))
        assert plan_movej(ARM, LIMITS, outside, MoveJ(Q_WORK, A, V)).segment.q_end == Q_WORK

    def test_end_pose_contains_the_tool(self) -> None:
        request = joints_by(0.4)
        segment = plan_movej(ARM, LIMITS, Q_WORK, request, T_FLANGE_TCP).segment
        assert segment.T_base_tcp_end == ARM.forward_tcp(request.q_target, T_FLANGE_TCP)


class TestMoveL:
    def test_long_line_obeys_the_trapezoid(self) -> None:
        plan = movel(line_by(Q_WORK, 0.1, 0.15, -0.08))
        d = dist((0, 0, 0), (0.1, 0.15, -0.08))
        assert plan.notes == ()
        assert plan.segment.duration_s == pytest.approx(d / 0.25 + 0.25 / 1.2, rel=1e-12)

    def test_short_line_obeys_the_triangle(self) -> None:
        assert movel(line_by(Q_WORK, 0.01)).segment.duration_s == pytest.approx(2.0 * sqrt(0.01 / 1.2), rel=1e-12)

    def test_tcp_stays_on_the_line_and_the_orientation_on_the_shortest_rotation(self) -> None:
        request = line_by(Q_WORK, 0.1, 0.15, -0.08, 0.3, -0.2, 0.4)
        segment = movel(request).segment
        T_start, T_end = ARM.forward_tcp(Q_WORK, T_FLANGE_TCP), transform_from_pose(request.p_target)
        for k in range(51):
            T = ARM.forward_tcp(segment.sample(segment.duration_s * k / 50), T_FLANGE_TCP)
            share = dist(position_of(T_start), position_of(T)) / dist(position_of(T_start), position_of(T_end))
            assert largest_difference(T, interpolate(T_start, T_end, share)) < 1e-9

    def test_pure_rotation_uses_radians(self) -> None:
        plan = movel(line_by(Q_WORK, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, a=0.5, v=0.4))
        angle = plan.segment.path.length
        assert plan.segment.path.unit == "rad"
        assert plan.segment.duration_s == pytest.approx(angle / 0.4 + 0.4 / 0.5, rel=1e-12)

    def test_rotation_keeps_step_with_a_translation(self) -> None:
        plan = movel(line_by(Q_WORK, 0.2, 0.0, 0.0, 0.0, 0.0, 0.5))
        assert plan.segment.duration_s == pytest.approx(0.2 / 0.25 + 0.25 / 1.2, rel=1e-12)

    def test_rotation_too_quick_for_the_joints_slows_the_move(self) -> None:
        plan = movel(line_by(Q_WORK, 0.001, 0.0, 0.0, 0.0, 0.0, 1.5))
        assert plan.segment.path.unit == "m"
        (note,) = plan.notes
        assert note.kind is MoveNoteKind.SPEED_LOWERED_FOR_JOINT_LIMITS
        assert plan.segment.duration_s > 1.5 / max(LIMITS.qd_max)

    def test_tool_limits_lower_speed_and_acceleration(self) -> None:
        limits = replace(UNBOUND, tool_speed_max=0.1, tool_acceleration_max=0.5)
        plan = movel(line_by(Q_WORK, 0.0, 0.2, a=9.0, v=9.0), limits=limits)
        assert plan.segment.duration_s == pytest.approx(0.2 / 0.1 + 0.1 / 0.5, rel=1e-12)

    def test_duration_is_kept_exactly(self) -> None:
        for t_s in (0.5, 1.0, 77.7):
            plan = movel(line_by(Q_WORK, 0.1, 0.15, -0.08, a=1e-3, v=1e-3, t_s=t_s))
            assert plan.segment.duration_s == t_s
            assert plan.notes == ()

    def test_duration_is_kept_exactly_where_joint_limits_forbid_the_plain_trapezoid(self) -> None:
        offset = (0.05, 0.2, -0.05)
        shortest = movel(line_by(Q_NEAR_WRIST, *offset, t_s=1e-3), Q_NEAR_WRIST).segment.duration_s
        for t_s in (1.001 * shortest, 1.1 * shortest, 1.5 * shortest):
            plan = movel(line_by(Q_NEAR_WRIST, *offset, t_s=t_s), Q_NEAR_WRIST)
            assert plan.segment.duration_s == t_s
            assert plan.notes == ()
            for k in range(201):
                speeds = plan.segment.sample_speed(t_s * k / 200)
                assert all(abs(qd) <= 1.001 * top for qd, top in zip(speeds, LIMITS.qd_max, strict=True))

    def test_duration_that_is_too_short_gives_the_shortest_and_a_note(self) -> None:
        plan = movel(line_by(Q_WORK, 0.1, 0.15, -0.08, t_s=0.01))
        (note,) = plan.notes
        assert note.kind is MoveNoteKind.T_TOO_SHORT
        assert plan.segment.duration_s > 0.01
        fastest = movel(line_by(Q_WORK, 0.1, 0.15, -0.08, a=1e9, v=1e9)).segment.duration_s
        assert plan.segment.duration_s == pytest.approx(fastest)

    def test_slow_passage_near_a_singularity_is_noted_with_joint_place_and_numbers(self) -> None:
        plan = movel(line_by(Q_NEAR_WRIST, 0.05, 0.2, -0.05, v=0.5), Q_NEAR_WRIST)
        (note,) = plan.notes
        assert note.kind is MoveNoteKind.SPEED_LOWERED_NEAR_SINGULARITY
        assert "the wrist singularity is near" in note.text
        assert "joint wrist1 (4.014 rad/s, 40 rad/s^2)" in note.text
        assert "m from the start of the line" in note.text
        assert f"takes {plan.segment.duration_s:.3f} s instead of" in note.text

    @pytest.mark.parametrize("nearest_sine", [0.2, 0.05, 0.01, 0.0015])
    def test_passage_hard_by_a_singularity_keeps_every_joint_limit(self, nearest_sine: float) -> None:
        q_start, request = wrist_passage(nearest_sine)
        segment = movel(request, q_start).segment
        samples = [segment.setpoint(segment.duration_s * k / 2000) for k in range(2001)]
        found = min(singularity(ARM, q).wrist for q, _ in samples)
        assert found == pytest.approx(nearest_sine, rel=0.05)
        swing = max(q[3] for q, _ in samples) - min(q[3] for q, _ in samples)
        assert swing > 2.0 or nearest_sine > 0.1
        for _, qd in samples:
            assert all(abs(speed) <= 1.001 * top for speed, top in zip(qd, LIMITS.qd_max, strict=True))
        # Away from the passage the tool is as quick as anywhere.
        assert segment.profile.speed_at_position(0.03) == pytest.approx(0.25)
        assert segment.duration_s < 0.2 / 0.25 + 0.25 / 1.2 + 4.0

    @pytest.mark.parametrize("nearest_sine", [0.0009, 1e-7])
    def test_passage_through_a_singularity_is_refused(self, nearest_sine: float) -> None:
        q_start, request = wrist_passage(nearest_sine)
        with pytest.raises(MotionError, match="wrist singularity 0\\.1000 m from the start") as caught:
            movel(request, q_start)
        assert caught.value.code == "R112"

    def test_target_where_the_arm_stands_takes_the_time_that_is_asked_for(self) -> None:
        for t_s in (0.0, 5.0):
            plan = movel(replace(line_by(Q_WORK), t_s=t_s))
            assert plan.segment.duration_s == t_s
            assert plan.segment.sample(1.0) == Q_WORK

    def test_present_pose_is_accepted_in_a_singular_arm(self) -> None:
        q_start = (0.0, -pi / 2, 0.0, -pi / 2, 0.0, 0.0)
        assert movel(line_by(q_start), q_start).segment.duration_s == 0.0

    @pytest.mark.parametrize(
        ("offset", "words"),
        [((0.0, 2.0), "too far by 1"), ((-0.4, 0.1), "too near the base axis by 0.02")],
    )
    def test_unreachable_target_is_refused(self, offset: tuple[float, float], words: str) -> None:
        with pytest.raises(MotionError, match=f"out of reach at the target.*{words}") as caught:
            movel(line_by(Q_WORK, *offset))
        assert caught.value.code == "R111"
        assert caught.value.unit == "m"


class TestMoveC:
    VIA = shifted(Q_WORK, 0.1, 0.1)
    FAR = shifted(Q_WORK, 0.2, 0.0)

    def test_half_circle_obeys_the_trapezoid(self) -> None:
        plan = movec(MoveC(self.VIA, self.FAR, 1.2, 0.25))
        assert plan.segment.kind == "arc"
        assert plan.segment.duration_s == pytest.approx(pi * 0.1 / 0.25 + 0.25 / 1.2, rel=1e-9)

    def test_tcp_stays_on_the_circle(self) -> None:
        segment = movec(MoveC(self.VIA, self.FAR, 1.2, 0.25)).segment
        centre = position_of(transform_from_pose(shifted(Q_WORK, 0.1, 0.0)))
        for k in range(51):
            T = ARM.forward_tcp(segment.sample(segment.duration_s * k / 50), T_FLANGE_TCP)
            assert dist(position_of(T), centre) == pytest.approx(0.1, abs=1e-9)
            assert T[11] == pytest.approx(centre[2], abs=1e-9)

    def test_fixed_orientation_does_not_look_at_that_of_the_target(self) -> None:
        tilted = shifted(Q_WORK, 0.2, 0.0, 0.0, 0.3, 0.3, 0.3)
        segment = movec(MoveC(self.VIA, tilted, 1.2, 0.25)).segment
        reference = movec(MoveC(self.VIA, self.FAR, 1.2, 0.25)).segment
        assert segment.q_end == pytest.approx(reference.q_end, abs=1e-12)

    def test_free_orientation_ends_in_that_of_the_target(self) -> None:
        tilted = shifted(Q_WORK, 0.2, 0.0, 0.0, 0.3, 0.3, 0.3)
        segment = movec(MoveC(self.VIA, tilted, 1.2, 0.25, is_orientation_fixed=False)).segment
        assert largest_difference(ARM.forward_tcp(segment.q_end, T_FLANGE_TCP), transform_from_pose(tilted)) < 1e-9

    def test_arc_may_exceed_half_a_turn(self) -> None:
        end = shifted(Q_WORK, 0.1, -0.1)
        segment = movec(MoveC(self.VIA, end, 1.2, 0.25, is_orientation_fixed=False)).segment
        assert segment.path.length == pytest.approx(1.5 * pi * 0.1)

    def test_acceleration_towards_the_centre_limits_the_speed(self) -> None:
        limits = replace(UNBOUND, tool_acceleration_max=2.0)
        segment = movec(MoveC(self.VIA, self.FAR, 1.2, 2.0, is_orientation_fixed=False), limits).segment
        assert segment.profile.peak_speed <= sqrt(2.0 * 0.1) * (1.0 + 1e-12)

    def test_points_without_a_circle_are_refused(self) -> None:
        for via, end, words in (
            (shifted(Q_WORK, 0.1), shifted(Q_WORK, 0.2), "on one line"),
            (self.VIA, tcp_pose(Q_WORK), "start and the end point"),
        ):
            with pytest.raises(MotionError, match=words) as caught:
                movec(MoveC(via, end, 1.2, 0.25))
            assert caught.value.code == "R113"

    def test_arc_that_leaves_the_workspace_is_refused_at_the_border(self) -> None:
        with pytest.raises(
            MotionError, match=r"out of reach 0\.4\d+ m from the start of the arc of .*too far by 0\.0"
        ) as caught:
            movec(MoveC(shifted(Q_WORK, 0.1, 0.3, 0.1), shifted(Q_WORK, 0.0, 0.2, 0.1), 1.2, 0.25))
        assert caught.value.code == "R111"

    def test_huge_circle_is_refused_at_once(self) -> None:
        with pytest.raises(MotionError) as caught:
            movec(MoveC(shifted(Q_WORK, 1e6, 1e6), shifted(Q_WORK, 0.1, 0.0, 0.1), 1.2, 0.25))
        assert caught.value.code == "R111"


class TestNumbers:
    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"a": 0.0}, "a is 0.0; it has to be more than 0"),
            ({"a": nan}, "a is nan"),
            ({"v": -1.0}, "v is -1.0; it has to be more than 0"),
            ({"v": inf}, "v is inf"),
            ({"t_s": -1.0}, "t is -1.0 s; it has to be 0 or more"),
            ({"t_s": nan}, "t is nan s"),
            ({"r": -0.1}, "r is -0.1 m; it has to be 0 or more"),
            ({"v": 5e-324}, "would never end"),
        ],
    )
    def test_senseless_numbers_are_refused(self, change: dict[str, float], words: str) -> None:
        for plan, request in ((movej, joints_by(0.5)), (movel, line_by(Q_WORK, 0.1))):
            with pytest.raises(MotionError, match=words) as caught:
                plan(replace(request, **change))  # type: ignore[operator]
            assert caught.value.code == "R102"

    def test_targets_have_to_be_finite(self) -> None:
        for position in range(6):
            numbers = six(nan if index == position else 0.3 for index in range(6))
            for plan, request in (
                (movej, MoveJ(numbers, A, V)),
                (movel, MoveL(numbers, 1.2, 0.25)),
                (movec, MoveC(numbers, TestMoveC.FAR, 1.2, 0.25)),
                (movec, MoveC(TestMoveC.VIA, numbers, 1.2, 0.25)),
            ):
                with pytest.raises(MotionError, match=rf"\[{position}\] is nan, not a finite number") as caught:
                    plan(request)  # type: ignore[operator]
                assert caught.value.code == "R102"

    def test_duration_makes_speed_and_acceleration_meaningless(self) -> None:
        assert movej(replace(joints_by(0.5, t_s=2.0), a=0.0, v=-1.0)).segment.duration_s == 2.0


@pytest.mark.parametrize(("turn", "is_told"), [(0.0, False), (0.015, False), (0.02, True), (1.5, True)])
def test_an_arc_that_keeps_its_orientation_says_how_far_it_ends_from_the_one_that_was_given(
    turn: float, is_told: bool
) -> None:
    T = ARM.forward_tcp(Q_WORK, T_FLANGE_TCP)
    start = pose_from_transform(T)
    via = (start[0] + 0.05, start[1] + 0.05, *start[2:])
    to = (start[0] + 0.1, *start[1:])
    kept = plan_movec(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveC(via, to, 1.2, 0.1)).segment.T_base_tcp_end
    rotation = multiply(rotation_of(kept), rotation_from_rotvec((0.0, 0.0, turn)))
    asked = pose_from_transform((*rotation, *kept[9:]))
    notes = plan_movec(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveC(via, asked, 1.2, 0.1)).notes
    assert [note.kind for note in notes] == [MoveNoteKind.ORIENTATION_NOT_USED] * is_told
    if is_told:
        assert f"{degrees(turn):.3g} deg" in notes[0].text
        assert "mode=1" in notes[0].text
    turned = plan_movec(ARM, LIMITS, Q_WORK, T_FLANGE_TCP, MoveC(via, asked, 1.2, 0.1, 0.0, False))
    assert turned.notes == ()
