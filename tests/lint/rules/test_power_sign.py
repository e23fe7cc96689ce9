from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        ("textmsg(3 ^ 2)",),
        (
            "x = 3",
            "y = 4",
            "textmsg(sqrt(x ^ 2 + y ^ 2))",
        ),
        (
            "x = 3",
            "textmsg((x ^ 2) + (x ^ 2))",
        ),
        (
            "x = 3",
            "textmsg(sqrt(x ^ 2))",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W279"]


@pytest.mark.parametrize(
    "lines",
    [
        ("textmsg(3 ** 2)",),
        (
            "n = read_input_integer_register(0)",
            "textmsg(n ^ 1)",
        ),
        (
            "n = read_input_integer_register(0)",
            "textmsg(n ^ 2)",
        ),
        (
            "n = read_input_integer_register(0)",
            "m = n ^ read_input_integer_register(1)",
            "textmsg(m)",
        ),
        ("textmsg(0xff ^ 0x0f)",),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W279" not in [problem.split()[0] for problem in body(*lines)]
