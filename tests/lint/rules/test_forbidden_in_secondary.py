from __future__ import annotations

import pytest

from tests.lint.checking import found, marked


@pytest.mark.parametrize("call", ["sleep(1)", "sync()", "movej([0, 0, 0, 0, 0, 0])", "pause()", "join_thread(1)"])
def test_calls_that_move_or_wait_are_found(call):
    assert found(f"sec lamp():\n  textmsg('a')\n  {call}\nend\n") == ["W205 3:3"]


def test_the_name_is_underlined():
    assert marked("sec lamp():\n  sleep(1)\nend\n") == "sleep"


def test_calls_in_its_functions_count():
    assert found("sec lamp():\n  def f():\n    sleep(1)\n  end\n  f()\nend\n") == ["W205 3:5"]


@pytest.mark.parametrize("call", ["textmsg(1)", "set_flag(1, True)", "halt()", "socket_open('h', 80)", "popup('x')"])
def test_what_a_secondary_program_is_for_is_allowed(call):
    assert found(f"sec lamp():\n  {call}\nend\n") == []


def test_a_program_may_wait():
    assert found("def lamp():\n  sleep(1)\nend\n") == []


def test_a_function_of_that_name_is_not_the_command():
    assert found("sec lamp():\n  def sync():\n    pass\n  end\n  sync()\nend\n") == []


def test_several_units_in_one_text_are_told_apart():
    text = "def job():\n  sleep(1)\nend\nsec lamp():\n  sleep(1)\nend\n"
    assert [finding for finding in found(text) if finding.startswith("W205")] == ["W205 5:3"]


@pytest.mark.parametrize(
    "lines",
    [
        ("import time", "time.sleep(1)"),
        ("import time as t", "t.sleep(1)"),
        ("from time import sleep", "sleep(1)"),
        ("from time import sleep as rest", "rest(1)"),
        ("global time", "import time", "time.sleep(1)"),
    ],
    ids=str,
)
def test_the_sleep_of_python_waits_too(lines):
    text = "sec lamp():\n" + "".join(f"  {line}\n" for line in lines) + "end\n"
    assert found(text) == [f"W205 {len(lines) + 1}:3"]


def test_other_things_called_sleep_do_not():
    assert found("sec lamp():\n  import time\n  textmsg(time.time())\nend\n") == []
    assert (
        found("sec lamp():\n  class Box:\n    def sleep(self, t):\n      pass\n  time = Box()\n  time.sleep(1)\nend\n")
        == []
    )
    assert found("def job():\n  import time\n  time.sleep(1)\nend\n") == []
