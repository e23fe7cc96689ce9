from __future__ import annotations

import pytest

from tests.lint.checking import body, found, only, problems, repaired

CLOSED = ("if get_flag(0):", "  sync()", "end")


@pytest.mark.parametrize(
    ("lines", "line"),
    [
        ((*CLOSED, "while get_flag(1):", "  sync()"), 5),
        ((*CLOSED, "for n in range(3):", "  if n == 2:", "    sync()", "end"), 6),
        ((*CLOSED, "if get_flag(1):", "  sync()", "else:", "  sleep(1)"), 5),
        ((*CLOSED, "try:", "  sync()", "except Exception:", "  sleep(1)"), 5),
        (("def a():", "  sync()", "end", "def b():", "  sync()", "a()", "b()"), 5),
        (("class A:", "  x = 1", "end", "class B:", "  x = 1", "sync()"), 5),
    ],
)
def test_the_block_without_its_end_is_found_at_its_header(lines, line):
    assert [finding.split(":")[0] for finding in body(*lines)] == [f"W216 {line}"]


@pytest.mark.parametrize(
    "lines",
    [
        ("if get_flag(0):", "  sync()", "while get_flag(1):", "  sync()"),
        (*CLOSED, "if get_flag(1): sync()"),
        ("$ LINE: (1, 'loop')", *CLOSED, "while get_flag(1):", "  sync()"),
        (*CLOSED, "while get_flag(1): sync()", "sleep(1)"),
        (*CLOSED, "def f():", "  sync()", "f()"),
        (*CLOSED, "class A:", "  def f(self):", "    sync()"),
        (*CLOSED, "match get_flag(0):", "  case True:", "    sync()", "end"),
        (*CLOSED, "if get_flag(1):", "  sync()", "if get_flag(2):", "  sync()"),
        ("def f():", "  if get_flag(0):", "    sync()", "end", "f()"),
        ("class A:", "  def f(self):", "    sync()", "  def g(self):", "    sync()", "end", "sync()"),
    ],
    ids=str,
)
def test_texts_in_the_way_of_python_and_blocks_that_need_no_end_are_left_alone(lines):
    assert [finding for finding in body(*lines) if "W216" in finding] == []


@pytest.mark.parametrize(("closed", "opened", "expected"), [(1, 1, 1), (3, 2, 0), (5, 2, 0), (6, 2, 2), (9, 3, 3)])
def test_a_text_that_mixes_both_ways_of_writing_is_left_alone(closed, opened, expected):
    lines = [*CLOSED * closed, *("while get_flag(1):", "  sync()") * opened]
    assert len(body(*lines)) == expected


def test_functions_of_a_script_are_compared_with_each_other():
    text = "def a():\n  sync()\nend\ndef b():\n  sync()\ndef c():\n  sync()\nend\na()\nb()\nc()\n"
    assert found(text) == ["W216 4:1"]


def test_the_outermost_end_counts_where_those_inside_are_there():
    inner = "  if get_flag(0):\n    sync()\n  end\n"
    assert found(f"def job():\n{inner}") == ["W216 1:1"]
    assert found("def job():\n  if get_flag(0):\n    sync()\n") == []


def test_the_message_names_block_line_and_where_it_ends():
    loop = "  while get_flag(1):\n    sync()\n  # done\n  sleep(1)\n"
    text = f"def job():\n  if get_flag(0):\n    sync()\n  end\n{loop}end\n"
    problem = only(text)
    assert problem.text == (
        "the `while` of line 5 has no `end`, and another block has its own: by its indentation it ends after line 6"
    )
    assert problem.hint == "write `end` in column 3 below line 6, or indent what else belongs to it"


def test_the_fix_changes_no_meaning():
    text = "def job():\n  if get_flag(0):\n    sync()\n  end\n  while get_flag(1):\n    sync()\n  sleep(1)\nend\n"
    fixed = repaired(text)
    assert fixed == text.replace("    sync()\n  sleep", "    sync()\n  end\n  sleep")
    assert found(fixed) == []


def test_a_strict_check_takes_it_for_an_error():
    text = "def job():\n  if get_flag(0):\n    sync()\n  end\n  while get_flag(1):\n    sync()\nend\n"
    assert [problem.is_error for problem in problems(text, strict=True)] == [True]
