"""Joints along a Cartesian path: branch, turns, refusals with place and numbers."""

from __future__ import annotations

import random
from dataclasses import replace
from math import pi

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.inverse import branch_of, solve_branch
from elitescript.kinematics.jacobian import singularity
from elitescript.kinematics.transforms import compose, transform_from_pose
from elitescript.messages.motion import Six
from elitescript.motion.limits import JOINT_NAMES
from elitescript.motion.paths.cartesian import LinePath, line
from elitescript.motion.paths.track import JointTrack, follow
from tests.motion.moves import (
    ARM,
    FULL_TURN,
    LIMITS,
    Q_NEAR_WRIST,
    Q_WORK,
    T_FLANGE_TCP,
    largest_difference,
    shifted,
    six,
    turned,
)

T_FLANGE_WRIST = transform_from_pose((0.0, 0.0, -ARM.d6, 0.0, 0.0, 0.0))
"""A TCP in the wrist centre, about which joints 4 to 6 turn the tool in place."""


def line_to(q_start: Six, p_target: Six) -> LinePath:
    T_base_flange = ARM.forward(q_start)
    return line(T_base_flange, compose(T_base_flange, T_FLANGE_TCP), transform_from_pose(p_target), 0.25)


def wrist_turn(q_start: Six, joint: int, angle: float) -> JointTrack:
    """A pure rotation of the tool about the axis of joint 5 or 6."""
    q_end = six(x + angle * (index == joint) for index, x in enumerate(q_start))
    T_start, T_end = (ARM.forward_tcp(q, T_FLANGE_WRIST) for q in (q_start, q_end))
    path = line(ARM.forward(q_start), T_start, T_end, 0.25)
    assert path.unit == "rad"
    return follow(ARM, LIMITS, path, q_start, 0.5, 1.2)


def q_beside_base(distance: float, x: float = 0.03) -> Six:
    """Joint angles with the tool down and the wrist centre at (x, distance), beside the base."""
    T = transform_from_pose((x, distance, 0.45, pi, 0.0, 0.0))
    q = solve_branch(ARM, T, 0)
    assert q is not None
    return q


def track_to(q_start: Six, p_target: Six, speed: float = 0.25) -> JointTrack:
    return follow(ARM, LIMITS, line_to(q_start, p_target), q_start, speed, 1.2)


def test_samples_lie_on_the_path_and_keep_the_branch() -> None:
    track = track_to(Q_WORK, shifted(Q_WORK, 0.1, 0.15, -0.08, 0.2, 0.1, -0.3))
    branch = branch_of(ARM, Q_WORK)
    for k in range(101):
        s = track.length * k / 100
        q = track.q(s)
        assert branch_of(ARM, q) == branch
        assert largest_difference(ARM.forward(q), track.path.flange(s)) < 1e-12


def test_samples_do_not_depend_on_what_was_sampled_before() -> None:
    track = track_to(Q_WORK, shifted(Q_WORK, 0.1, 0.15, -0.08))
    positions = [track.length * k / 50 for k in range(51)]
    in_order = {s: track.q(s) for s in positions}
    random.Random(1).shuffle(positions)
    assert {s: track.q(s) for s in positions} == in_order


def test_slope_is_the_derivative_of_the_joints() -> None:
    track = track_to(Q_WORK, shifted(Q_WORK, 0.1, 0.15, -0.08, 0.2, 0.1, -0.3))
    h = 1e-6
    for s in (0.01, 0.1, 0.15):
        q, slope = track.q_and_slope(s)
        assert q == track.q(s)
        differences = [(b - a) / (2.0 * h) for a, b in zip(track.q(s - h), track.q(s + h), strict=True)]
        assert largest_difference(slope, differences) < 1e-7


def test_joints_run_on_beyond_half_a_turn() -> None:
    q_start = six((*Q_WORK[:5], pi - 0.1))
    track = track_to(q_start, turned(q_start, 5, 1.0))
    assert track.q_end == pytest.approx((*Q_WORK[:5], pi + 0.9), abs=1e-12)


