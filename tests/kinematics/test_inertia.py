"""Tensors of inertia that bodies can have."""

from __future__ import annotations

from random import Random

import pytest

from elitescript.kinematics.inertia import is_inertia_of_a_body


def test_every_cloud_of_points_has_one() -> None:
    chance = Random(3)
    for _ in range(300):
        xx = yy = zz = xy = xz = yz = 0.0
        for _ in range(chance.randint(1, 6)):
            m, (x, y, z) = chance.uniform(0, 2), [chance.uniform(-0.3, 0.3) for _ in range(3)]
            xx, yy, zz = xx + m * (y * y + z * z), yy + m * (x * x + z * z), zz + m * (x * x + y * y)
            xy, xz, yz = xy - m * x * y, xz - m * x * z, yz - m * y * z
        assert is_inertia_of_a_body((xx, yy, zz, xy, xz, yz))


@pytest.mark.parametrize(
    "inertia",
    [
        (0.0,) * 6,
        (0.004, 0.005, 0.006, 0.0003, -0.0002, 0.0001),
        # A thin disc, rounded to two digits.
        (0.011, 0.011, 0.023, 0.0, 0.0, 0.0),
    ],
)
def test_what_people_type_is_one(inertia: tuple[float, ...]) -> None:
    assert is_inertia_of_a_body(inertia)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "inertia",
    [
        (-0.1, 0.1, 0.1, 0.0, 0.0, 0.0),
        (0.1, 0.1, 0.3, 0.0, 0.0, 0.0),
        (0.1, 0.1, 0.1, 0.2, 0.0, 0.0),
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.1),
        # Positive moments, but tr(I) / 2 - I has a negative determinant with positive minors.
        (1.0, 1.0, 1.0, 0.4, 0.4, 0.4),
    ],
)
def test_what_no_body_has_is_none(inertia: tuple[float, ...]) -> None:
    assert not is_inertia_of_a_body(inertia)  # type: ignore[arg-type]
