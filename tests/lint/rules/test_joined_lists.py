from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        "p = get_actual_tcp_pose()\nmovel(p + [0, 0, 0.05, 0, 0, 0])",
        "p = get_actual_tcp_pose()\nup = p + [0, 0, 0.05, 0, 0, 0]\nmovel(up)",
        "q = get_actual_joint_positions()\nr = q * 2\ntextmsg(r)",
    ],
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines.split("\n"))] == ["W243"]


@pytest.mark.parametrize(
    "lines",
    [
        "p = get_actual_tcp_pose()\nmovel(pose_trans(p, [0, 0, 0.05, 0, 0, 0]))",
        "p = get_actual_tcp_pose()\nmovel(p[0:3] + p[3:6])",
        "q = get_actual_joint_positions()\nfor v in q + get_actual_tcp_pose():\n  textmsg(v)\nend",
        "rows = [[1, 2]] + [[3, 4]]\ntextmsg(rows)",
        "zeros = [0] * 6\nmovej(zeros)",
    ],
)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines.split("\n")) == []
