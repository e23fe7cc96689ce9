"""Geometry of lines and arcs."""

from __future__ import annotations

import random
from math import cos, dist, hypot, pi, sin

import pytest

from elitescript.errors import MotionError
from elitescript.kinematics.rotations import multiply, rotate, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import (
    Transform,
    compose,
    interpolate,
    inverse,
    position_of,
    rotation_of,
    transform_from_pose,
)
from elitescript.motion.paths.cartesian import ArcPath, CartesianPath, LinePath, arc, line
from tests.motion.moves import T_FLANGE_TCP, largest_difference

RADIUS = 0.25
T_TCP_FLANGE = inverse(T_FLANGE_TCP)
CENTRE = (0.4, -0.1, 0.3)
CIRCLE_RADIUS = 0.12


def random_pose(rng: random.Random) -> Transform:
    return transform_from_pose([rng.uniform(-1, 1) for _ in range(3)] + [rng.uniform(-pi, pi) for _ in range(3)])


def line_between(T_start: Transform, T_end: Transform) -> LinePath:
    return line(compose(T_start, T_TCP_FLANGE), T_start, T_end, RADIUS)


def on_circle(angle: float, rx: float = 0.2, ry: float = 0.1, rz: float = 0.0) -> Transform:
    x, y, z = CENTRE
    return transform_from_pose((x + CIRCLE_RADIUS * cos(angle), y + CIRCLE_RADIUS * sin(angle), z, rx, ry, rz))


def arc_over(via: float, end: float, is_orientation_fixed: bool = True, T_end: Transform | None = None) -> ArcPath:
    T_start = on_circle(0.0)
    flange = compose(T_start, T_TCP_FLANGE)
    return arc(flange, T_start, on_circle(via), T_end or on_circle(end), is_orientation_fixed)


def tcp(path: CartesianPath, s: float) -> Transform:
    return compose(path.flange(s), T_FLANGE_TCP)


def turn_between(T_a: Transform, T_b: Transform) -> float:
    return hypot(*rotvec_from_rotation(multiply(transpose(rotation_of(T_a)), rotation_of(T_b))))


@pytest.mark.parametrize("seed", range(20))
def test_line_runs_straight_and_turns_by_the_shortest_rotation_in_step(seed: int) -> None:
    rng = random.Random(seed)
    T_start, T_end = random_pose(rng), random_pose(rng)
    path = line_between(T_start, T_end)
    assert path.unit == "m"
    assert path.length == pytest.approx(dist(position_of(T_start), position_of(T_end)))
    for share in (0.0, 0.1, 0.37, 0.8, 1.0):
        assert largest_difference(tcp(path, share * path.length), interpolate(T_start, T_end, share)) < 1e-14


@pytest.mark.parametrize("seed", range(10))
def test_line_with_one_orientation_keeps_it_bit_for_bit(seed: int) -> None:
    rng = random.Random(seed)
    T_start = random_pose(rng)
    path = line_between(T_start, (*rotation_of(T_start), *position_of(random_pose(rng))))
    assert path.turn == 0.0
    assert rotation_of(path.flange(0.4 * path.length)) == rotation_of(path.flange(0.0))


@pytest.mark.parametrize("path", [line_between(random_pose(random.Random(3)), random_pose(random.Random(4)))])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.9])
def test_slope_of_a_line_is_its_derivative(path: CartesianPath, share: float) -> None:
    check_slope(path, share * path.length)


@pytest.mark.parametrize("is_orientation_fixed", [True, False])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.9])
def test_slope_of_an_arc_is_its_derivative(is_orientation_fixed: bool, share: float) -> None:
    path = arc_over(1.0, 2.5, is_orientation_fixed, on_circle(2.5, 0.5, -0.4, 1.0))
    check_slope(path, share * path.length)


def check_slope(path: CartesianPath, s: float) -> None:
    h = 1e-6
    before, after = path.flange(s - h), path.flange(s + h)
    T_base_flange, slope = path.flange_and_slope(s)
    assert T_base_flange == path.flange(s)
    linear = [(b - a) / (2.0 * h) for a, b in zip(position_of(before), position_of(after), strict=True)]
    assert largest_difference(slope[:3], linear) < 1e-8
    in_flange = rotvec_from_rotation(multiply(transpose(rotation_of(before)), rotation_of(after)))
    angular = [w / (2.0 * h) for w in rotate(rotation_of(path.flange(s)), in_flange)]
    assert largest_difference(slope[3:], angular) < 1e-8


def test_move_that_only_turns_is_measured_in_radians() -> None:
    T_start = transform_from_pose((0.4, 0.1, 0.3, 0.0, 0.0, 0.0))
    T_end = transform_from_pose((0.4, 0.1, 0.3, 0.0, 0.0, 1.2))
    path = line_between(T_start, T_end)
    assert path.unit == "rad"
    assert path.length == pytest.approx(1.2)
    assert path.tool_rates == (0.0, pytest.approx(1.0))
    assert position_of(tcp(path, 0.5)) == pytest.approx((0.4, 0.1, 0.3), abs=1e-15)


