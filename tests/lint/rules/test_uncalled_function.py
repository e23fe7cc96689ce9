from __future__ import annotations

import pytest

from tests.lint.checking import body, only


@pytest.mark.parametrize(
    "lines",
    [
        ("def blink():", "  set_flag(0, True)", "end", "sync()"),
        ("def watch():", "  while True:", "    sync()", "  end", "end", "sync()"),
        ("def outer():", "  def inner():", "    sync()", "  end", "  sync()", "end", "outer()"),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["N228"]


@pytest.mark.parametrize(
    "lines",
    [
        ("def blink():", "  set_flag(0, True)", "end", "blink()"),
        ("def watch():", "  sync()", "end", "start_thread(watch, ())"),
        ("def watch():", "  sync()", "end", "steps = [watch]", "steps[0]()"),
        ("def _later():", "  sync()", "end", "sync()"),
        ("class Box:", "  def open(self):", "    sync()", "Box()"),
        ("def blink():", "  sync()", "end", "eval('blink()')"),
        ("def test_it():", "  sync()", "end", "sync()"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "N228" not in [problem.split()[0] for problem in body(*lines)]


def test_the_hint_starts_a_thread_where_a_loop_has_no_end():
    problem = only("def job():\n  def watch():\n    while True:\n      sync()\n    end\n  end\n  sync()\nend\n")
    assert problem.hint == "start it: start_thread(watch, ())"
