"""Frames, filter and pace of path offsets, against values worked out by hand."""

from math import pi, sqrt

import pytest

from elitescript.kinematics.rotations import IDENTITY_ROTATION, rotation_from_rotvec
from elitescript.kinematics.transforms import IDENTITY, pose_from_transform, transform_from_pose
from elitescript.messages.path_offset import OffsetFrame
from elitescript.messages.timing import PERIOD_S
from elitescript.motion.corrections.offset import (
    Excess,
    FollowingRate,
    along_axes,
    axes_of,
    bounded,
    change_share,
    closing_rate,
    in_base,
    pace,
    smoothed,
    travel_axes,
)

DOWN = transform_from_pose((0.4, 0.1, 0.3, pi, 0.0, 0.0))
"""A tool that points down: its x axis is that of the base, its z axis is against that of the base."""


def columns(R):
    return [tuple(round(value, 12) + 0.0 for value in R[k::3]) for k in range(3)]


class TestFrameOfMotion:
    def test_above_a_seam_y_is_across_and_z_is_up(self):
        assert columns(travel_axes((0.0, 0.02, 0.0), DOWN, None)) == [(0, 1, 0), (-1, 0, 0), (0, 0, 1)]

    def test_on_the_way_back_y_turns_round(self):
        assert columns(travel_axes((0.0, -0.02, 0.0), DOWN, None)) == [(0, -1, 0), (1, 0, 0), (0, 0, 1)]

    def test_a_climbing_path_takes_z_along(self):
        s = sqrt(0.5)
        x, y, z = columns(travel_axes((0.1, 0.0, 0.1), DOWN, None))
        assert x == pytest.approx((s, 0, s)) and y == (0, 1, 0) and z == pytest.approx((-s, 0, s))

    @pytest.mark.parametrize("velocity", [(0, 0, 0), (1e-7, 0, 0), (0, 0, -0.1)])
    def test_stays_where_the_path_says_nothing(self, velocity):
        before = rotation_from_rotvec((0.1, 0.2, 0.3))
        assert travel_axes(velocity, DOWN, before) == before

    def test_begins_along_the_x_axis_of_the_tool(self):
        assert columns(travel_axes((0, 0, 0), DOWN, None)) == [(1, 0, 0), (0, 1, 0), (0, 0, 1)]


def test_axes_of_the_three_frames():
    motion = rotation_from_rotvec((0.0, 0.0, 0.5))
    assert axes_of(OffsetFrame.BASE, DOWN, motion) == IDENTITY_ROTATION
    assert columns(axes_of(OffsetFrame.TCP, DOWN, motion)) == [(1, 0, 0), (0, -1, 0), (0, 0, -1)]
    assert axes_of(OffsetFrame.MOTION, DOWN, motion) == motion


def test_an_offset_along_the_tool_is_one_against_z_of_the_base():
    axes = axes_of(OffsetFrame.TCP, DOWN, IDENTITY_ROTATION)
    deviation = in_base(axes, transform_from_pose((0.001, 0.002, 0.003, 0.0, 0.0, 0.1)))
    assert pose_from_transform(deviation) == pytest.approx((0.001, -0.002, -0.003, 0.0, 0.0, -0.1))
    back = pose_from_transform(along_axes(axes, deviation))
    assert back == pytest.approx((0.001, 0.002, 0.003, 0.0, 0.0, 0.1))
    assert in_base(axes, IDENTITY) is IDENTITY


class TestFilter:
    def test_goes_a_share_of_the_way_in_each_period(self):
        offset, wanted = IDENTITY, transform_from_pose((0.01, 0.0, 0.0, 0.0, 0.0, 0.2))
        for expected in (0.1, 0.19, 0.271):
            offset = smoothed(offset, wanted, 0.1)
            assert pose_from_transform(offset) == pytest.approx((0.01 * expected, 0, 0, 0, 0, 0.2 * expected))

    def test_arrives_exactly(self):
        offset, wanted = IDENTITY, transform_from_pose((0.01, -0.02, 0.003, 0.01, 0.0, 0.2))
        for _ in range(200):
            offset = smoothed(offset, wanted, 0.1)
        assert offset is wanted
        assert smoothed(IDENTITY, wanted, 1.0) is wanted


class TestPace:
    def test_half_of_the_slowest_joints_speed_and_a_third_of_its_acceleration(self):
        assert pace((0.1, 0.0, -0.2, 0.0, 0.0, 0.05), (2.0,) * 6, (40.0,) * 6) == FollowingRate(5.0, 70.0)

    def test_a_lag_ends_at_rest_without_an_overshoot(self):
        # 0.01 m at 5 m/s^2 and at most 0.1 m/s: the bounds of the law, one period at a time.
        lag, speed, ticks = 0.01, 0.0, 0
        while lag:
            rate = closing_rate(FollowingRate(0.1 / lag, 5.0 / lag))
            wanted = lag / PERIOD_S if rate is None else rate * lag
            speed = min(wanted, speed + 5.0 * PERIOD_S)
            assert speed <= 0.1 + 1e-12
            step, last, ticks = speed * PERIOD_S, speed, ticks + 1
            assert step <= lag * (1 + 1e-9)
            lag = 0.0 if rate is None and speed == wanted else lag - step
            assert ticks < 100
        assert last <= 5.0 * PERIOD_S * (1 + 1e-9)
        assert ticks == pytest.approx((0.01 / 0.1 + 0.1 / 5.0) / PERIOD_S, abs=3)

    def test_a_change_takes_half_of_what_the_joints_can_do(self):
        assert change_share((0.16, 0.0, 0.0, 0.0, 0.0, 0.0), (40.0,) * 6) == pytest.approx(0.5)
        assert change_share((0.0,) * 6, (40.0,) * 6) == 1.0


def test_each_element_is_limited_by_itself():
    assert bounded((0.2, -0.3, 0.05, 0.1, -0.9, 0.0), 0.1, 0.5) == (
        (0.1, -0.1, 0.05, 0.1, -0.5, 0.0),
        Excess("x", 0.2, 0.1, "m"),
    )
    assert bounded((0.0, 0.0, 0.1, 0.0, 0.6, 0.0), 0.1, 0.5)[1] == Excess("ry", 0.6, 0.5, "rad")
    assert bounded((0.1, 0.0, 0.0, 0.5, 0.0, 0.0), 0.1, 0.5)[1] is None
