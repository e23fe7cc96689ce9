from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000)', 'socket_open("10.0.0.3", 6000)'),
        ('a = socket_open("10.0.0.2", 5000, "a")', 'b = socket_open("10.0.0.2", 5001, "a")', "textmsg(a, b)"),
        ("def cam():", '  socket_open("10.0.0.2", 5000)', "end", "cam()", 'socket_open("10.0.0.3", 6000)'),
        (
            "def cam():",
            '  socket_open("10.0.0.2", 5000)',
            *("end", "def plc():", '  socket_open("10.0.0.3", 5000)', "end", "cam()", "plc()"),
        ),
        ('socket_open("10.0.0.2", 5000)', 'if not socket_open("10.0.0.3", 5000):', "  halt()", "end"),
        (
            'while not socket_open("10.0.0.2", 5000):',
            "  sleep(1)",
            "end",
            'while not socket_open("10.0.0.3", 5000):',
            "  sleep(1)",
            "end",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W247"]


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000)', 'socket_open("10.0.0.2", 5000)'),
        ('socket_open("10.0.0.2", 5000)', 'socket_open("10.0.0.3", 6000, "plc")'),
        ('if not socket_open("10.0.0.2", 5000):', '  socket_open("10.0.0.3", 5000)', "end"),
        ('ok = socket_open("10.0.0.2", 5000) or socket_open("10.0.0.3", 5000)', "textmsg(ok)"),
        ('socket_open("10.0.0.2", 5000)', "socket_close()", 'socket_open("10.0.0.3", 5000)'),
        ("if get_flag(0):", '  socket_open("10.0.0.2", 5000)', "else:", '  socket_open("10.0.0.3", 5000)', "end"),
        ("def cam():", '  socket_open("10.0.0.2", 5000)', "end", 'socket_open("10.0.0.2", 6000)', "cam()", "cam()"),
        ("try:", '  socket_open("10.0.0.2", 5000)', "except:", '  socket_open("10.0.0.3", 5000)', "end"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W247" not in [problem.split()[0] for problem in body(*lines)]
