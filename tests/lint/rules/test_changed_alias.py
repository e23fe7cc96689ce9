from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("home = [0, -1.5, -1.5, -1.5, 1.5, 0]", "up = home", "up[1] = -1.2", "movej(up)", "movej(home)"),
        ("p = get_target_tcp_pose()", "above = p", "above[2] = above[2] + 0.1", "movel(above)", "movel(p)"),
        ("p = get_target_tcp_pose()", "kept = p", "p[2] = 0.3", "movel(p)", "movel(kept)"),
        (
            *("home = [0, -1.5, -1.5, -1.5, 1.5, 0]", "def up():", "  q = home", "  q[1] = q[1] + 0.1", "  movej(q)"),
            *("end", "up()", "movej(home)"),
        ),
        (
            *(
                "home = [0, -1.5, -1.5, -1.5, 1.5, 0]",
                "for i in range(3):",
                "  q = home",
                "  q[1] += 0.1",
                "  movej(q)",
            ),
            "end",
        ),
        (
            *("points = [[0.4, 0, 0.3, 3.1, 0, 0], [0.5, 0, 0.3, 3.1, 0, 0]]", "above = points[0]"),
            *("above[2] = above[2] + 0.05", "movel(above)", "movel(points[0])"),
        ),
        ("a = b = [0.4, 0, 0.3, 3.1, 0, 0]", "b[2] = 0.5", "movel(a)", "movel(b)"),
        (
            *("p = get_target_tcp_pose()", "def above(q):", "  q[2] = q[2] + 0.1", "  return q", "end"),
            *("movel(above(p))", "movel(p)"),
        ),
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
        (
            *("points = [[0.4, 0, 0.3, 3.1, 0, 0], [0.5, 0, 0.3, 3.1, 0, 0]]", "first = points[0]", "first[2] = 0.4"),
            *("for p in points:", "  movel(p)", "end"),
        ),
        (
            *("points = [[0.4, 0, 0.3, 3.1, 0, 0], [0.5, 0, 0.3, 3.1, 0, 0]]", "a = points[0]", "a[2] = a[2] + 0.05"),
            *("movel(a)", "movel(points[1])"),
        ),
        (
            *("p = get_target_tcp_pose()", "def above(q):", "  q[2] = q[2] + 0.1", "  return q", "end"),
            *("p = above(p)", "movel(p)"),
        ),
        (*("p = get_target_tcp_pose()", "def lift(q):", "  q[2] = q[2] + 0.1", "end", "lift(p)", "movel(p)"),),
        (
            *("home = [0, -1.5, -1.5, -1.5, 1.5, 0]", "def up():", "  q = home.copy()", "  q[1] = q[1] + 0.1"),
            *("  movej(q)", "end", "up()", "movej(home)"),
        ),
        (
            "for i in range(3):",
            "  q = get_target_joint_positions()",
            "  up = q",
            "  up[1] += 0.1",
            "  movej(up)",
            "end",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W263" not in [problem.split()[0] for problem in body(*lines)]
