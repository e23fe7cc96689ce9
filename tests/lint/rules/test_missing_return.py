from __future__ import annotations

import pytest

from tests.lint.checking import body, only

SPEED = ("def speed_of(n):", "  if n == 1:", "    return 0.5", "  end", "end")
W220 = ["W220 2:7"]


@pytest.mark.parametrize(
    "use",
    [
        ("movel([0, 0, 0, 0, 0, 0], v=speed_of(2))",),
        ("x = speed_of(1)", "textmsg(x)"),
        ("x = speed_of(1) * 2",),
        ("if speed_of(1) < 3:", "  sync()", "end"),
        ("a, b = speed_of(1)",),
        ("textmsg(speed_of(1)[0])",),
    ],
)
def test_a_value_that_must_be_there_is_missing_on_one_path(use):
    assert body(*SPEED, *use) == W220


@pytest.mark.parametrize(
    "function",
    [
        ("def f(n):", "  for k in range(n):", "    if k == 3:", "      return k"),
        ("def f(n):", "  while n > 0:", "    n = n - 1", "    if n == 5:", "      return n"),
        ("def f(n):", "  try:", "    return int(n)", "  except ValueError:", "    textmsg(n)"),
        ("def f(n):", "  if n:", "    return 1", "  else:", "    textmsg(n)"),
        ("def f(n):", "  match n:", "    case 1:", "      return 2"),
        ("def f(n):", "  while True:", "    sync()", "    if n:", "      return 2", "    break"),
    ],
    ids=str,
)
def test_the_end_is_reached_behind_loops_and_branches(function):
    assert [finding for finding in body(*function, "textmsg(f(1) + 1)") if "W212" not in finding] == W220


@pytest.mark.parametrize(
    "function",
    [
        ("def f(n):", "  if n:", "    return 1", "  return 2"),
        ("def f(n):", "  if n:", "    return 1", "  else:", "    return 2"),
        ("def f(n):", "  if n:", "    return 1", "  halt()"),
        ("def f(n):", "  if n:", "    return 1", "  raise ValueError(n)"),
        ("def f(n):", "  while True:", "    sync()", "    if n:", "      return 2"),
        ("def f(n):", "  try:", "    return int(n)", "  except ValueError:", "    return 0"),
        ("def f(n):", "  try:", "    sync()", "  finally:", "    return 0"),
        ("def f(n):", "  match n:", "    case 1:", "      return 2", "    case _:", "      return 3"),
        ("def f(n):", "  for k in range(n):", "    if k:", "      return k", "  else:", "    return 0"),
        ("def fail():", "  textmsg('bad')", "  halt()", "def f(n):", "  if n:", "    return 1", "  fail()"),
        ("def f(n):", "  if n:", "    return 1", "  return None"),
        ("def f(n):", "  yield n"),
        ("def f(n):", "  textmsg(n)", "  return n"),
        ("def f(n):", "  def g():", "    return 1", "  if n:", "    return g()", "  return 0"),
    ],
    ids=str,
)
def test_functions_that_return_on_every_path_are_left_alone(function):
    assert [finding for finding in body(*function, "textmsg(f(1) + 1)") if "W220" in finding] == []


@pytest.mark.parametrize(
    "use",
    [
        ("speed_of(1)",),
        ("if speed_of(1):", "  sync()", "end"),
        ("while not speed_of(1):", "  sync()", "end"),
        ("x = speed_of(1)", "if x == None:", "  sync()", "end", "textmsg(x + 1)"),
        ("x = speed_of(1)", "if x is not None:", "  textmsg(x + 1)", "end"),
        ("x = speed_of(1)", "if x:", "  sync()", "end"),
        ("x = speed_of(1)",),
        ("if speed_of(1) == 0.5:", "  sync()", "end"),
        ("start_thread(speed_of, (1,))",),
    ],
    ids=str,
)
def test_callers_that_get_along_with_none_are_no_use(use):
    assert body(*SPEED, *use) == []


def test_the_message_says_where_it_returns_and_who_uses_it():
    text = "def job():\n  def f(n):\n    if n:\n      return 1\n  textmsg(f(0) + 1)\nend\n"
    assert only(text).text == ("`f` returns a value in line 4, and none at its end; line 5 uses it")
