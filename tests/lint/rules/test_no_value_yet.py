from __future__ import annotations

import pytest

from tests.lint.checking import body


@pytest.mark.parametrize(
    "lines",
    [
        (
            "counter = 0",
            "def w():",
            "  while True:",
            "    counter = counter + 1",
            "    sync()",
            "  end",
            "end",
            "start_thread(w, ())",
            "textmsg(counter)",
        ),
        ("count = 0", "def bump():", "  count = count + 1", "end", "bump()", "textmsg(count)"),
        ("count = 0", "def bump():", "  count += 1", "end", "bump()", "textmsg(count)"),
        (
            "total = 0",
            "def add(n):",
            "  if n > 0:",
            "    total = total + n",
            "  end",
            "  return total",
            "end",
            "textmsg(add(3), total)",
        ),
        ("textmsg(x)", "x = 1"),
        (
            "count = 0",
            "def w():",
            "  while True:",
            "    if get_standard_digital_in(2):",
            "      count = count + 1",
            "    elif get_standard_digital_in(3):",
            "      count += 2",
            "    end",
            "    sync()",
            "  end",
            "end",
            "start_thread(w, ())",
            "textmsg(count)",
        ),
    ],
    ids=str,
)
def test_it_is_found(lines):
    assert [problem.split()[0] for problem in body(*lines)] == ["W256"]


@pytest.mark.parametrize(
    "lines",
    [
        ("count = 0", "def bump():", "  nonlocal count", "  count = count + 1", "end", "bump()", "textmsg(count)"),
        ("for i in range(3):", "  if i > 0:", "    textmsg(last)", "  end", "  last = i", "end"),
        ("for i in range(3):", "  if i > 0:", "    n = n + 1", "  else:", "    n = 0", "  end", "end"),
        ("for i in range(3):", "  if i > 0:", "    f = f(1)", "  end", "  def f(n):", "    return f", "  end", "end"),
        ("for i in range(3):", "  n = n + 1 if i > 0 else 0", "end"),
        ("try:", "  textmsg(x)", "except NameError:", "  x = 1", "end"),
        ("x = [n for n in range(3)]", "textmsg(x)"),
        ("def f(a):", "  a = a + 1", "  return a", "end", "textmsg(f(1))"),
        ("while True:", "  go = get_flag(0)", "  if go:", "    break", "  end", "  sync()", "end", "textmsg(go)"),
    ],
    ids=str,
)
def test_what_almost_is_one_is_not_found(lines):
    assert "W256" not in [problem.split()[0] for problem in body(*lines)]