def test_joints_stay_on_the_turn_they_start_on() -> None:
    q_start = six((Q_WORK[0] - FULL_TURN, *Q_WORK[1:3], Q_WORK[3] + FULL_TURN, *Q_WORK[4:]))
    track = track_to(q_start, shifted(Q_WORK, 0.0, 0.1))
    reference = track_to(Q_WORK, shifted(Q_WORK, 0.0, 0.1))
    for share in (0.0, 0.3, 1.0):
        difference = [
            a - b for a, b in zip(track.q(share * track.length), reference.q(share * track.length), strict=True)
        ]
        assert difference == pytest.approx((-FULL_TURN, 0, 0, FULL_TURN, 0, 0), abs=1e-12)


def test_grid_is_coarse_on_a_plain_line_and_fine_near_a_singularity() -> None:
    plain = track_to(Q_WORK, shifted(Q_WORK, 0.0, 0.2))
    passing = track_to(Q_NEAR_WRIST, shifted(Q_NEAR_WRIST, 0.05, 0.2, -0.05), 0.5)
    assert len(plain.grid_s) <= 6
    assert len(passing.grid_s) > 2 * len(plain.grid_s)


def test_joint_that_would_leave_its_range_is_named_with_the_place() -> None:
    q_start = six((*Q_WORK[:5], 6.0))
    with pytest.raises(MotionError) as caught:
        wrist_turn(q_start, 5, 0.5)
    assert caught.value.code == "R110"
    assert caught.value.value > FULL_TURN
    assert caught.value.unit == "rad"
    text = str(caught.value)
    assert "joint wrist3 would be at 6." in text
    assert "which it would leave 0.28" in text
    assert "rad from the start of the rotation of 0.5000 rad" in text


def test_start_outside_the_range_is_refused_as_such() -> None:
    with pytest.raises(MotionError, match=r"at the start, joint wrist3 would be at 7\.0000 rad") as caught:
        wrist_turn(six((*Q_WORK[:5], 7.0)), 5, -0.5)
    assert caught.value.code == "R110"


def test_joint_that_leaves_its_range_and_comes_back_is_found() -> None:
    # Across in front of the arm, elbow down: it bends most in the middle.
    q_start = solve_branch(ARM, transform_from_pose((0.45, -0.3, 0.3, pi, 0.0, 0.0)), 0)
    assert q_start is not None
    track = track_to(q_start, shifted(q_start, 0.0, 0.55))
    angles = [[track.q(track.length * k / 400)[joint] for k in range(401)] for joint in range(6)]
    joint = max(range(6), key=lambda j: max(angles[j]) - max(angles[j][0], angles[j][-1]))
    highest = max(angles[joint])
    assert highest > max(angles[joint][0], angles[joint][-1]) + 0.01
    for margin, is_refused in ((-1e-4, True), (1e-4, False)):
        q_max = six(highest + margin if index == joint else FULL_TURN for index in range(6))
        limits = replace(LIMITS, q_max=q_max)
        if is_refused:
            with pytest.raises(MotionError, match=f"joint {JOINT_NAMES[joint]}") as caught:
                follow(ARM, limits, track.path, q_start, 0.25, 1.2)
            assert caught.value.code == "R110"
        else:
            assert follow(ARM, limits, track.path, q_start, 0.25, 1.2).q_end == track.q_end


def test_target_out_of_reach_is_refused_with_the_missing_length() -> None:
    with pytest.raises(
        MotionError, match=r"out of reach at the target, 1\.0000 m from the start of the line: too far by 0\."
    ) as caught:
        track_to(Q_WORK, shifted(Q_WORK, 0.0, 1.0))
    assert caught.value.code == "R111"
    assert caught.value.value == pytest.approx(1.0)
    assert caught.value.unit == "m"


