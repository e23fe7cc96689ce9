from __future__ import annotations

import ast
import math

import pytest

from elitescript.language.parser import parse
from elitescript.language.symbols import Symbols
from elitescript.language.text.source import SourceFile
from elitescript.lint.constants import Constants, Unknown
from elitescript.values.program import Values
from tests.lint.checking import source


def value(text: str):
    """The value of the last call's only argument."""
    symbols = Symbols(parse(SourceFile("<test>", source(text))))
    scope, call = [(scope, call) for scope in symbols.scopes for call in scope.calls if _called(call) == "textmsg"][-1]
    return Constants(lambda: Values(symbols)).value(call.args[0], scope)


def _called(call: ast.Call) -> str:
    return call.func.id if isinstance(call.func, ast.Name) else ""


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("1", 1),
        ("-1.57", -1.57),
        ("2 * 3.14 + 1", 7.28),
        ("not True", False),
        ("2 ** 5 // 3 % 4", 2),
        ("1 << 4 | 1", 17),
        ("'a' + 'b'", "ab"),
        ("[0, -1, d2r(180)]", [0, -1, math.pi]),
        ("[1, 2] + [3]", [1, 2, 3]),
        ("[0] * 3", [0, 0, 0]),
        ("(1, 'a', None, b'x')", (1, "a", None, b"x")),
        ("r2d(d2r(90))", 90.0),
        ("sqrt(4)", 2.0),
        ("'a' * 3", "aaa"),
        ("3 * 'a'", "aaa"),
        ("1 < 2", True),
        ("f'a{1}{2.5}{True}'", "a12.5True"),
        ("'10.0.0.' + str(5)", "10.0.0.5"),
    ],
)
def test_arithmetic_of_literals_is_certain(expression, expected):
    result = value(f"textmsg({expression})")
    assert result == expected
    assert type(result) is type(expected)


@pytest.mark.parametrize(
    "expression",
    [
        "1 / 0",
        "'%d' % 3",
        "2 ** 1000",
        "10 ** 64 ** 64",
        "1j",
        "x",
        "[*x]",
        "{}",
        "f'{1:d}'",
        "f'{1!r}'",
        "f'{x}'",
        "str(x)",
        "str([1])",
        "d2r('a')",
        "d2r(x)",
        "[0] * 100000",
        "[1] + (2,)",
        "math.pi",
        "1 @ 2",
        "-'a'",
        "...",
    ],
)
def test_what_is_not_worked_out_is_unknown(expression):
    assert isinstance(value(f"textmsg({expression})"), Unknown)


def test_a_list_knows_what_stands_for_its_unknown_elements():
    first, second = value("textmsg([1, get_flag( 0 )])")
    assert first == 1
    assert second.text == "get_flag( 0 )"


def test_the_constants_of_math_need_the_import():
    assert value("import math\ntextmsg(math.pi / 2)") == math.pi / 2
    assert isinstance(value("math = 3\ntextmsg(math.pi)"), Unknown)
    assert isinstance(value("import math\ntextmsg(math.nothing)"), Unknown)


def test_d2r_of_the_program_is_not_the_command():
    assert value("def d2r(x):\n  return x\ntextmsg(d2r(90))") == 90


def test_a_name_that_is_set_once_is_certain():
    assert value("A = 2\nB = A * 3\ntextmsg(B + 1)") == 7


def test_also_in_a_function_inside():
    assert value("A = 2\ndef f():\n  textmsg(A)\nf()") == 2


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("a1 = 1\na1 = 2", 2),
        ("a1 = 1\na1 += 1", 2),
        ("for a1 in [1]:\n  pass", 1),
        ("a1, b1 = 1, 2", 1),
        ("a1 = b1 = 1", 1),
        ("a1: int = 1", 1),
        ("a1 = 1\nif get_flag(0):\n  a1 = 2\nelse:\n  a1 = 2", 2),
    ],
)
def test_a_name_is_what_was_assigned_last(lines, expected):
    body = "".join(f"  {line}\n" for line in lines.split("\n"))
    assert value(f"def job():\n{body}  textmsg(a1)\nend\n") == expected


@pytest.mark.parametrize(
    "lines",
    [
        "global a1\na1 = 1\na1 = 2",
        "a1 = a1",
        "a1 = b1\nb1 = a1",
        "a1 = 1\ndef f():\n  nonlocal a1\n  a1 = 2",
        "a1 = 1\nif get_flag(0):\n  a1 = 2",
        "a1 = 1\nwhile get_flag(0):\n  a1 += 1",
        "import a1",
        "def a1():\n  pass",
        "with open('f') as a1:\n  pass",
        "a1 = 1\ntry:\n  a1 = 2\n  sync()\n  a1 = 3\nexcept Exception:\n  pass",
    ],
)
def test_a_name_that_may_change_is_unknown(lines):
    body = "".join(f"  {line}\n" for line in lines.split("\n"))
    assert isinstance(value(f"def job():\n{body}  textmsg(a1)\nend\n"), Unknown)


