from __future__ import annotations

import pytest

from tests.lint.checking import body, only, repaired


@pytest.mark.parametrize(
    ("lines", "places"),
    [
        (("while True:", "  sync", "end"), ["W204 2:3", "W215 3:5"]),
        (("if get_tool_analog_in > 3:", "  sync()", "end"), ["W215 2:6"]),
        (("x = get_standard_digital_in", "if x:", "  sync()", "end"), ["W215 2:7"]),
        (("if not get_standard_digital_in:", "  sync()", "end"), ["W215 2:10"]),
        (("textmsg(1) if get_steptime else sync()",), ["W215 2:17"]),
        (("halt",), ["W215 2:3"]),
    ],
)
def test_a_command_that_is_not_called_is_found(lines, places):
    assert body(*lines) == places


@pytest.mark.parametrize(
    "lines",
    [
        ("start_thread(sync, ())",),
        ("read = get_standard_digital_in", "textmsg(read(3))"),
        ("table = {'a': sin, 'b': cos}", "textmsg(table['a'](1))"),
        ("f = sin", "textmsg(list(map(f, [1, 2])))"),
        ("def sync():", "  pass", "end", "start_thread(sync, ())"),
        ("force = 3", "if force > 2:", "  sync()", "end"),
        ("f = get_flag", "if f is get_flag:", "  textmsg(f(1))", "end"),
    ],
)
def test_a_command_that_is_handed_on_is_none(lines):
    assert [finding for finding in body(*lines) if finding.startswith("W215")] == []


def test_the_fix_calls_it():
    assert repaired("def job():\n  sync\nend\n") == "def job():\n  sync()\nend\n"


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (("def grip():", "  sync()", "end", "grip"), ["W215 5:3"]),
        (("def ready():", "  return get_flag(1)", "end", "if ready:", "  sync()", "end"), ["W215 5:6"]),
        (("def ready():", "  return get_flag(1)", "end", "while not ready:", "  sync()", "end"), ["W215 5:13"]),
        (("def f(x=1):", "  return x", "end", "textmsg(1 if f else f(2))"), ["W215 5:16"]),
        (("s = 'a b'.split", "textmsg(s[0])"), ["W215 2:7"]),
        (("s = 'a'", "if s.isdigit:", "  sync()", "end"), ["W215 3:6"]),
        (("exit",), ["W215 2:3"]),
        (("input",), ["W215 2:3"]),
    ],
)
def test_functions_of_the_program_and_of_python_are_found(lines, expected):
    assert body(*lines) == expected


@pytest.mark.parametrize(
    "lines",
    [
        ("def f():", "  sync()", "end", "start_thread(f, ())"),
        ("def f():", "  sync()", "end", "g = f", "g()"),
        ("def f():", "  sync()", "end", "f = None", "if f:", "  f()", "end"),
        ("def job1(callback):", "  if callback:", "    callback()", "  end", "end", "job1(None)"),
        ("def f():", "  sync()", "end", "steps = [f]", "steps[0]()"),
        ("parts = []", "add = parts.append", "add(1)", "textmsg(parts)"),
        ("s = 'a'", "textmsg(list(map(s.count, ['a'])))"),
    ],
    ids=str,
)
def test_a_function_that_is_handed_on_or_may_be_something_else_is_left_alone(lines):
    assert body(*lines) == []


def test_a_function_that_needs_arguments_gets_no_fix():
    problem = only("def job():\n  def f(x):\n    sync()\n  end\n  f\nend\n")
    assert (problem.hint, problem.fix) == ("write f(...)", None)
    assert repaired("def job():\n  def f():\n    sync()\n  end\n  f\nend\n").endswith("  f()\nend\n")
