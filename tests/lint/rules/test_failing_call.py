from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ('textmsg(float("1,5"))',),
        ('textmsg(int("1.5"))',),
        (
            's = "12 mm"',
            "textmsg(int(s))",
        ),
        ('textmsg(to_num("abc"))',),
        ('textmsg(str_at("abc", 3))',),
        ("textmsg(max([]))",),
        (
            "import math",
            "textmsg(math.sqrt(-4))",
        ),
        ('textmsg(float("ab"))',),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W278"]


@pytest.mark.parametrize(
    "lines",
    [
        ('textmsg(float("1.5"))',),
        ('textmsg(int(" 12 "))',),
        ('textmsg(int("ff", 16))',),
        ('textmsg(to_num("1e3"))',),
        ('textmsg(str_at("abc", 2))',),
        ("textmsg(max([1]))",),
        (
            "try:",
            '  textmsg(int("x"))',
            "except ValueError:",
            '  textmsg("no")',
            "end",
        ),
        ("textmsg(int(socket_read_string()))",),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W278" not in [problem.split()[0] for problem in body(*lines)]
