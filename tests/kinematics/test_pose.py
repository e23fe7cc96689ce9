"""The pose algebra against the examples of the manuals.

Expected values are exact results rounded to twelve decimals; the manuals print fewer digits,
some rounded and some cut off.
"""

from __future__ import annotations

import random
from math import hypot, pi

import pytest

from elitescript.errors import InvalidValueError
from elitescript.kinematics.pose import (
    Pose,
    frame_from_points,
    interpolate_pose,
    point_dist,
    pose_add,
    pose_dist,
    pose_inv,
    pose_sub,
    pose_trans,
    rotvec2rpy,
    rpy2rotvec,
)
from elitescript.kinematics.transforms import apply, transform_from_pose

P_1 = [0.4, -0.2, 0.4, -3.1, 2.8, -2.3]
P_2 = [-0.01, -1.5, -0.002, -1.5, 1.5, -2.3]


def same_pose(p: Pose, p_other: Pose) -> bool:
    pairs = zip(transform_from_pose(p), transform_from_pose(p_other), strict=True)
    return max(abs(a - b) for a, b in pairs) < 1e-12


@pytest.mark.parametrize(
    ("result", "expected"),
    [
        (pose_add(P_1, P_2), [0.39, -1.7, 0.398, -2.31490526492, 1.18189888781, -2.270386197027]),
        (pose_sub(P_1, P_2), [0.41, 1.3, 0.402, -1.548171036089, 0.068212295069, 1.299352825994]),
        (
            pose_inv(P_1),
            [0.023407221235, 0.41385794126, -0.433789933551, 0.231467606004, -0.256822400437, -0.864437280283],
        ),
        (
            pose_trans(P_1, P_2),
            [1.496883748177, -1.221600078914, 0.342699722955, -2.31490526492, 1.18189888781, -2.270386197027],
        ),
        (interpolate_pose(P_1, P_2, 0), [0.4, -0.2, 0.4, 0.04159265359, 0.34159265359, 0.84159265359]),
        (rotvec2rpy([3.14, 1.57, 0]), [-2.808555579086, -0.162024498175, 0.900004928674]),
        (rpy2rotvec([3.14, 1.57, 0]), [2.221528476854, 0.001767654834, -2.219760118205]),
    ],
    ids=["pose_add", "pose_sub", "pose_inv", "pose_trans", "interpolate_pose", "rotvec2rpy", "rpy2rotvec"],
)
def test_manual_example(result: tuple[float, ...], expected: list[float]) -> None:
    assert result == pytest.approx(expected, abs=1e-12)


def test_manual_examples_of_distances() -> None:
    assert pose_dist(P_1, P_2) == pytest.approx(2.503937698905466, abs=1e-15)
    assert point_dist(P_1, P_2) == pytest.approx(1.4211629041035374, abs=1e-15)


def test_pose_dist_does_not_wrap_angles() -> None:
    assert pose_dist([0, 0, 0, 0, 0, pi], [0, 0, 0, 0, 0, -pi]) == pytest.approx(2 * pi)


def test_point_dist_ignores_orientations() -> None:
    assert point_dist([1, 2, 3, 0, 0, 0], [1, 2, 3, 1, 1, 1]) == 0.0


def test_pose_trans_with_the_inverse_is_the_base() -> None:
    assert pose_trans(P_1, pose_inv(P_1)) == pytest.approx([0.0] * 6, abs=1e-15)


def test_pose_add_undoes_pose_sub() -> None:
    rng = random.Random(6)
    for _ in range(100):
        p, p_from = ([rng.uniform(-3, 3) for _ in range(6)] for _ in range(2))
        difference = pose_sub(p, p_from)
        position = pose_add(p_from, difference)[:3]
        assert position == pytest.approx(p[:3], abs=1e-14)
        assert same_pose(pose_add([0, 0, 0, *p_from[3:]], [0, 0, 0, *difference[3:]]), (0, 0, 0, p[3], p[4], p[5]))


def test_interpolated_pose_at_one_is_the_end_in_canonical_angles() -> None:
    end = interpolate_pose(P_1, P_2, 1)
    assert same_pose(end, (P_2[0], P_2[1], P_2[2], P_2[3], P_2[4], P_2[5]))
    assert abs(end[4]) <= pi / 2


@pytest.mark.parametrize("alpha", [-0.5, 1.5])
def test_interpolated_pose_extrapolates_beyond_both_ends(alpha: float) -> None:
    p = interpolate_pose([0, 0, 0, 0, 0, 0], [0.2, 0, 0, 0, 0, 0.4], alpha)
    assert p == pytest.approx([0.2 * alpha, 0, 0, 0, 0, 0.4 * alpha], abs=1e-15)


def test_rotation_vector_and_rpy_are_inverse_to_each_other() -> None:
    rng = random.Random(7)
    for _ in range(100):
        rpy = rng.uniform(-3, 3), rng.uniform(-1.5, 1.5), rng.uniform(-3, 3)
        assert rotvec2rpy(rpy2rotvec(rpy)) == pytest.approx(rpy, abs=1e-12)


def test_results_are_tuples_of_six() -> None:
    for result in (pose_add(P_1, P_2), pose_sub(P_1, P_2), pose_inv(P_1), pose_trans(P_1, P_2)):
        assert isinstance(result, tuple)
        assert len(result) == 6


def test_frame_from_points_has_its_x_axis_and_plane_through_the_points() -> None:
    origin, x_point, xy_point = (0.3, -0.1, 0.2), (0.5, 0.1, 0.25), (0.2, 0.3, 0.1)
    p = frame_from_points(origin, x_point, xy_point)
    T_frame_base = transform_from_pose(pose_inv(p))
    assert p[:3] == origin
    length = hypot(*(a - b for a, b in zip(x_point, origin, strict=True)))
    assert apply(T_frame_base, x_point) == pytest.approx((length, 0.0, 0.0), abs=1e-15)
    _, y, z = apply(T_frame_base, xy_point)
    assert y > 0
    assert z == pytest.approx(0.0, abs=1e-15)


def test_frame_from_points_along_the_base_axes_is_the_base_orientation() -> None:
    assert frame_from_points([1, 2, 3, 9, 9, 9], [2, 2, 3], [5, 7, 3]) == pytest.approx((1, 2, 3, 0, 0, 0), abs=1e-15)


@pytest.mark.parametrize(
    ("x_point", "xy_point", "argument"),
    [
        ((0.1, 0.2, 0.3), (0.5, 0.5, 0.5), "x_point"),
        ((0.2, 0.2, 0.3), (0.7, 0.2, 0.3), "xy_point"),
        ((0.2, 0.2, 0.3), (0.1, 0.2, 0.3), "xy_point"),
        ((float("nan"), 0.2, 0.3), (0.5, 0.5, 0.5), "x_point"),
    ],
)
def test_frame_from_points_refuses_points_that_define_no_plane(
    x_point: tuple[float, ...], xy_point: tuple[float, ...], argument: str
) -> None:
    with pytest.raises(InvalidValueError) as caught:
        frame_from_points((0.1, 0.2, 0.3), x_point, xy_point)
    assert caught.value.argument == argument
    assert caught.value.unit == "m"
