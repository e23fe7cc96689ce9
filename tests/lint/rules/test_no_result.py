from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "a = [2, 1]",
            "a = a.sort()",
            "textmsg(a)",
        ),
        (
            "a = [2, 1]",
            "b = a.append(3)",
            "textmsg(b)",
        ),
        (
            "a = [2, 1]",
            "b = a.reverse()",
            "for x in b:",
            "  textmsg(x)",
            "end",
        ),
        (
            "done = set_standard_digital_out(0, True)",
            "if done:",
            '  textmsg("done")',
            "end",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W277"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "a = [2, 1]",
            "a.sort()",
            "textmsg(a)",
        ),
        (
            "a = [2, 1]",
            "b = sorted(a)",
            "textmsg(b)",
        ),
        (
            "a = [2, 1]",
            "b = a.pop()",
            "textmsg(b)",
        ),
        (
            "done = set_standard_digital_out(0, True)",
            "sync()",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W277" not in [problem.split()[0] for problem in body(*lines)]