def test_a_parameter_is_what_all_calls_pass():
    assert value("def f(a1=1):\n  textmsg(a1)\nf()") == 1
    assert isinstance(value("def f(a1=1):\n  textmsg(a1)\nf()\nf(2)"), Unknown)
    assert isinstance(value("def f(a1=1):\n  textmsg(a1)\nf()\ng = [f]"), Unknown)


@pytest.mark.parametrize(
    "use",
    [
        "movej(q1)",
        "movej(q=q1)",
        "x = q1[0]",
        "x = q1[q1[0]]",
        "x = q1 + [1]",
        "x = q1.copy()",
        "x = len(q1)",
        "x = q1 == [1]",
        "for x in q1:\n  pass",
        "x = [y for y in q1]",
    ],
)
def test_a_list_that_nobody_changes_is_certain(use):
    assert value(f"q1 = [1, 2]\n{use}\ntextmsg(q1)") == [1, 2]


@pytest.mark.parametrize(
    "use",
    [
        "q2 = q1\nq2 = 3",
        "q3 = q2 = q1",
        "q2 = [q1]",
        "x = q1 or 3",
        "def f():\n  return q1\nf()",
        "def f(q):\n  q[0] = 1\nf(q1)",
    ],
)
def test_a_list_under_other_names_is_certain_while_nothing_else_is_put_in(use):
    assert value(f"q1 = [1, 2]\n{use}\ntextmsg(q1)") == [1, 2]


@pytest.mark.parametrize(
    "use",
    [
        "q1.append(3)",
        "del q1[0]",
        "start_thread(print, q1)",
        "f = q1.append",
        "class A:\n  pass\nA().q = q1",
        "import queue\nqueue.Queue().put(q1)",
    ],
)
def test_a_list_that_something_may_change_is_unknown(use):
    assert isinstance(value(f"q1 = [1, 2]\n{use}\ntextmsg(q1)"), Unknown)


@pytest.mark.parametrize(
    "use",
    [
        "q1[0] = 3",
        "q1[0] += 3",
        "q2 = q1\nq2[0] = 3",
        "def movej(q):\n  q[0] = 3\nmovej(q1)",
        "def f():\n  q1[0] = 3\nf()",
        "for q2 in [q1]:\n  q2[0] = 3",
        "q2 = [q1]\nq2[0][0] = 3",
        "q2 = {'a': q1}\nq2['a'][0] = 3",
    ],
)
def test_an_element_that_is_replaced_is_unknown(use):
    first, second = value(f"q1 = [1, 2]\n{use}\ntextmsg(q1)")
    assert isinstance(first, Unknown)
    assert second == 2


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def job():\n  global g\n  g = 4\n  textmsg(g)\nend", 4),
        ("q1 = [1, 2]\nq2 = q1\ntextmsg(q2)", [1, 2]),
        ("q1 = [[1, 2], [3, 4]]\ntextmsg(q1[1])", [3, 4]),
        ("q1 = [1, 2, 3]\ntextmsg(q1[-1])", 3),
        ("q1 = [1, 2, 3]\ntextmsg(q1[1:])", [2, 3]),
        ("textmsg(pose_trans([1, 0, 0, 0, 0, 0], [0, 2, 0, 0, 0, 0]))", [1, 2, 0, 0, 0, 0]),
        ("textmsg(pose_add([1, 0, 0, 0, 0, 0], [1, 2, 0, 0, 0, 0]))", [2, 2, 0, 0, 0, 0]),
        ("def f(a, b):\n  textmsg(b)\nf(1, 2)", 2),
        ("def f(a, b):\n  textmsg(b)\nf(1, b=3)", 3),
    ],
)
def test_constants_are_followed(text, expected):
    assert value(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "q1 = [1, 2]\ntextmsg(q1[2])",
        "q1 = [1, 2]\ntextmsg(q1['a'])",
        "textmsg(pose_trans([1, 0], [0, 2, 0, 0, 0, 0]))",
        "def f(a):\n  textmsg(a)\nf(1)\nf(2)",
        "def f(a):\n  textmsg(a)\nf(*[1])",
    ],
)
def test_what_is_not_certain_is_not_followed(text):
    assert isinstance(value(text), Unknown)


def test_a_list_in_a_list_may_change_alone():
    first, second = value("q1 = [[1], [2]]\nx = q1[0]\nx[0] = 3\ntextmsg(q1)")
    assert isinstance(first[0], Unknown)
    assert second == [2]


def test_a_long_sum_is_computed_and_deep_nesting_is_given_up():
    assert value("textmsg(" + "1 + " * 500 + "1)") == 501
    assert isinstance(value("a = 1\ntextmsg(" + "-(" * 150 + "a" + ")" * 150 + ")"), Unknown)
