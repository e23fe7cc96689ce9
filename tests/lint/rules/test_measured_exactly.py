from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        "home = [0, -1.5, 1.6, -1.67, -1.57, 0]\nwhile not get_actual_joint_positions() == home:\n  sync()\nend",
        "if get_actual_tcp_pose()[2] == 0.3:\n  halt()\nend",
        "p = get_actual_tcp_pose()\nz = p[2] - 0.1\nif z == 0.2:\n  halt()\nend",
        "if get_standard_analog_in(0) == 5.0:\n  halt()\nend",
        "if force() == 0:\n  halt()\nend",
        "p = get_target_tcp_pose()\nif point_dist(get_actual_tcp_pose(), p) == 0:\n  halt()\nend",
        "if norm(get_actual_tcp_pose()) == 3:\n  halt()\nend",
        "z = get_actual_tcp_pose()[2]\nif z in (0.3, 0.4):\n  halt()\nend",
        "if get_actual_tcp_speed() != [0, 0, 0, 0, 0, 0]:\n  halt()\nend",
    ],
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines.split("\n"))] == ["W242"]


@pytest.mark.parametrize(
    "lines",
    [
        "if get_target_joint_positions() == [0, 0, 0, 0, 0, 0]:\n  halt()\nend",
        "if get_actual_tcp_pose()[2] < 0.3:\n  halt()\nend",
        "if get_actual_tcp_pose() == get_actual_tcp_pose():\n  halt()\nend",
        "if round(get_actual_tcp_pose()[2]) == 1:\n  halt()\nend",
        "if floor(get_actual_tcp_pose()[2]) == 1:\n  halt()\nend",
        "if point_dist(get_actual_tcp_pose(), get_target_tcp_pose()) < 0.001:\n  halt()\nend",
        "if get_standard_digital_in(0) == 1:\n  halt()\nend",
        "def is_zero(p):\n  return p == [0] * len(p)\nend\nis_zero(get_actual_tcp_pose())\nis_zero([0, 0, 0, 0, 0, 0])",
        "p = get_actual_tcp_pose()\np[2] = 0.3\ngoal = [0, 0, 0.3, 0, 0, 0]\nif p == goal:\n  halt()\nend",
    ],
)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines.split("\n")) == []
