from __future__ import annotations

import pytest

from tests.lint.checking import body, found, marked, only


def test_a_variable_of_the_program_that_hides_a_command_is_found():
    assert body("sleep = 5", "textmsg(sleep)") == ["W203 2:3"]


def test_a_function_that_hides_a_command_is_found_at_its_name():
    text = "def job():\n  def pose_trans(a, b):\n    return a\n  end\n  pose_trans(1, 2)\nend\n"
    assert found(text) == ["W203 2:7"]
    assert marked(text) == "pose_trans"


def test_globals_count_also_when_a_function_assigns_them():
    assert body("def f():", "  global sync", "  sync = 1", "end", "f()", "textmsg(sync)") == []
    assert body("def f():", "  global sleep", "  sleep = 1", "end", "f()", "textmsg(sleep)") == ["W203 4:5"]


@pytest.mark.parametrize(
    "lines",
    [
        ("length = 3", "textmsg(length)"),
        ("force = get_tcp_force(True)", "textmsg(force[2])"),
        ("def f(sleep):", "  return sleep", "f(1)"),
        ("def f():", "  popup = 1", "  return popup", "f()"),
        ("from math import sin, cos", "textmsg(sin(0) + cos(0))"),
        ("import random", "textmsg(random.random())"),
        ("class Box:", "  sleep = 3", "  def movej(self):", "    pass", "Box().movej()"),
        ("textmsg([sleep for sleep in range(3)])",),
        ("movep = 1", "textmsg(movep)"),
        ("p = 1", "j = 2", "end = 3", "run = 4", "thread = 5", "textmsg([p, j, end, run, thread])"),
        ("len = 3", "list = [1]", "textmsg([len, list])"),
    ],
    ids=str,
)
def test_what_real_programs_do_all_the_time_is_left_alone(lines):
    assert body(*lines) == []


def test_an_everyday_name_counts_once_the_command_is_missed():
    assert body("length = 3", "textmsg(length([1, 2]))") == ["W203 2:3"]


def test_a_local_variable_counts_once_the_command_is_missed():
    assert body("def f():", "  sleep = 1", "  sleep(sleep)", "f()") == ["W203 3:5"]


def test_a_variable_that_another_function_calls_hides_it_there_too():
    assert body("norm = 3", "def f():", "  return norm([1, 2])", "f()") == ["W203 2:3"]


def test_words_that_the_tools_reserve_are_found():
    assert body("def set_digital_out(n, b):", "  set_standard_digital_out(n, b)", "set_digital_out(1, True)") == [
        "W203 2:7"
    ]


@pytest.mark.parametrize("name", ["servoc", "servol", "pathj", "tracka", "MODBUS", "inkognito", "debugmsg", "varmsg"])
def test_reserved_words_without_an_underscore_are_found_too(name):
    assert body(f"{name} = 1", f"textmsg({name})") == ["W203 2:3"]
    assert body(f"def {name}(q):", "  return q", "end", f"{name}(1)") == ["W203 2:7"]
    assert body("def f():", f"  {name} = 1", f"  return {name}", "end", "f()") == []


@pytest.mark.parametrize("name", ["join", "kill", "local", "run", "thread", "xor"])
def test_reserved_words_of_every_day_are_left_alone(name):
    assert body(f"def {name}(q):", "  return q", "end", f"{name}(1)") == []


def test_each_name_is_reported_once():
    assert body("sleep = 5", "sleep = 6", "for sleep in range(3):", "  pass") == ["W203 2:3"]


def test_a_global_is_reported_where_it_is_assigned_first():
    lines = ("global sleep", "sleep = 1", "def f():", "  global sleep", "  sleep = 2", "f()", "textmsg(sleep)")
    assert body(*lines) == ["W203 3:3"]


def test_the_text_shows_what_is_hidden():
    problem = only("def job():\n  sleep = 5\nend\n")
    assert problem.text == "`sleep` hides the robot command sleep(t)"


@pytest.mark.parametrize(
    "lines", [("def pause():", "  textmsg(1)", "end", "pause()"), ("halt = 1", "textmsg(halt)")], ids=str
)
def test_a_command_that_the_firmware_lacks_cannot_be_hidden(lines):
    assert body(*lines, firmware="2.10") == []
    assert body(*lines)[0].startswith("W203 2:")
