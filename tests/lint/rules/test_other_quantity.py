from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "r = socket_read_ascii_float(2)",
            "if r[0] == 2:",
            "  movel([r[0], r[1], 0.3, 3.14, 0, 0])",
            "end",
        ),
        (
            "r = socket_read_ascii_float(6)",
            "if r[0] == 6:",
            "  movej(r[0:6])",
            "end",
        ),
        (
            "p = get_actual_tcp_pose()",
            "movel([p[3], p[1], p[2], 3.14, 0, 0])",
        ),
        (
            "q = get_actual_joint_positions()",
            "p = get_actual_tcp_pose()",
            "movej([p[0], q[1], q[2], q[3], q[4], q[5]])",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W239"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "r = socket_read_ascii_float(2)",
            "if r[0] == 2:",
            "  movel([r[1], r[2], 0.3, 3.14, 0, 0])",
            "end",
        ),
        (
            "p = get_actual_tcp_pose()",
            "movel([p[0], p[1], p[2], p[3], p[4], p[5]])",
        ),
        (
            "r = 0.2",
            "a = d2r(90) * 0.2",
            "movel([a, 0, 0.3, 3.14, 0, 0])",
        ),
        (
            "r = socket_read_ascii_float(2)",
            "write_output_integer_register(0, r[0])",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W239" not in [problem.split()[0] for problem in body(*lines)]
