from __future__ import annotations

import random
from typing import Any

import pytest


def random_pose(source: random.Random) -> list[float]:
    return [source.uniform(-1, 1) for _ in range(3)] + [source.uniform(-1.5, 1.5) for _ in range(3)]


def test_pose_algebra_is_consistent(call: Any) -> None:
    source = random.Random(3)
    for _ in range(20):
        a, b = random_pose(source), random_pose(source)
        assert call("pose_trans", a, call("pose_inv", a)) == pytest.approx([0.0] * 6, abs=1e-12)
        assert call("pose_add", [*call("pose_sub", a, b)[:3], 0, 0, 0], b)[:3] == pytest.approx(a[:3])
        assert call("point_dist", a, b) == pytest.approx(call("norm", call("pose_sub", a, b)[:3]))
        assert call("interpolate_pose", a, b, 1) == pytest.approx(b, abs=1e-12)


def test_interpolation_goes_on_beyond_both_ends(call: Any) -> None:
    start, end = [0, 0, 0, 0, 0, 0], [1, 2, 3, 0, 0, 0.5]
    assert call("interpolate_pose", start, end, -1) == pytest.approx([-1, -2, -3, 0, 0, -0.5])
    assert call("interpolate_pose", start, end, 2) == pytest.approx([2, 4, 6, 0, 0, 1.0])


def test_angles_of_pose_dist_are_not_wrapped(call: Any) -> None:
    assert call("pose_dist", [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 6.25]) == pytest.approx(6.25)


def test_results_are_lists(call: Any) -> None:
    for name, arguments in (("pose_inv", [[0] * 6]), ("rotvec2rpy", [[0, 0, 1]]), ("rpy2rotvec", [[0, 0, 1]])):
        assert type(call(name, *arguments)) is list