def test_line_through_the_base_column_is_refused_where_it_enters() -> None:
    target = shifted(Q_WORK, 0.0)
    mirrored = six((-target[0], -target[1], *target[2:]))
    with pytest.raises(MotionError, match="too near the base axis") as caught:
        track_to(Q_WORK, mirrored)
    assert caught.value.code == "R111"
    path = line_to(Q_WORK, mirrored)
    assert 0.0 < caught.value.value < path.length
    # A little earlier the arm still gets there.
    T = path.flange(caught.value.value - 2e-4)
    wx, wy = T[9] - ARM.d6 * T[2], T[10] - ARM.d6 * T[5]
    assert (wx * wx + wy * wy) ** 0.5 >= ARM.d4


def test_rotation_through_the_wrist_singularity_is_refused() -> None:
    q_start = six((*Q_WORK[:4], 0.3, Q_WORK[5]))
    with pytest.raises(MotionError, match="singular") as caught:
        wrist_turn(q_start, 4, -0.6)
    assert caught.value.code == "R112"
    assert "movej" in (caught.value.hint or "")


@pytest.mark.parametrize(
    ("q_start", "towards_base", "name"),
    [
        ((0.0, -pi / 2, -pi / 2, -pi / 2, 0.0, 0.0), (0.0, 0.0, -0.1), "wrist"),
        ((0.0, 0.0, 0.0, 0.0, pi / 2, 0.0), (0.1, 0.0, 0.0), "elbow"),
        ((0.0, -pi / 2, 0.0, -pi / 2, pi / 2, 0.0), (0.0, 0.0, -0.1), "elbow"),
    ],
)
def test_line_from_a_singular_start_is_refused_with_a_hint(
    q_start: Six, towards_base: tuple[float, float, float], name: str
) -> None:
    with pytest.raises(MotionError, match=f"{name} singularity at the start") as caught:
        track_to(q_start, shifted(q_start, *towards_base))
    assert caught.value.code == "R112"
    assert caught.value.value == pytest.approx(0.0, abs=1e-9)
    assert caught.value.limit == ">= 0.001"
    assert "movej" in (caught.value.hint or "")


@pytest.mark.parametrize(
    ("distance", "code", "words"),
    [
        (ARM.d4 - 0.001, "R111", "too near the base axis"),
        (ARM.d4 + 1e-7, "R112", "the wrist centre is 0.000"),
    ],
)
def test_line_that_grazes_the_base_column_is_refused(distance: float, code: str, words: str) -> None:
    q_start = q_beside_base(distance)
    with pytest.raises(MotionError, match=words) as caught:
        track_to(q_start, shifted(q_start, -0.06))
    assert caught.value.code == code


@pytest.mark.parametrize("depth", [1e-4, 3e-4, 1e-3])
@pytest.mark.parametrize("before", [0.03, 0.06, 0.065, 0.07, 0.075, 0.1])
@pytest.mark.parametrize("behind", [0.02, 0.025, 0.06, 0.065, 0.07, 0.1, 0.125])
def test_base_column_between_two_grid_points_is_not_overlooked(depth: float, before: float, behind: float) -> None:
    q_start = q_beside_base(ARM.d4 - depth, before)
    with pytest.raises(MotionError) as caught:
        track_to(q_start, shifted(q_start, -before - behind), 0.05)
    assert caught.value.code in {"R111", "R112"}


def test_line_just_beside_the_base_column_is_followed() -> None:
    q_start = q_beside_base(ARM.d4 + 0.0005)
    track = track_to(q_start, shifted(q_start, -0.06))
    nearest = min(singularity(ARM, q).shoulder for q in track.grid_q)
    assert nearest == pytest.approx(((ARM.d4 + 0.0005) ** 2 - ARM.d4**2) ** 0.5, rel=0.01)
    for k in range(101):
        s = track.length * k / 100
        assert largest_difference(ARM.forward(track.q(s)), track.path.flange(s)) < 1e-12


def test_path_without_length_is_accepted_even_at_a_singularity() -> None:
    q_start = (0.0, -pi / 2, 0.0, -pi / 2, 0.0, 0.0)
    track = track_to(q_start, shifted(q_start, 0.0))
    assert track.length == 0.0
    assert track.q(0.0) == q_start
