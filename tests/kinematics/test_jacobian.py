"""Jacobian, twists, joint speeds and the distance from singularities."""

from __future__ import annotations

import random
from math import atan2, cos, pi, sin

import pytest

from elitescript.kinematics.arm import Arm
from elitescript.kinematics.jacobian import (
    Singularity,
    jacobian,
    joint_speeds,
    singularity,
    tcp_twist,
)
from elitescript.kinematics.rotations import multiply, rotvec_from_rotation, transpose
from elitescript.kinematics.transforms import IDENTITY, Transform, rotation_of, transform_from_pose

CS66 = Arm(0.1625, -0.427, -0.3905, 0.1475, 0.0965, 0.092)
CS620 = Arm(0.2350, -0.9000, -0.7720, 0.1725, 0.1280, 0.1250)
MEASURED = CS66.calibrated(
    a=(1e-4, -2e-4, -0.4272, -0.3903, 1e-4, -1e-4),
    d=(0.1626, 2e-4, -1e-4, 0.1474, 0.0966, 0.0919),
    alpha=(3e-4, pi / 2 - 2e-4, 4e-4, -1e-4, pi / 2 + 2e-4, -pi / 2 + 1e-4),
)
ARMS = {"CS66": CS66, "CS620": CS620, "measured": MEASURED}
OFFSETS = {
    "flange": IDENTITY,
    "along z": transform_from_pose((0.0, 0.0, 0.15, 0.0, 0.0, 0.0)),
    "aside": transform_from_pose((0.1, -0.07, 0.2, 0.3, -0.2, 1.1)),
}
STEP = 1e-5


def random_joints(rng: random.Random) -> tuple[float, ...]:
    return tuple(rng.uniform(-pi, pi) for _ in range(6))


def difference_twist(before: Transform, after: Transform, span: float) -> list[float]:
    turn = rotvec_from_rotation(multiply(rotation_of(after), transpose(rotation_of(before))))
    return [(b - a) / span for a, b in zip(before[9:], after[9:], strict=True)] + [angle / span for angle in turn]


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("arm", ARMS)
def test_jacobian_is_the_derivative_of_the_forward_kinematics(arm: str, offset: str) -> None:
    rng = random.Random(40)
    for _ in range(15):
        q = random_joints(rng)
        J = jacobian(ARMS[arm], q, OFFSETS[offset])
        for joint in range(6):
            nudge = [STEP * (i == joint) for i in range(6)]
            before = ARMS[arm].forward_tcp([a - b for a, b in zip(q, nudge, strict=True)], OFFSETS[offset])
            after = ARMS[arm].forward_tcp([a + b for a, b in zip(q, nudge, strict=True)], OFFSETS[offset])
            assert [row[joint] for row in J] == pytest.approx(difference_twist(before, after, 2 * STEP), abs=1e-9)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("arm", ARMS)
def test_twist_is_the_jacobian_times_the_joint_speeds(arm: str, offset: str) -> None:
    rng = random.Random(41)
    for _ in range(30):
        q, qd = random_joints(rng), random_joints(rng)
        expected = [sum(j * s for j, s in zip(row, qd, strict=True)) for row in jacobian(ARMS[arm], q, OFFSETS[offset])]
        assert tcp_twist(ARMS[arm], q, qd, OFFSETS[offset]) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("arm", ARMS)
def test_joint_speeds_give_the_twist(arm: str, offset: str) -> None:
    rng = random.Random(42)
    for _ in range(30):
        q = random_joints(rng)
        twist = [rng.uniform(-1, 1) for _ in range(6)]
        qd = joint_speeds(ARMS[arm], q, twist, OFFSETS[offset])
        assert qd is not None
        scale = max(1.0, *(abs(speed) for speed in qd))
        assert tcp_twist(ARMS[arm], q, qd, OFFSETS[offset]) == pytest.approx(twist, abs=1e-11 * scale)


@pytest.mark.parametrize(
    "q",
    [
        (0.3, -1.0, 1.2, 0.4, 0.0, 2.0),
        (0.3, -1.0, 1.2, 0.4, pi, 2.0),
        (0.3, -1.0, 0.0, 0.4, 1.0, 2.0),
        (0.3, -1.0, pi, 0.4, 1.0, 2.0),
    ],
)
@pytest.mark.parametrize("arm", ["CS66", "CS620"])
def test_singular_arm_has_no_joint_speeds(arm: str, q: tuple[float, ...]) -> None:
    assert joint_speeds(ARMS[arm], q, (0.1, 0.0, 0.0, 0.0, 0.0, 0.0)) is None


