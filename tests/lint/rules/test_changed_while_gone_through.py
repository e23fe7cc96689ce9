from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "parts = [1, 2, 3]",
            "for part in parts:",
            "  parts.remove(part)",
            "end",
        ),
        (
            "parts = [1, 2, 3]",
            "for part in parts:",
            "  parts.append(part)",
            "end",
        ),
        (
            "parts = [1, 2, 3]",
            "for i in range(len(parts)):",
            "  parts.pop(i)",
            "end",
        ),
        (
            "parts = [1, 2, 3]",
            "for part in parts:",
            "  if part == 2:",
            "    parts.remove(part)",
            "  end",
            "end",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W225"]


@pytest.mark.parametrize(
    "lines",
    [
        (
            "parts = [1, 2, 3]",
            "for part in parts.copy():",
            "  parts.remove(part)",
            "end",
        ),
        (
            "parts = [1, 2, 3]",
            "for part in parts:",
            "  if part == 2:",
            "    parts.remove(part)",
            "    break",
            "  end",
            "end",
        ),
        (
            "parts = [1, 2, 3]",
            "kept = []",
            "for part in parts:",
            "  kept.append(part)",
            "end",
            "textmsg(kept)",
        ),
        (
            "parts = [1, 2, 3]",
            "while len(parts) > 0:",
            "  parts.pop()",
            "end",
        ),
        (
            "parts = [1, 2, 3]",
            "for part in [4, 5]:",
            "  parts.append(part)",
            "end",
            "textmsg(parts)",
        ),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W225" not in [problem.split()[0] for problem in body(*lines)]
