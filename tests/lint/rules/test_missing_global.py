from __future__ import annotations

from tests.lint.checking import body, found, marked, only, repaired

SHARED = """
def job():
  global level
  level = 0
  def fill():
    level = 100
    textmsg(level)
  end
  fill()
end
"""


def test_an_assignment_in_a_function_that_misses_the_declaration_is_found():
    assert found(SHARED) == ["W202 5:5"]
    assert marked(SHARED) == "level"


def test_the_fix_declares_the_name_at_the_start_of_the_function():
    fixed = repaired(SHARED)
    assert "  def fill():\n    global level\n    level = 100\n" in fixed
    assert found(fixed) == []


def test_the_fix_goes_behind_a_docstring_and_into_a_single_line():
    fixed = repaired("def job():\n  global a1\n  a1 = 0\n  def f():\n    'text'\n    a1 = 1\n  end\n  f()\nend\n")
    assert "    'text'\n    global a1\n    a1 = 1\n" in fixed
    fixed = repaired("def job():\n  global a1\n  a1 = 0\n  def f(): a1 = 1\n  f()\nend\n")
    assert "def f(): global a1; a1 = 1" in fixed


def test_only_the_first_assignment_of_a_name_is_reported():
    text = SHARED.replace("level = 100\n", "level = 100\n    level = 200\n    level += 1\n")
    assert found(text) == ["W202 5:5"]


def test_augmented_assignments_count():
    assert body("global n", "n = 0", "def f():", "  n += 1", "end", "f()") == ["W202 5:5"]


def test_the_declaration_in_the_function_is_enough():
    assert body("global n", "n = 0", "def f():", "  global n", "  n = 1", "end", "f()") == []


def test_parameters_and_loop_variables_are_meant_to_be_local():
    assert body("global n", "n = 0", "def f(n):", "  n = n + 1", "end", "f(1)") == []
    assert body("global n", "n = 0", "def f():", "  for n in range(3):", "    pass", "end", "f()") == []


def test_a_loop_variable_that_only_others_look_at_is_meant_for_the_global():
    show = ("def show():", "  textmsg(level)", "end")
    fill = ("def fill():", "  for level in range(3):", "    show()", "end")
    assert body("global level", "level = 0", *show, *fill, "fill()") == ["W202 8:9"]
    lines = ("def show():", "  global level", "  textmsg(level)", "end", "for level in range(3):", "  show()", "end")
    assert "W202 6:7" in body(*lines)


def test_a_loop_variable_that_its_function_uses_or_that_only_counts_is_local():
    shown = ("global level, i", "level = i = 0", "def f():")
    assert body(*shown, "  for level in range(3):", "    textmsg(level)", "end", "f()", "textmsg(level, i)") == []
    assert body(*shown, "  for i in range(3):", "    sync()", "end", "f()", "textmsg(level, i)") == []
    assert body("global level", "level = 0", "def f():", "  for level in range(3):", "    sync()", "end", "f()") == []
    assert body(*shown, "  textmsg([1 for level in range(3)])", "end", "f()", "textmsg(level, i)") == []


def test_two_functions_may_use_a_name_for_different_things():
    lines = ("def f():", "  global n", "  n = 1", "end", "def g():", "  n = 5", "  return n", "end", "f()", "g()")
    assert body(*lines) == []


def test_an_assignment_for_nobody_is_meant_for_the_global():
    lines = ("def f():", "  global n", "  n = 1", "  textmsg(n)", "end", "def g():", "  n = 5", "end", "f()", "g()")
    assert body(*lines) == ["W202 8:5"]


def test_the_body_of_the_program_needs_the_declaration_too():
    lines = ("c = 1", "def f():", "  global c", "  c = 2", "end", "f()", "textmsg(c)")
    assert body(*lines) == ["W202 2:3"]


def test_nonlocal_is_no_missing_global():
    lines = ("def f():", "  n = 1", "  def g():", "    nonlocal n", "    n = 2", "  g()", "  return n", "f()")
    assert body(*lines) == []
    assert body("global n", "n = 0", "def f():", "  x = 1", "  return x", "f()") == []


def test_a_late_declaration_is_a_declaration():
    assert body("n = 1", "global n", "n = 2") == ["E109 3:10"]


def test_a_bare_script_is_checked_alike():
    text = "global level\nlevel = 7\ndef mix(u, w):\n    level = u * w\n    return level\nmix(1, 2)\n"
    assert found(text) == ["W202 4:5"]


def test_methods_count_as_functions_and_class_variables_do_not():
    lines = ("global n", "n = 0", "class Box:", "  n = 3", "  def put(self):", "    n = 4", "Box().put()")
    assert body(*lines) == ["W202 7:7"]


def test_the_text_says_who_declares_it():
    problem = only(SHARED)
    assert problem.text == "`level` is a local variable here; the program `job` declares it global"
    assert problem.hint == "write `global level` at the start of the function `fill`, or use another name"
