from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("p = get_target_tcp_pose()", "textmsg(p[6])"),
        ("r = socket_read_ascii_float(3)", "textmsg(r[4])"),
        ("textmsg([1, 2][-3])",),
        ("a, b = [1, 2, 3]", "textmsg(a, b)"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W265"]


@pytest.mark.parametrize(
    "lines",
    [
        ("p = get_target_tcp_pose()", "textmsg(p[5])"),
        ("r = socket_read_ascii_float(3)", "textmsg(r[3])"),
        ("q = [1]", "q.append(2)", "textmsg(q[1])"),
        ("n = 9", "r = socket_read_ascii_float(n)", "textmsg(r[12])"),
        ("a, b = [1, 2]", "textmsg(a, b)"),
        ("a, *b = [1, 2, 3]", "textmsg(a, b)"),
        ("try:", "  textmsg([1][1])", "except IndexError:", '  textmsg("no")', "end"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W265" not in [problem.split()[0] for problem in body(*lines)]