def test_singular_calibrated_arm_has_no_joint_speeds() -> None:
    assert joint_speeds(CS66.calibrated(), (0.3, -1.0, 0.0, 0.4, 0.0, 2.0), (0.1,) * 6) is None


def test_determinant_is_the_product_of_the_three_singularities() -> None:
    np = pytest.importorskip("numpy")
    rng = random.Random(43)
    for _ in range(30):
        q = random_joints(rng)
        distance = singularity(CS66, q)
        expected = CS66.a2 * CS66.a3 * distance.wrist * distance.elbow * distance.shoulder
        for T_flange_tcp in OFFSETS.values():
            assert abs(np.linalg.det(np.array(jacobian(CS66, q, T_flange_tcp)))) == pytest.approx(expected, abs=1e-14)


def test_shoulder_singularity_is_the_radial_coordinate_of_the_wrist_centre() -> None:
    q = (0.3, -1.0, 1.2, 0.4, -0.9, 2.0)
    T = CS66.forward(q)
    wx, wy = T[9] - CS66.d6 * T[2], T[10] - CS66.d6 * T[5]
    distance = singularity(CS66, q)
    assert distance.shoulder**2 + CS66.d4**2 == pytest.approx(wx * wx + wy * wy, abs=1e-15)
    assert distance.wrist == pytest.approx(abs(sin(q[4])))
    assert distance.elbow == pytest.approx(abs(sin(q[2])))


@pytest.mark.parametrize(
    ("distance", "name"),
    [
        (Singularity(0.001, 0.001, 0.001), None),
        (Singularity(0.0009, 1.0, 1.0), "wrist"),
        (Singularity(1.0, 0.0009, 1.0), "elbow"),
        (Singularity(1.0, 1.0, 0.0009), "shoulder"),
    ],
)
def test_blocking_singularity_is_named(distance: Singularity, name: str | None) -> None:
    assert distance.blocked == name


def test_joint_speeds_grow_with_the_inverse_distance_from_the_wrist_singularity() -> None:
    speeds = [joint_speeds(CS66, (0.3, -1.0, 1.2, 0.4, q5, 2.0), (0, 0, 0, 0.1, 0.2, 0.3)) for q5 in (1e-2, 1e-3)]
    assert speeds[0] is not None
    assert speeds[1] is not None
    assert speeds[1][5] / speeds[0][5] == pytest.approx(10.0, rel=0.05)


@pytest.mark.parametrize("arm", ARMS)
def test_joint_speeds_that_keep_clear_end_where_a_move_does_and_are_the_same_elsewhere(arm: str) -> None:
    rng = random.Random(44)
    near = (0.0, 0.0005, 0.0009999, 0.0010001, 0.002, pi, 3.1411)
    twist = (0.1, -0.2, 0.05, 0.3, -0.1, 0.2)
    outcomes = set()
    for _ in range(500):
        q = list(random_joints(rng))
        for joint in (2, 4):
            q[joint] = rng.choice((*near, q[joint], q[joint], q[joint])) * rng.choice((1.0, -1.0))
        blocked = singularity(ARMS[arm], q).blocked
        wanted = None if blocked else joint_speeds(ARMS[arm], q, twist, OFFSETS["aside"])
        assert joint_speeds(ARMS[arm], q, twist, OFFSETS["aside"], keeps_clear=True) == wanted
        outcomes.add(blocked)
    assert {None, "wrist", "elbow"} <= outcomes


def test_joint_speeds_keep_clear_of_the_shoulder_singularity() -> None:
    q3, q4 = 1.2, 0.4
    # The wrist centre is at X = 0 for this q2.
    q2 = atan2(CS66.a2 + CS66.a3 * cos(q3) + CS66.d5 * sin(q3 + q4), CS66.a3 * sin(q3) - CS66.d5 * cos(q3 + q4))
    for change, is_clear in ((0.0, False), (1e-3, False), (2e-2, True)):
        q = (0.3, q2 + change, q3, q4, -0.9, 2.0)
        assert (singularity(CS66, q).blocked is None) is is_clear
        assert (joint_speeds(CS66, q, (0.1,) * 6, keeps_clear=True) is not None) is is_clear
