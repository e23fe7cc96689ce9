from __future__ import annotations

import pytest

from elitescript.language.parser import MAX_SYNTAX_ERRORS
from elitescript.language.text.source import apply_fixes
from tests.language.marked import check_marks, codes, findings, unmarked


def check_fix(code, text, repaired):
    (found,) = check_marks(code, text)
    assert (apply_fixes(unmarked(text)[0], [found.fix]) if found.fix else None) == repaired
    assert found.hint
    if repaired:
        assert codes(repaired) == []


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("«global x = 1»", "global x\nx = 1"),
        ("def a():\n  «global x = f(1)»\nend", "def a():\n  global x\n  x = f(1)\nend"),
        ("y = 2; «global x = 1»", "y = 2; global x; x = 1"),
        ("if y: «global x=1»", "if y: global x; x =1"),
        ("«global a, b = 1, 2»", "global a, b\na, b = 1, 2"),
        ("«global x = [1,\n  2]»\ny = 1", "global x\nx = [1,\n  2]\ny = 1"),
    ],
)
def test_global_with_an_assignment(text, repaired):
    check_fix("E108", text, repaired)


def test_a_declaration_of_several_names_with_a_value_is_no_safe_repair():
    assert [found.fix.safe for found in findings("global a = 1\nglobal b, c = 2")] == [True, False]


@pytest.mark.parametrize("text", ["global x\nx = 1", "global x, y", "x = {'global x = 1': 2}"])
def test_declarations_without_assignment(text):
    assert codes(text) == []


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("if x «&&» y: f()", "if x and y: f()"),
        ("z = x«||»y", "z = x or y"),
        ("if «!»x: f()", "if not x: f()"),
        ("y = x and «!» z", "y = x and not z"),
        ("x«++»", "x += 1"),
        ("x«--»;", "x -= 1;"),
        ("a.b«++»", "a.b += 1"),
        ("y = x«++»", None),
        ("f(x«--», y)", None),
        ("a[0]«++»", None),
        ("y = a «?» b : c", "y = b if a else c"),
        ("f(1, a > b «?» b : c)", "f(1, b if a > b else c)"),
        ("return x «?» 'y' : z", "return 'y' if x else z"),
        ("y = a «?» b", None),
    ],
)
def test_operators_of_c(text, repaired):
    check_fix("E113", text, repaired)


@pytest.mark.parametrize(
    "text",
    [
        "x = a & b | c",
        "x = a != b",
        "x = --a",
        "x = ++a + +b - -c",
        "x = a --b",
        "x = (a\n--b)",
        "x = y if z else -w",
        "if f(--x): g()",
        "f'{x!r}'",
    ],
)
def test_operators_that_only_resemble_c(text):
    assert codes(text) == []


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("«thread w»():\n  f()\nend", "def w():\n  f()\nend"),
        ("def a():\n  «thread w»():\n    f()\n  end\nend", "def a():\n  def w():\n    f()\n  end\nend"),
        ("«run f»()", "start_thread(f, ())"),
        ("t = «run f»(1, x)", "t = start_thread(f, (1, x,))"),
        ("t = «run f»", None),
        ("«kill t»", "stop_thread(t)"),
        ("«join t»", "join_thread(t)"),
        ("«local x» = 1", "x = 1"),
        ("if a «xor» b: f()", "if a != b: f()"),
        ("x = (a) «xor» (b)", "x = (a) != (b)"),
    ],
)
def test_statements_of_urscript(text, repaired):
    check_fix("E114", text, repaired)


@pytest.mark.parametrize(
    "text",
    [
        "thread = 1",
        "join = ','.join(x)",
        "x = ','.join (y)",
        "run(f)",
        "x = run if kill else join",
        "for run in x: f()",
        "local in x",
        "xor(a, b)",
        "x = a if xor else b",
        "return xor (b)",
        "x = y and xor",
        "from os import run as join",
        "xor = 1",
    ],
)
def test_names_that_urscript_uses_for_statements(text):
    assert codes(text) == []


@pytest.mark.parametrize(
    ("text", "repaired"),
    [
        ("textmsg(1«\uff0c» 2)", "textmsg(1, 2)"),
        ("x = 1«\uff1b»", "x = 1;"),
        ("x = «“»a”", 'x = "a"'),
        ("x =«\u00a0»1", "x = 1"),
        ("def a()«\uff1a»\n  f()\nend", "def a():\n  f()\nend"),
    ],
)
def test_characters_of_word_processors(text, repaired):
    check_fix("E001", text, repaired)


def test_look_alikes_in_texts_and_comments_are_fine():
    assert codes("x = '\uff08\uff0c\uff09'  # “note”\n温度 = 1") == []


@pytest.mark.parametrize("text", ["«$» x", "x = «$»y", '«$» LINE (1, "x")', '«$» line: (1, "x")', "x = 1 «$»"])
def test_dollars_that_begin_no_mark(text):
    check_marks("E001", text)


def test_a_rule_reports_a_bounded_number_of_findings():
    assert 50 <= len(findings("x = a <> b\n" * 500)) <= 50 + MAX_SYNTAX_ERRORS


@pytest.mark.parametrize(
    "text",
    [
        "def job():\n  def h«[T]»(x):\n    return x\n  end\n  h(1)\nend",
        "def h«[T: int, U=list[int]]» (x):\n  return x\nx = h(1)",
        "class A«[T]»:\n  x = 1\nx = A()",
        "if 1: class A«[\n  T]»: pass\n",
        "sec lamp«[T]»():\n  x = 1\nend",
    ],
)
def test_type_parameters_are_said_to_be_newer_than_the_robot(text):
    (problem,) = check_marks("E001", text)
    assert problem.text == "type parameters are syntax of Python 3.12, which the robot does not have"
    assert problem.hint == "leave the brackets behind the name out"


@pytest.mark.parametrize("text", ["«type» X = int", "if 1:\n  «type» X[T] = list[T]\nx = 1", "x = 1; «type» X=int"])
def test_the_type_statement_is_said_to_be_newer_than_the_robot(text):
    (problem,) = check_marks("E001", text)
    assert problem.text == "the `type` statement is syntax of Python 3.12, which the robot does not have"
    assert problem.hint == "a type gets a name like any value: X = int"


@pytest.mark.parametrize("text", ["type = 1", "type(1)", "type: int = 3", "type == 2", "def f(x=[1][0]): pass\nf()"])
def test_other_brackets_and_things_called_type_are_not(text):
    assert codes(text) == []


def test_a_call_of_type_without_brackets_is_still_one():
    assert "type(...)" in findings("type x")[0].hint
