from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000, "cam")', 's = socket_read_string("cam", "\\n")', "textmsg(s)"),
        (
            'socket_open("10.0.0.2", 5000, "cam")',
            's = socket_read_string("cam", prefix="\\r\\n", timeout=1)',
            "textmsg(s)",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W248"]


@pytest.mark.parametrize(
    "lines",
    [
        ('socket_open("10.0.0.2", 5000, "cam")', 's = socket_read_string("cam", suffix="\\n")', "textmsg(s)"),
        ('socket_open("10.0.0.2", 5000, "cam")', 's = socket_read_string("cam", "\\n", "\\n")', "textmsg(s)"),
        ('socket_open("10.0.0.2", 5000, "cam")', 's = socket_read_string("cam", "<", ">")', "textmsg(s)"),
        ('socket_open("10.0.0.2", 5000, "cam")', 's = socket_read_string("cam", "<")', "textmsg(s)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W248" not in [problem.split()[0] for problem in body(*lines)]
