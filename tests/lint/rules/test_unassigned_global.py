from __future__ import annotations

from elitescript.language.text.source import SourceFile
from elitescript.lint.engine import check_source
from elitescript.messages.profile import profile
from tests.lint.checking import body, found, marked, only


def test_a_global_without_a_value_is_found_at_its_name():
    assert body("global a1, never, b1", "a1 = b1 = 1") == ["W206 2:14"]
    assert marked("def job():\n  global never\nend\n") == "never"


def test_only_the_first_declaration_is_reported():
    assert body("global never", "def f():", "  global never", "  textmsg(never)", "f()") == ["W206 2:10"]


def test_any_binding_anywhere_is_a_value():
    assert body("global n", "def f():", "  global n", "  n = 1", "f()") == []
    assert body("global n", "for n in range(3):", "  pass") == []
    assert body("global tool", "def tool():", "  pass", "tool()") == []
    assert body("global math", "import math", "textmsg(math.pi)") == []
    assert body("global n", "del n") == ["W206 2:10"]


def test_a_local_variable_of_that_name_is_none():
    assert "W206 2:10" in body("global n", "def f():", "  n = 1", "f()")


def test_a_secondary_program_declares_the_globals_of_others():
    assert found("sec look():\n  global go\n  textmsg(go)\nend\n") == []


def test_a_bare_script_may_be_part_of_a_program():
    assert found("global result\ntextmsg(result)\n") == []
    assert found("global result\n") == ["W206 1:8"]


def test_a_global_that_has_a_value_before_the_program_begins_is_assigned():
    text = SourceFile("<test>", "def job():\n  global foo, never\n  textmsg(foo)\nend\n")
    problems = check_source(text, profile(), presets=("foo",))
    assert [(problem.code, problem.column) for problem in problems] == [("W206", 15)]


def test_a_slip_is_recognised():
    problem = only("def job():\n  global parts\n  part = 0\n  textmsg(part)\nend\n")
    assert problem.hint == "is `part` meant?"
    assert only("def job():\n  global parts\nend\n").hint == "give it a value, or leave the line out"


def test_a_line_that_could_not_be_read_may_assign_it():
    assert body("global n", "n = = 1") == ["E001 3:7"]
