from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        "str = 'part'\ntextmsg(str(5))",
        "max = 5\ntextmsg(max(1, 2))",
        "list = [1, 2]\ntextmsg(list(range(3)))",
        "sum = 0\nfor i in range(3):\n  sum = sum + i\nend\ntextmsg(sum([1]))",
    ],
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines.split("\n"))] == ["W245"]


@pytest.mark.parametrize(
    "lines",
    [
        "text = str(5)\ntextmsg(text)",
        "def max(a, b):\n  return a\nend\ntextmsg(max(1, 2))",
        "f = None\nif get_flag(0):\n  f = len\n  textmsg(f([1]))\nend",
        "class Part:\n  pass\nend\ntextmsg(Part())",
        "class Part:\n  def __call__(self):\n    return 1\n  end\nend\npart = Part()\ntextmsg(part())",
        "str = 'part'\ntry:\n  textmsg(str(5))\nexcept TypeError:\n  sync()\nend",
    ],
)
def test_what_almost_is_one_is_not_found(lines):
    assert body(*lines.split("\n")) == []
