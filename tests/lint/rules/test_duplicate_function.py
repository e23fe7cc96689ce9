from __future__ import annotations

import pytest

from tests.lint.checking import body, found, only

GRIP = ("def grip():", "  sync()", "end")


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ((*GRIP, *GRIP, "grip()"), ["W217 5:7"]),
        (("$ LINE: (1, 'grip')", *GRIP, "def grip():", "  sleep(1)", "end", "grip()"), ["W217 6:7"]),
        ((*GRIP, "n = 1", *GRIP, "grip()"), ["W217 6:7"]),
        ((*GRIP, *GRIP, *GRIP, "grip()"), ["W217 5:7", "W217 8:7"]),
        (("class A:", "  def f(self):", "    sync()", "  def f(self):", "    sync()", "A()"), ["W217 5:9"]),
        (("if get_flag(0):", *(f"  {line}" for line in (*GRIP, *GRIP)), "end"), ["W217 6:9"]),
    ],
)
def test_a_later_definition_in_the_same_block_is_found(lines, expected):
    assert body(*lines) == expected


@pytest.mark.parametrize(
    "lines",
    [
        (*GRIP, "grip()", *GRIP, "grip()"),
        ("$ LINE: (1, 'grip')", *GRIP, *GRIP, "grip()"),
        (*GRIP, "old = grip", *GRIP, "old()", "grip()"),
        (*GRIP, "textmsg(1)", *GRIP, "grip()"),
        ("if get_flag(0):", "  def f():", "    sync()", "else:", "  def f():", "    sleep(1)", "f()"),
        ("try:", "  def f():", "    sync()", "except Exception:", "  def f():", "    sleep(1)", "f()"),
        ("def f():", "  def g():", "    sync()", "  g()", "def g():", "  sync()", "f()", "g()"),
        (
            "class A:",
            "  @property",
            "  def f(self):",
            "    return 1",
            "  @f.setter",
            "  def f(self, x):",
            "    sync()",
            "A()",
        ),
    ],
    ids=str,
)
def test_definitions_of_which_each_may_be_used_are_left_alone(lines):
    assert body(*lines) == []


def test_two_programs_of_one_name_in_one_text():
    job = "def job():\n  sync()\nend\n"
    assert found(job + job + "job()\n") == ["W217 4:5"]


def test_the_message_says_where_the_first_one_is():
    job = "def job():\n  sync()\nend\n"
    assert only(job + job + "job()\n").text == ("`job` is defined already in line 1: that one can no longer be called")
