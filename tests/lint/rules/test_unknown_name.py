from __future__ import annotations

import pytest

from tests.lint.checking import body, found, marked, only, repaired


def test_a_name_that_nothing_defines_is_found_where_it_is_used():
    assert body("x = speed + 1") == ["W201 2:7"]


def test_it_is_found_in_code_that_never_runs():
    assert body("if False:", "  unconfigured", "  null") == ["W201 3:5", "W201 4:5"]


def test_each_use_is_reported():
    assert body("textmsg(a1)", "textmsg(a1)") == ["W201 2:11", "W201 3:11"]


@pytest.mark.parametrize(
    "lines",
    [
        ("x = 1", "textmsg(x)"),
        ("for n in range(3):", "  pass", "textmsg(n)"),
        ("import math", "textmsg(math.pi)"),
        ("from math import pi as half_turn", "textmsg(half_turn)"),
        ("with open('f') as f:", "  textmsg(f)"),
        ("try:", "  pass", "except Exception as e:", "  textmsg(e)"),
        ("def f(a, *b, c=1, **d):", "  textmsg([a, b, c, d, f])", "f(1)"),
        ("class Box:", "  pass", "textmsg(Box)"),
        ("a, (b, *c) = 1, (2, 3)", "textmsg([a, b, c])"),
        ("textmsg([v for v in range(3) if v])",),
        ("textmsg((lambda t: t)(1))",),
        ("if (n := 3) > 2:", "  textmsg(n)"),
        ("textmsg(copy.deepcopy([1]))", "textmsg(elicopy.copy([1]))"),
        ("textmsg([len, ValueError, Ellipsis, print])",),
        ("textmsg(movej)",),
        ("def f():", "  return later", "later = 1", "f()"),
        ("def f():", "  global shared", "  shared = 1", "f()", "textmsg(shared)"),
        ("exit()", "quit()"),
    ],
    ids=str,
)
def test_what_is_defined_somewhere_in_reach_is_known(lines):
    assert [finding for finding in body(*lines) if finding.startswith("W201")] == []


def test_a_call_is_the_business_of_another_rule():
    assert body("no_such_thing()") == ["E301 2:3"]


def test_a_local_variable_of_another_function_is_not_in_reach():
    problem = only(
        """
        def job():
          def measure():
            length = 3
            return length
          end
          measure()
          textmsg(length_)
        end
        """
    )
    assert (problem.code, problem.line, problem.column) == ("W201", 7, 11)


def test_the_function_that_owns_such_a_variable_is_named():
    problem = only(
        """
        def job():
          def measure():
            width = 3
            return width
          end
          measure()
          textmsg(width)
        end
        """
    )
    assert problem.hint == "it is a local variable of `measure`; declare it `global` there to share it"


def test_a_slip_is_recognised_and_can_be_repaired():
    text = "def job():\n  speed = 0.25\n  textmsg(sped)\nend\n"
    assert only(text).hint == "is `speed` meant?"
    assert repaired(text) == "def job():\n  speed = 0.25\n  textmsg(speed)\nend\n"
    assert not only(text).fix.safe


@pytest.mark.parametrize(("word", "meant"), [("true", "True"), ("false", "False"), ("null", "None"), ("nil", "None")])
def test_words_of_other_languages_have_their_own_hint(word, meant):
    text = f"def job():\n  textmsg({word})\nend\n"
    assert only(text).hint == f"write {meant}"
    assert only(text).fix.safe
    assert meant in repaired(text)


def test_what_the_pendant_writes_for_an_open_setting_is_explained():
    problem = only("def job():\n  if False:\n    unconfigured\n  end\nend\n")
    assert problem.hint == "the pendant writes this for something that is not set up"


def test_a_forgotten_import_is_recognised():
    assert only("def job():\n  textmsg(math.pi)\nend\n").hint == "write `import math` before it"


def test_the_whole_name_is_underlined():
    assert marked("def job():\n  textmsg('ä', 1 + wert)\nend\n") == "wert"


def test_a_secondary_program_may_use_globals_of_the_running_program():
    assert found("sec look():\n  textmsg(level)\nend\n") == []


def test_a_bare_script_may_use_names_that_the_pendant_makes():
    assert found("textmsg(var_1)\n") == []
    assert found("textmsg(value_1)\n") == ["W201 1:9"]


def test_a_program_that_catches_name_errors_may_ask():
    assert body("try:", "  flag", "except NameError:", "  flag2 = 0") == []
    assert body("try:", "  flag", "except Exception:", "  flag2 = 0") == ["W201 3:5"]
    assert body("try:", "  pass", "except NameError:", "  flag") == ["W201 5:5"]


def test_a_line_that_could_not_be_read_may_define_the_name():
    assert body("speed = 0.25 +", "textmsg(speed)") == ["E001 2:17"]


def test_special_names_are_the_business_of_the_compiler():
    assert {code[:4] for code in body("textmsg(__file__)")} == {"E115"}


def test_a_module_is_imported_and_a_local_variable_of_another_function_shared():
    assert repaired("def job():\n  textmsg(math.pi)\nend\n") == "def job():\n  import math\n  textmsg(math.pi)\nend\n"
    text = "def job():\n  def fill():\n    level = 1\n    textmsg(level)\n  end\n  fill()\n  textmsg(level)\nend\n"
    assert repaired(text) == text.replace("    level = 1", "    global level\n    level = 1")
    decorated = "def job():\n  @ staticmethod\n  def f():\n    textmsg(math.pi)\n  end\n  f()\nend\n"
    assert repaired(decorated) == decorated.replace("  @ static", "  import math\n  @ static")
