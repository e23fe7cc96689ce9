"""The numpy forms against the scalar functions."""

from __future__ import annotations

import random
import sys
from math import pi
from typing import Any

import pytest

from elitescript.errors import UsageError
from elitescript.kinematics import batch
from elitescript.kinematics.arm import Arm
from elitescript.kinematics.inverse import solutions
from elitescript.kinematics.limits import TURN
from elitescript.kinematics.transforms import Transform, transform_from_pose

CS66 = Arm(0.1625, -0.427, -0.3905, 0.1475, 0.0965, 0.092)
CS620 = Arm(0.2350, -0.9000, -0.7720, 0.1725, 0.1280, 0.1250)
MEASURED = CS66.calibrated(alpha=(3e-4, pi / 2 - 2e-4, 4e-4, -1e-4, pi / 2 + 2e-4, -pi / 2 + 1e-4))
ARMS = {"CS66": CS66, "CS620": CS620, "measured": MEASURED}
SINGULAR = [(0.4, -1.1, 1.3, -0.6, 0.0, 0.9), (0.4, -1.1, 1.3, -0.6, pi, 0.9), (0.3, -0.7, 0.0, -0.8, 1.2, 0.5)]


@pytest.fixture
def np() -> Any:
    return pytest.importorskip("numpy")


def matrix(T: Transform) -> list[list[float]]:
    return [[*T[0:3], T[9]], [*T[3:6], T[10]], [*T[6:9], T[11]], [0.0, 0.0, 0.0, 1.0]]


def sample(count: int) -> list[tuple[float, ...]]:
    rng = random.Random(50)
    return [tuple(rng.uniform(-pi, pi) for _ in range(6)) for _ in range(count)] + SINGULAR


@pytest.mark.parametrize("arm", ARMS)
def test_forward_equals_the_scalar_form(np: Any, arm: str) -> None:
    joints = sample(200)
    expected = np.array([matrix(ARMS[arm].forward(q)) for q in joints])
    assert np.abs(batch.forward(ARMS[arm], joints) - expected).max() < 1e-14


@pytest.mark.parametrize("arm", ARMS)
def test_inverse_equals_the_scalar_form(np: Any, arm: str) -> None:
    targets = [ARMS[arm].forward(q) for q in sample(200 if arm != "measured" else 10)]
    targets.append(transform_from_pose((2.5, 0.0, 0.0, 0.0, 0.0, 0.0)))
    targets.append((1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.5))
    q, mask = batch.inverse(ARMS[arm], np.array([matrix(T) for T in targets]), q6_near=0.3)
    assert q.shape == (len(targets), 8, 6)
    for index, T in enumerate(targets):
        expected = solutions(ARMS[arm], T, q6_near=0.3)
        assert np.flatnonzero(mask[index]).tolist() == [solution.branch for solution in expected]
        for solution in expected:
            turned = q[index, solution.branch] - np.array(solution.q)
            # Near singularities the two forms round differently.
            assert np.abs(turned - TURN * np.round(turned / TURN)).max() < 1e-7
    assert np.isnan(q[~mask]).all()
    assert (q[mask] > -pi).all()
    assert (q[mask] <= pi).all()


def test_no_poses_give_empty_arrays(np: Any) -> None:
    q, mask = batch.inverse(CS66, np.empty((0, 4, 4)))
    assert q.shape == (0, 8, 6)
    assert mask.shape == (0, 8)
    assert batch.forward(CS66, np.empty((0, 6))).shape == (0, 4, 4)


@pytest.mark.parametrize("shape", [(6,), (3, 5), (2, 6, 1)])
def test_joint_angles_of_the_wrong_shape_are_refused(np: Any, shape: tuple[int, ...]) -> None:
    with pytest.raises(UsageError, match=r"need the shape \(n, 6\)"):
        batch.forward(CS66, np.zeros(shape))


def test_transforms_of_the_wrong_shape_are_refused(np: Any) -> None:
    with pytest.raises(UsageError, match=r"need the shape \(n, 4, 4\); they have \(4, 4\)"):
        batch.inverse(CS66, np.eye(4))


def test_without_numpy_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "numpy", None)
    with pytest.raises(UsageError, match="pip install numpy"):
        batch.forward(CS66, [[0.0] * 6])
