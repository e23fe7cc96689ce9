from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "a = get_target_tcp_pose()",
            "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])",
            "for i in range(101):",
            "  movel(interpolate_pose(a, b, i))",
            "end",
        ),
        ("a = get_target_tcp_pose()", "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])", "movel(interpolate_pose(a, b, 50))"),
        (
            "a = get_target_tcp_pose()",
            "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])",
            "x = 75",
            "movel(interpolate_pose(a, b, x))",
        ),
        (
            "a = get_target_tcp_pose()",
            "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])",
            "for x in [25, 50, 100]:",
            "  movel(interpolate_pose(a, b, x))",
            "end",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W267"]


@pytest.mark.parametrize(
    "lines",
    [
        ("a = get_target_tcp_pose()", "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])", "movel(interpolate_pose(a, b, 0.5))"),
        ("a = get_target_tcp_pose()", "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])", "movel(interpolate_pose(a, b, 1.2))"),
        (
            "a = get_target_tcp_pose()",
            "b = pose_add(a, [0, 0, 0.1, 0, 0, 0])",
            "movel(interpolate_pose(a, b, 50 / 100))",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W267" not in [problem.split()[0] for problem in body(*lines)]
