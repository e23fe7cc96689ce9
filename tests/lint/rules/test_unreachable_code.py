from __future__ import annotations

import pytest

from tests.lint.checking import body, found, marked, only


def test_the_first_statement_behind_a_return_is_found():
    assert body("return", "textmsg(1)", "textmsg(2)") == ["W207 3:3"]


@pytest.mark.parametrize("leave", ["break", "continue", "raise ValueError()", "return", "halt()", "exit()"])
def test_every_way_to_leave_counts(leave):
    assert body("for n in range(3):", f"  {leave}", "  textmsg(n)") == ["W207 4:5"]


def test_branches_that_all_leave_count():
    lines = ("if get_flag(0):", "  return", "elif get_flag(1):", "  halt()", "else:", "  raise ValueError()", "end")
    assert body(*lines, "textmsg(1)") == ["W207 9:3"]


def test_a_branch_that_goes_on_does_not():
    assert body("if get_flag(0):", "  return", "end", "textmsg(1)") == []
    assert body("if get_flag(0):", "  return", "else:", "  pass", "end", "textmsg(1)") == []


@pytest.mark.parametrize(
    "filler", ["pass", "return", "$ LINE: (1, 'a', 'after')", "labelmsg(1, 'a')", "'text'", "sync()"]
)
def test_lines_that_nobody_misses_do_not_count(filler):
    assert body("def f():", "  halt()", f"  {filler}", "f()") == []
    assert body("def f():", "  halt()", f"  {filler}", "  textmsg(1)", "f()") == ["W207 5:5"]


def test_code_behind_other_statements_is_reached():
    assert body("def halt2():", "  return", "halt2()", "textmsg(1)") == []
    assert body("while True:", "  sync()", "end", "textmsg(1)") == []
    assert body("try:", "  raise ValueError()", "except ValueError:", "  pass", "end", "textmsg(1)") == []


def test_a_function_called_halt_is_not_the_command():
    assert body("def quit():", "  pass", "quit()", "textmsg(1)") == []


def test_a_command_that_the_firmware_lacks_does_not_leave():
    assert body("halt()", "textmsg(1)", firmware="2.10") == ["E302 2:3"]
    assert body("exit()", "textmsg(1)", firmware="2.10") == ["W207 3:3"]


def test_dead_code_in_dead_code_is_reported_once():
    assert body("return", "if get_flag(0):", "  return", "  textmsg(1)") == ["W207 3:3"]


def test_blocks_of_every_kind_are_looked_into():
    assert body("try:", "  return", "  x = 1", "finally:", "  return", "  x = 2") == ["W207 4:5", "W207 7:5"]
    assert body("with open('f'):", "  return", "  x = 1") == ["W207 4:5"]
    assert body("class A:", "  def f(self):", "    return 1", "    x = 1", "A()") == ["W207 5:7"]
    assert body("for n in []:", "  pass", "else:", "  return", "  x = 1") == ["W207 6:5"]


def test_a_generator_without_elements_is_meant_so():
    assert body("def f():", "  return", "  yield 1", "f()") == []


def test_the_statement_that_leaves_is_named():
    problem = only("def job():\n  return\n  textmsg(1)\nend\n")
    assert problem.text == "this is never reached: the `return` in line 2 always leaves"
    assert marked("def job():\n  return\n  if get_flag(0):\n    sync()\nend\n") == "if get_flag(0):"


def test_nothing_is_said_about_a_text_with_errors():
    assert found("def job():\n  return\n  textmsg(1)\n  x = = 1\nend\n") == ["E001 4:7"]
