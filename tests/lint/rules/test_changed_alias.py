from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("home = [0, -1.5, -1.5, -1.5, 1.5, 0]", "up = home", "up[1] = -1.2", "movej(up)", "movej(home)"),
        ("p = get_target_tcp_pose()", "above = p", "above[2] = above[2] + 0.1", "movel(above)", "movel(p)"),
        ("p = get_target_tcp_pose()", "kept = p", "p[2] = 0.3", "movel(p)", "movel(kept)"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W263"]


@pytest.mark.parametrize(
    "lines",
    [
        ("p = get_target_tcp_pose()", "above = p.copy()", "above[2] = above[2] + 0.1", "movel(above)", "movel(p)"),
        ("p = get_target_tcp_pose()", "q = p", "q[2] = 0.3", "movel(q)"),
        ("p = get_target_tcp_pose()", "q = p", "p = get_target_tcp_pose()", "p[2] = 0.3", "movel(p)", "movel(q)"),
        ('row = ["a", "b"]', "other = row", 'other[0] = "c"', "textmsg(row)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W263" not in [problem.split()[0] for problem in body(*lines)]
