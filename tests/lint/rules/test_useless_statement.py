from __future__ import annotations

import pytest

from tests.lint.checking import body, only, repaired


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (("n = 1", "n == 3"), ["W218 3:3"]),
        (("n = 1", "n < 3"), ["W218 3:3"]),
        (("get_flag(0) == True",), ["W218 2:3"]),
        (("n = 1", "n"), ["W218 3:3"]),
        (("n = [1]", "n[0]"), ["W218 3:3"]),
        (("box = {}", "box.clear"), ["W218 3:3"]),
        (("[1, 2]",), ["W218 2:3"]),
        (("a = True", "a and not a"), ["W218 3:3"]),
        (("5",), ["W218 2:3"]),
        (("[n for n in range(3)]",), ["W218 2:3"]),
    ],
)
def test_values_that_nothing_uses_are_found(lines, expected):
    assert body(*lines) == expected


@pytest.mark.parametrize(
    "lines",
    [
        ("'a comment'",),
        ("...",),
        ("pass",),
        ("n = {}", "n['a'] = 1"),
        ("a = True", "a and sync()"),
        ("sync() if get_flag(0) else sleep(1)",),
        ("[sleep(n) for n in (1, 2)]",),
        ("n = []", "try:", "  n[0]", "except IndexError:", "  sync()"),
        ("try:", "  n", "except NameError:", "  n = 1"),
        ("n = {}", "n.clear()"),
        ("class A:", "  @property", "  def go(self):", "    sync()", "a = A()", "a.go"),
        ("class Log:", "  def __lt__(self, text):", "    textmsg(text)", "log1 = Log()", "log1 < 'a'"),
    ],
    ids=str,
)
def test_what_does_something_or_asks_is_left_alone(lines):
    assert body(*lines) == []


def test_names_of_unknown_things_and_functions_are_other_rules():
    assert body("nothing") == ["W201 2:3"]
    assert body("sync") == ["W215 2:3"]
    assert body("def f():", "  sync()", "end", "f") == ["W215 5:3"]


def test_a_comparison_is_offered_as_an_assignment():
    text = "def job():\n  n = 1\n  n == 3\nend\n"
    assert only(text).hint == "is `n = 3` meant?"
    assert repaired(text) == "def job():\n  n = 1\n  n = 3\nend\n"
    assert only("def job():\n  n = 1\n  n < 3\nend\n").fix is None
