from __future__ import annotations

import pytest

from tests.lint.checking import body, repaired


@pytest.mark.parametrize(
    "lines",
    [
        ("grid = [[0] * 3] * 3", "grid[0][1] = 1", "textmsg(grid)"),
        ("rows = [[]] * 3", "rows[0].append(1)", "textmsg(rows)"),
        ("n = read_input_integer_register(0)", "rows = n * [[0, 0]]", "rows[1][0] += 1", "textmsg(rows)"),
        ("rows = [[0, 0]] * 3", "for row in rows:", "  row[0] = row[0] + 1", "end", "textmsg(rows)"),
        ("p = get_target_tcp_pose()", "points = [p] * 3", "points[1][0] = 0.5", "movel(points[0])"),
        (
            *("p = get_target_tcp_pose()", "points = []", "for i in range(3):", "  p[0] = 0.4 + 0.05 * i"),
            *("  points.append(p)", "end", "textmsg(points)"),
        ),
        ("row, rows = [], []", "for i in range(3):", "  row.append(i)", "  rows.append(row)", "end", "textmsg(rows)"),
        ("def add(x, found=[]):", "  found.append(x)", "  return found", "end", "textmsg(add(1), add(2))"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W224"]


@pytest.mark.parametrize(
    "lines",
    [
        ("grid = [[0] * 3 for _ in range(3)]", "grid[0][1] = 1", "textmsg(grid)"),
        ("grid = [[0] * 3] * 3", "textmsg(grid)"),
        ("grid = [[0] * 3] * 3", "grid[0] = [1, 2, 3]", "textmsg(grid)"),
        ("row = [0] * 3", "row[0] = 1", "textmsg(row)"),
        ("grid = [[0] * 3] * 1", "grid[0][1] = 1", "textmsg(grid)"),
        (
            *("p = get_target_tcp_pose()", "points = []", "for i in range(3):", "  p[0] = 0.4 + 0.05 * i"),
            *("  points.append(p.copy())", "end", "textmsg(points)"),
        ),
        (
            *("points = []", "for i in range(3):", "  p = get_target_tcp_pose()", "  p[0] = 0.4 + 0.05 * i"),
            *("  points.append(p)", "end", "textmsg(points)"),
        ),
        (
            *("p = get_target_tcp_pose()", "points = []", "for i in range(3):", "  p[0] = 0.4 + 0.05 * i"),
            *("  if p[0] > 0.42:", "    points.append(p)", "    break", "  end", "end", "textmsg(points)"),
        ),
        ("def add(x, found=[]):", "  return found + [x]", "end", "textmsg(add(1), add(2))"),
        (
            *("def add(x, found=None):", "  if found is None:", "    found = []", "  end", "  found.append(x)"),
            *("  return found", "end", "textmsg(add(1))"),
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W224" not in [problem.split()[0] for problem in body(*lines)]


def test_the_repair_adds_copies():
    text = """
        def job():
          p = get_target_tcp_pose()
          points = []
          for i in range(3):
            p[0] = 0.4 + 0.05 * i
            points.append(p)
          end
          textmsg(points)
        end
        """
    assert "points.append(p.copy())" in repaired(text)
