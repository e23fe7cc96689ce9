"""Forward kinematics of nominal and calibrated arms."""

from __future__ import annotations

import json
import random
from math import cos, hypot, inf, nan, pi, sin
from pathlib import Path
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.transforms import (
    IDENTITY,
    Transform,
    compose,
    pose_from_transform,
    transform_from_pose,
)

DATA = json.loads((Path(__file__).parents[1] / "data" / "kinematics_vectors.json").read_text(encoding="utf-8"))[
    "models"
]
ARMS = {name: Arm(**model["dh"]) for name, model in DATA.items()}
VECTORS = [(name, vector) for name, model in DATA.items() for vector in model["vectors"]]
CS66 = ARMS["cs66"]

STANDARD_ALPHA = (pi / 2, 0.0, 0.0, pi / 2, -pi / 2, 0.0)


def difference(A: Transform, B: Transform) -> float:
    return max(abs(a - b) for a, b in zip(A, B, strict=True))


def standard_link(q: float, d: float, a: float, alpha: float) -> Transform:
    c, s, ca, sa = cos(q), sin(q), cos(alpha), sin(alpha)
    return c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca, a * c, a * s, d


def modified_link(q: float, d: float, a: float, alpha: float) -> Transform:
    c, s, ca, sa = cos(q), sin(q), cos(alpha), sin(alpha)
    return c, -s, 0.0, s * ca, c * ca, -sa, s * sa, c * sa, ca, a, -sa * d, ca * d


def random_joints(rng: random.Random) -> tuple[float, float, float, float, float, float]:
    q1, q2, q3, q4, q5, q6 = (rng.uniform(-2 * pi, 2 * pi) for _ in range(6))
    return q1, q2, q3, q4, q5, q6


@pytest.mark.parametrize(("model", "vector"), VECTORS, ids=[vector["id"] for _, vector in VECTORS])
def test_forward_meets_the_vector(model: str, vector: dict[str, Any]) -> None:
    arm = ARMS[model]
    T_base_flange = arm.forward(vector["q"])
    rows = [element for row in vector["flange_rotation"] for element in row]
    assert T_base_flange == pytest.approx((*rows, *vector["flange_position"]), abs=1e-14)
    T_base_tcp = arm.forward_tcp(vector["q"], transform_from_pose(vector["tcp_offset"]))
    assert T_base_tcp == pytest.approx(transform_from_pose(vector["tcp_pose"]), abs=1e-14)


def test_manual_example_of_forward_kinematics_on_a_cs66() -> None:
    p = pose_from_transform(CS66.forward((-0.2, -1.6, -1.4, -1.5, 1.5, 0.0)))
    assert p == pytest.approx((0.471919, -0.252803, 0.575060, -2.928686, -0.069203, -1.785744), abs=6e-7)


@pytest.mark.parametrize("model", ARMS)
def test_forward_is_the_product_of_the_links_in_both_conventions(model: str) -> None:
    arm = ARMS[model]
    rng = random.Random(10)
    a, d, alpha = arm.modified_dh
    for _ in range(50):
        q = random_joints(rng)
        standard = modified = IDENTITY
        for i in range(6):
            standard_a = (0.0, arm.a2, arm.a3, 0.0, 0.0, 0.0)[i]
            standard = compose(standard, standard_link(q[i], d[i], standard_a, STANDARD_ALPHA[i]))
            modified = compose(modified, modified_link(q[i], d[i], a[i], alpha[i]))
        assert difference(arm.forward(q), standard) < 2e-14
        assert difference(arm.forward(q), modified) < 2e-14


def test_at_zero_the_arm_lies_along_minus_x_and_the_flange_looks_along_minus_y() -> None:
    T = CS66.forward((0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert T[9:] == pytest.approx((CS66.a2 + CS66.a3, -(CS66.d4 + CS66.d6), CS66.d1 - CS66.d5), abs=1e-15)
    assert (T[2], T[5], T[8]) == pytest.approx((0.0, -1.0, 0.0), abs=1e-15)


def test_elbow_stays_an_upper_arm_away_from_the_shoulder() -> None:
    rng = random.Random(11)
    for _ in range(50):
        q = random_joints(rng)
        x, y, z = CS66.elbow(q)
        assert hypot(x, y, z - CS66.d1) == pytest.approx(-CS66.a2, abs=1e-15)
        # A chain with the nominal parameters has its third frame in the same place.
        assert CS66.calibrated().elbow(q) == pytest.approx((x, y, z), abs=1e-15)


@pytest.mark.parametrize("q", [(0.0,) * 5, (0.0,) * 7])
def test_joint_vectors_of_the_wrong_length_are_refused(q: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="values to unpack"):
        CS66.forward(q)


@pytest.mark.parametrize(
    ("name", "length"), [("d1", nan), ("d6", inf), ("a2", 0.0), ("a2", 0.4), ("a3", 0.3), ("d4", 0.0), ("d4", -0.1)]
)
def test_lengths_that_make_no_arm_are_refused_by_name(name: str, length: float) -> None:
    lengths = {**DATA["cs66"]["dh"], name: length}
    with pytest.raises(UsageError, match=rf"{name} of the arm is {length} m"):
        Arm(**lengths)


def test_calibration_with_the_nominal_numbers_changes_nothing() -> None:
    rng = random.Random(12)
    arm = CS66.calibrated(*CS66.modified_dh)
    assert arm.modified_dh == CS66.modified_dh
    for _ in range(50):
        q = random_joints(rng)
        assert difference(arm.forward(q), CS66.forward(q)) < 2e-14


def test_calibrated_arm_is_the_product_of_its_measured_links() -> None:
    rng = random.Random(13)
    a, d, alpha = ([value + rng.uniform(-1e-3, 1e-3) for value in row] for row in CS66.modified_dh)
    arm = CS66.calibrated(a, d, alpha)
    assert arm.modified_dh == (tuple(a), tuple(d), tuple(alpha))
    for _ in range(50):
        q = random_joints(rng)
        product = IDENTITY
        for i in range(6):
            product = compose(product, modified_link(q[i], d[i], a[i], alpha[i]))
        assert difference(arm.forward(q), product) < 2e-14


def test_calibration_keeps_what_is_not_given() -> None:
    a, d, alpha = CS66.modified_dh
    longer = [*a[:2], a[2] - 1e-4, *a[3:]]
    arm = CS66.calibrated(a=longer).calibrated(d=[d[0] + 1e-4, *d[1:]])
    assert arm.modified_dh == (tuple(longer), (d[0] + 1e-4, *d[1:]), alpha)


@pytest.mark.parametrize(
    ("rows", "text"),
    [
        ({"a": [0.0] * 5}, "a needs six numbers"),
        ({"d": [nan] * 6}, r"d\[0\] is nan"),
        ({"a": CS66.modified_dh[1]}, r"a\[0\] of the calibration is 0.1625 m, nominal is 0 m"),
        ({"alpha": [0.0] * 6}, r"alpha\[1\] of the calibration is 0 rad, nominal is 1.5708 rad"),
    ],
)
def test_calibrations_that_cannot_be_are_refused(rows: dict[str, Any], text: str) -> None:
    with pytest.raises(UsageError, match=text):
        CS66.calibrated(**rows)