@pytest.mark.parametrize(("distance", "unit"), [(1e-5, "rad"), (2.9e-4, "rad"), (3.1e-4, "m"), (0.1, "m")])
def test_rotation_leads_only_when_the_translation_is_next_to_nothing(distance: float, unit: str) -> None:
    T_start = transform_from_pose((0.4, 0.1, 0.3, 0.0, 0.0, 0.0))
    T_end = transform_from_pose((0.4 + distance, 0.1, 0.3, 0.0, 0.0, 1.2))
    path = line_between(T_start, T_end)
    assert path.unit == unit
    assert largest_difference(tcp(path, path.length), T_end) < 1e-15


def test_tiny_translation_without_rotation_is_still_a_translation() -> None:
    T_start = transform_from_pose((0.4, 0.1, 0.3, 0.0, 0.0, 0.0))
    path = line_between(T_start, transform_from_pose((0.400001, 0.1, 0.3, 0.0, 0.0, 0.0)))
    assert path.unit == "m"
    assert path.length == pytest.approx(1e-6)


def test_same_pose_is_a_path_without_length() -> None:
    T_start = random_pose(random.Random(1))
    path = line_between(T_start, T_start)
    assert path.length == 0.0
    assert path.flange(0.0) == compose(T_start, T_TCP_FLANGE)


@pytest.mark.parametrize(("via", "end"), [(0.5, 1.0), (1.0, 3.0), (2.0, 4.5), (5.0, 6.2), (-0.5, -1.0), (-3.0, -6.0)])
def test_arc_goes_from_start_over_via_to_end_on_its_circle(via: float, end: float) -> None:
    path = arc_over(via, end)
    assert path.radius == pytest.approx(CIRCLE_RADIUS, rel=1e-12)
    assert path.angle == pytest.approx(abs(end), rel=1e-12)
    assert path.length == pytest.approx(CIRCLE_RADIUS * abs(end), rel=1e-12)
    assert dist(position_of(tcp(path, 0.0)), position_of(on_circle(0.0))) < 1e-14
    assert dist(position_of(tcp(path, CIRCLE_RADIUS * abs(via))), position_of(on_circle(via))) < 1e-13
    assert dist(position_of(tcp(path, path.length)), position_of(on_circle(end))) < 1e-13


@pytest.mark.parametrize("end", [1.0, 4.0])
def test_fixed_orientation_turns_with_the_tangent_and_ignores_that_of_the_end_pose(end: float) -> None:
    path = arc_over(0.5 * end, end, True, on_circle(end, 1.0, 1.0, 1.0))
    T_start = on_circle(0.0)
    for share in (0.2, 0.5, 1.0):
        angle = share * end
        turned = multiply(rotation_of(transform_from_pose((0, 0, 0, 0, 0, angle))), rotation_of(T_start))
        assert largest_difference(rotation_of(tcp(path, share * path.length)), turned) < 1e-13
    assert largest_difference(path.T_base_tcp_end, tcp(path, path.length)) < 1e-13


def test_free_orientation_turns_evenly_to_that_of_the_end_pose() -> None:
    T_end = on_circle(4.0, 0.5, -0.4, 1.0)
    path = arc_over(2.0, 4.0, False, T_end)
    T_start = on_circle(0.0)
    whole = turn_between(T_start, T_end)
    for share in (0.25, 0.5, 0.9):
        T = tcp(path, share * path.length)
        assert turn_between(T_start, T) == pytest.approx(share * whole, abs=1e-13)
        assert turn_between(T, T_end) == pytest.approx((1.0 - share) * whole, abs=1e-13)
    assert largest_difference(tcp(path, path.length), T_end) < 1e-13


@pytest.mark.parametrize(
    ("via", "end", "names", "hint"),
    [
        (0.0, 1.0, "start and the via point", "three different points"),
        (1.0, 1.0, "via and the end point", "three different points"),
        (1.0, 0.0, "start and the end point", "two arcs"),
    ],
)
def test_arc_of_coincident_points_is_refused(via: float, end: float, names: str, hint: str) -> None:
    with pytest.raises(MotionError, match=names) as caught:
        arc_over(via, end)
    assert caught.value.code == "R113"
    assert caught.value.unit == "m"
    assert hint in (caught.value.hint or "")


@pytest.mark.parametrize("position", [-0.3, 0.3, 0.5, 2.0])
def test_arc_of_points_on_a_line_is_refused(position: float) -> None:
    poses = [transform_from_pose((0.4 + 0.1 * x, 0.2 * x, 0.3, 0, 0, 0)) for x in (0.0, position, 1.0)]
    with pytest.raises(MotionError, match="lie on one line") as caught:
        arc(poses[0], *poses, True)
    assert caught.value.code == "R113"
    assert caught.value.hint == "use movel for a straight line"


def test_arc_that_is_almost_straight_still_meets_its_points() -> None:
    poses = [transform_from_pose((0.4 + x, 2e-6 * (x == 0.1), 0.3, 0, 0, 0)) for x in (0.0, 0.1, 0.2)]
    path = arc(poses[0], *poses, True)
    for s, T in ((0.0, poses[0]), (0.5 * path.length, poses[1]), (path.length, poses[2])):
        assert dist(position_of(path.flange(s)), position_of(T)) < 1e-9


def test_places_are_described_by_distance_and_unit() -> None:
    path = arc_over(1.0, 2.0)
    assert path.place(0.0) == "at the start"
    assert path.place(0.1) == "0.1000 m from the start of the arc of 0.2400 m"
    assert path.place(path.length) == "at the target, 0.2400 m from the start of the arc"
