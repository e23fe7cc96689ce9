from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000, "cam")', 's = socket_read_string("camera")', "textmsg(s)"),
        ('socket_open("10.0.0.2", 5000, "cam")', 'socket_send_string("cam", "x")'),
        ('socket_open("10.0.0.2", 5000, "cam")', "n = socket_read_ascii_float(3)", "textmsg(n)"),
        ('socket_open("10.0.0.2", 5000, "cam")', 'name = "plc"', "socket_send_int(1, name)"),
        ('socket_open("10.0.0.2", 5000)', 's = socket_read_string("\\n")', "textmsg(s)"),
        ('for n in ["a", "b"]:', '  socket_open("10.0.0.2", 5000, n)', "end", 'socket_send_line("x", 0, "c")'),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W246"]


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000, "cam")', 'socket_send_line("x", 0, "cam")'),
        ('s = socket_read_string("camera")', "textmsg(s)"),
        ("n = get_task_path()", 'socket_open("10.0.0.2", 5000, n)', 'socket_send_line("x", 0, "c")'),
        (
            "open = socket_open",
            'open("10.0.0.2", 5000, "b")',
            'socket_open("10.0.0.2", 5000)',
            'socket_send_line("x", 0, "b")',
        ),
        ('socket_open("10.0.0.2", 5000)', 'socket_send_line("x", 0, "")'),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W246" not in [problem.split()[0] for problem in body(*lines)]
