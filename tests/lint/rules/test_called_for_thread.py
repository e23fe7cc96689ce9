from __future__ import annotations

import pytest

from tests.lint.checking import body

WATCH = ("def watch(n):", "  while True:", "    sync()", "  end", "end")


@pytest.mark.parametrize("call", ["start_thread(watch(1))", "start_thread(watch(1), ())", "h = start_thread(watch(1))"])
def test_it_is_found(call):
    assert [problem.split()[0] for problem in body(*WATCH, call)] == ["W269"]


@pytest.mark.parametrize(
    "lines",
    [
        (*WATCH, "start_thread(watch, (1,))"),
        ("def make():", "  def w():", "    sync()", "  end", "  return w", "end", "start_thread(make(), ())"),
        ("def w():", "  sync()", "end", "start_thread(w(), ())"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W269" not in [problem.split()[0] for problem in body(*lines)]
