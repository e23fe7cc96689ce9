"""Where a conveyor carries a pose, and how fast."""

from math import cos, hypot, pi, sin
from random import Random

import pytest

from elitescript.kinematics.rotations import multiply, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import (
    compose,
    inverse,
    pose_from_transform,
    rotation_of,
    transform_from_pose,
)
from elitescript.motion.corrections.conveyor import StraightConveyor, Turntable

POSE = (0.4, -0.2, 0.15, 3.0, 0.1, -1.2)
CENTER = (0.5, 0.1, 0.05, 0.2, -0.3, 0.4)


def test_a_belt_shifts_the_position_along_its_direction_alone():
    belt = StraightConveyor((0.0, 3.0, 4.0), 1000.0)
    carried = pose_from_transform(belt.carried(transform_from_pose(POSE), 0.1))
    assert carried == pytest.approx((0.4, -0.2 + 0.06, 0.15 + 0.08, 3.0, 0.1, -1.2), abs=1e-15)
    assert belt.way_per_count == 0.001


def test_counting_against_the_direction_is_a_negative_number_of_counts():
    assert StraightConveyor((1.0, 0.0, 0.0), -500.0).way_per_count == -0.002
    assert Turntable(CENTER, -500.0, False).way_per_count == pytest.approx(-2 * pi / 500)


def test_a_turntable_turns_position_and_tool_about_the_z_axis_of_its_centre():
    table = Turntable(CENTER, 500.0, True)
    T_base_center = transform_from_pose(CENTER)
    T_center_tcp = compose(inverse(T_base_center), transform_from_pose(POSE))
    turn = transform_from_pose((0.0, 0.0, 0.0, 0.0, 0.0, 0.7))
    wanted = compose(T_base_center, compose(turn, T_center_tcp))
    assert table.carried(transform_from_pose(POSE), 0.7) == pytest.approx(wanted, abs=1e-15)


def test_a_tool_that_does_not_turn_keeps_its_orientation_on_the_same_way():
    turning, keeping = Turntable(CENTER, 500.0, True), Turntable(CENTER, 500.0, False)
    T = transform_from_pose(POSE)
    assert keeping.carried(T, 1.1)[:9] == T[:9]
    assert keeping.carried(T, 1.1)[9:] == turning.carried(T, 1.1)[9:]


def test_a_flat_table_is_the_plane_rotation():
    table = Turntable((0.5, 0.0, 0.0, 0.0, 0.0, 0.0), 1000.0, False)
    x, y, z = table.carried(transform_from_pose((0.7, 0.0, 0.3, 0.0, 0.0, 0.0)), 0.6)[9:]
    assert (x, y, z) == pytest.approx((0.5 + 0.2 * cos(0.6), 0.2 * sin(0.6), 0.3), abs=1e-15)


@pytest.mark.parametrize(
    "conveyor",
    [StraightConveyor((1.0, -2.0, 0.5), 900.0), Turntable(CENTER, 500.0, True), Turntable(CENTER, 500.0, False)],
    ids=["belt", "table", "table, tool kept"],
)
def test_the_twist_is_the_derivative_of_the_pose(conveyor):
    generator = Random(3)
    h = 1e-6
    for _ in range(20):
        pose = [generator.uniform(-0.6, 0.6) for _ in range(6)]
        rates = [generator.uniform(-1.0, 1.0) for _ in range(6)]
        way, speed = generator.uniform(-3.0, 3.0), generator.uniform(-1.0, 1.0)

        def at(t, pose=pose, rates=rates, way=way, speed=speed):
            T = transform_from_pose([p + r * t for p, r in zip(pose, rates, strict=True)])
            return conveyor.carried(T, way + speed * t)

        T_before, T_after = at(-h), at(h)
        still = [transform_from_pose([p + r * t for p, r in zip(pose, rates, strict=True)]) for t in (-h, h)]

        def twist_between(T_0, T_1):
            spin = rotvec_from_rotation(multiply(rotation_of(T_1), transpose(rotation_of(T_0))))
            shift = [(b - a) / (2 * h) for a, b in zip(T_0[9:], T_1[9:], strict=True)]
            return (*shift, *(angle / (2 * h) for angle in spin))

        found = conveyor.carried_twist(twist_between(*still), at(0.0), way, speed)
        assert found == pytest.approx(twist_between(T_before, T_after), abs=1e-8)


def test_a_radian_of_the_table_moves_the_tool_by_its_distance_from_the_axis():
    table = Turntable((0.5, 0.0, 0.0, 0.0, 0.0, 0.0), 1000.0, True)
    near, far = ((0.5 + d, 0.1, 0.8, 0.0, 0.0, 0.0) for d in (0.1, 0.7))
    assert table.lever(transform_from_pose(far), 0.25) == pytest.approx(hypot(0.7, 0.1))
    assert table.lever(transform_from_pose(near), 0.25) == 0.25
    assert StraightConveyor((1.0, 0.0, 0.0), 1.0).lever(transform_from_pose(far), 0.25) == 1.0
