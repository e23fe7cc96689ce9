from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "n = 3",
            'textmsg("part {n}")',
        ),
        (
            "p = get_target_tcp_pose()",
            'textmsg("x is {p[0]:.3f}")',
        ),
        (
            "n = 3",
            'textmsg("part %d", n)',
        ),
        (
            "n = 3",
            'textmsg("part {} of {}", n, 5)',
        ),
        (
            "n = 3",
            'socket_open("192.168.1.20", 5000)',
            'socket_send_line("part {n}")',
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W276"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "n = 3",
            'textmsg(f"part {n}")',
        ),
        (
            "n = 3",
            'textmsg("part %d" % n)',
        ),
        (
            "n = 3",
            'textmsg("part {}".format(n))',
        ),
        (
            "n = 3",
            'textmsg("{m} is no variable of the program", n)',
        ),
        (
            "n = 3",
            'textmsg("100% of ", n)',
        ),
        (
            "n = 3",
            'textmsg("part ", n, " of ", 5)',
        ),
        (
            'socket_open("192.168.1.20", 5000)',
            "socket_send_line('{\"a\": 1}')",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W276" not in [problem.split()[0] for problem in body(*lines)]
