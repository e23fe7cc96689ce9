from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("for i in range(100):", "  movel([0.4, -0.2 + 0.001 * i, 0.4, 3.14, 0, 0])", "end"),
        ("i = 1", "while i <= 200:", "  movel([0.4, -0.2 + 0.001 * i, 0.4, 3.14, 0, 0], v=0.2)", "  i = i + 1", "end"),
        ("p = get_target_tcp_pose()", "for k in range(100):", "  p[0] = p[0] + 0.002", "  movel(p)", "end"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["N224"]


@pytest.mark.parametrize(
    "lines",
    [
        ("for i in range(100):", "  movel([0.4, -0.2 + 0.001 * i, 0.4, 3.14, 0, 0], r=0.0004)", "end"),
        ("for i in range(10):", "  movel([0.4, -0.2 + 0.001 * i, 0.4, 3.14, 0, 0])", "end"),
        ("for i in range(100):", "  movel([0.4, -0.2 + 0.05 * (i % 3), 0.4, 3.14, 0, 0])", "end"),
        ("for i in range(40):", "  movel([0.4, -0.2 + 0.01 * i, 0.4, 3.14, 0, 0])", "end"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "N224" not in [problem.split()[0] for problem in body(*lines)]
