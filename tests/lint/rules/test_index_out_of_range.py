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
        ('textmsg("abc"[5])',),
        ('s = "abc"', "textmsg(s[3])"),
        ('textmsg(b"ab"[2])',),
        ('d = {"a": 1}', 'textmsg(d["b"])'),
        ("p = [1, 2]", "for i in range(len(p) + 1):", "  textmsg(p[i])", "end"),
        ("p = [1, 2]", "for i in range(len(p)):", "  textmsg(p[i + 1])", "end"),
        ("p = [1, 2]", "for i in range(1, 3):", "  p[i] = 0", "end", "textmsg(p)"),
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
        ('s = "abc"', "textmsg(s[2])"),
        ('s = "abc"', "if get_flag(0):", '  s = "abcdef"', "end", "textmsg(s[3])"),
        ('d = {"a": 1}', 'd["b"] = 2', 'textmsg(d["b"])'),
        ('d = {"a": 1}', 'if "b" in d:', '  textmsg(d["b"])', "end"),
        ('d = {"a": 1}', "set_up(d)", 'textmsg(d["b"])', "def set_up(x):", '  x["b"] = 1', "end"),
        ("p = [1, 2]", "for i in range(len(p)):", "  textmsg(p[i])", "end"),
        ("p = [1, 2]", "for i in range(len(p)):", "  if i + 1 < len(p):", "    textmsg(p[i + 1])", "  end", "end"),
        ("p = [1, 2]", "for i in range(9):", "  if i == 2:", "    break", "  end", "  textmsg(p[i])", "end"),
        ("p = [1, 2]", "for i in range(3):", "  i = 0", "  textmsg(p[i])", "end"),
        ("a, *b = [1, 2, 3]", "textmsg(a, b)"),
        ("try:", "  textmsg([1][1])", "except IndexError:", '  textmsg("no")', "end"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W265" not in [problem.split()[0] for problem in body(*lines)]
