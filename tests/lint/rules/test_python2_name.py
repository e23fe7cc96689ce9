from __future__ import annotations

import pytest

from tests.lint.checking import body, found, marked, only, problems, repaired


@pytest.mark.parametrize(
    ("text", "fixed"),
    [
        ("textmsg(long('12'))", "textmsg(int('12'))"),
        ("textmsg(unichr(65))", "textmsg(chr(65))"),
        ("textmsg(xrange(3))", "textmsg(range(3))"),
        ("textmsg(basestring)", "textmsg(str)"),
        ("textmsg(unicode(1))", "textmsg(str(1))"),
        ("textmsg({}.iteritems())", "textmsg({}.items())"),
        ("textmsg({}.has_key('a'))", "textmsg(('a' in {}))"),
    ],
)
def test_a_name_of_python_2_is_found_and_can_be_repaired(text, fixed):
    program = f"def job():\n  {text}\nend\n"
    assert only(program).code == "W209"
    assert repaired(program) == f"def job():\n  {fixed}\nend\n"


@pytest.mark.parametrize("text", ["raw_input('x')", "reduce(max, [1])", "execfile('x')"])
def test_names_without_a_replacement_are_found(text):
    problem = only(f"def job():\n  {text}\nend\n")
    assert (problem.code, problem.line, problem.column) == ("W209", 2, 3)
    assert problem.hint
    assert problem.fix is None


def test_methods_are_underlined_at_their_name():
    assert marked("def job():\n  d = {}\n  d.has_key(1)\nend\n") == "has_key"
    assert marked("def job():\n  d = {}\n  for k in d.itervalues(): textmsg(k)\nend\n") == "itervalues"


def test_sort_with_a_comparing_function_is_found_at_the_argument():
    text = "def job():\n  a1 = [2, 1]\n  a1.sort(lambda x, y: x - y)\nend\n"
    assert found(text) == ["W209 3:11"]
    assert "key=" in only(text).hint


@pytest.mark.parametrize(
    "lines",
    [
        ("long = 3", "textmsg(long)"),
        ("from functools import reduce", "textmsg(reduce(max, [1]))"),
        ("try:", "  text = basestring", "except NameError:", "  text = str", "textmsg(text)"),
        ("def unichr(n):", "  return n", "textmsg(unichr(1))"),
        ("a1 = [2, 1]", "a1.sort()", "a1.sort(key=abs)", "a1.sort(reverse=True)"),
        ("class Map:", "  def has_key(self, key):", "    return True", "Map().has_key(1)"),
        ("class Tray:", "  def sort(self, how):", "    return how", "Tray().sort(1)"),
    ],
    ids=str,
)
def test_other_uses_of_these_names_are_left_alone(lines):
    assert body(*lines) == []


def test_they_are_errors_in_strict_mode():
    text = "def job():\n  textmsg(unichr(65))\n  textmsg({}.has_key(1))\nend\n"
    assert [str(problem.severity) for problem in problems(text)] == ["warning", "warning"]
    assert [str(problem.severity) for problem in problems(text, strict=True)] == ["error", "error"]
