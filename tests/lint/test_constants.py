from __future__ import annotations

import ast
import math

import pytest

from elitescript.language.parser import parse
from elitescript.language.symbols import Symbols
from elitescript.language.text.source import SourceFile
from elitescript.lint.constants import Constants, Unknown
from tests.lint.checking import source


def value(text: str):
    """The value of the last call's only argument."""
    symbols = Symbols(parse(SourceFile("<test>", source(text))))
    scope, call = [(scope, call) for scope in symbols.scopes for call in scope.calls if _called(call) == "textmsg"][-1]
    return Constants(symbols).value(call.args[0], scope)


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
        "sqrt(4)",
        "1 / 0",
        "'a' * 3",
        "3 * 'a'",
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
        "1 < 2",
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
    assert isinstance(value("def d2r(x):\n  return x\ntextmsg(d2r(90))"), Unknown)


def test_a_name_that_is_set_once_is_certain():
    assert value("A = 2\nB = A * 3\ntextmsg(B + 1)") == 7


def test_also_in_a_function_inside():
    assert value("A = 2\ndef f():\n  textmsg(A)\nf()") == 2


@pytest.mark.parametrize(
    "lines",
    [
        "a1 = 1\na1 = 2",
        "a1 = 1\na1 += 1",
        "a1 = 1\ndel a1",
        "global a1\na1 = 1\na1 = 2",
        "for a1 in [1]:\n  pass",
        "a1, b1 = 1, 2",
        "a1 = b1 = 1",
        "a1 = a1",
        "a1 = b1\nb1 = a1",
        "a1 = 1\ndef f():\n  nonlocal a1\n  a1 = 2",
        "import a1",
        "def a1():\n  pass",
        "with open('f') as a1:\n  pass",
        "a1: int = 1",
    ],
)
def test_a_name_that_may_change_is_unknown(lines):
    body = "".join(f"  {line}\n" for line in lines.split("\n"))
    assert isinstance(value(f"def job():\n{body}  textmsg(a1)\nend\n"), Unknown)


def test_a_parameter_is_unknown():
    assert isinstance(value("def f(a1=1):\n  textmsg(a1)\nf()"), Unknown)


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
        "q1.append(3)",
        "q1[0] = 3",
        "q1[0] += 3",
        "del q1[0]",
        "q2 = q1\nq2[0] = 3",
        "q2 = q1\nq2 = 3",
        "q3 = q2 = q1",
        "q2 = [q1]",
        "def f(q):\n  q[0] = 1\nf(q1)",
        "start_thread(print, q1)",
        "x = q1 or 3",
        "f = q1.append",
        "def movej(q):\n  q[0] = 1\nmovej(q1)",
        "def f():\n  q1[0] = 3\nf()",
        "def f():\n  return q1\nf()",
    ],
)
def test_a_list_that_something_may_change_is_unknown(use):
    assert isinstance(value(f"q1 = [1, 2]\n{use}\ntextmsg(q1)"), Unknown)


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
        "q1 = [[1, 2], [3, 4]]\nq1[0][0] = 5\ntextmsg(q1[1])",
        "q1 = [[1, 2], [3, 4]]\nfor q2 in q1:\n  q2[0] = 5\ntextmsg(q1[1])",
        "q1 = [1, 2]\ntextmsg(q1[2])",
        "q1 = [1, 2]\ntextmsg(q1['a'])",
        "textmsg(pose_trans([1, 0, 0, 0, 0, x], [0, 2, 0, 0, 0, 0]))",
        "textmsg(pose_trans([1, 0], [0, 2, 0, 0, 0, 0]))",
        "def f(a):\n  textmsg(a)\nf(1)\nf(2)",
        "def f(a):\n  textmsg(a)\nstart_thread(f, [1])",
        "def f(a):\n  textmsg(a)\nf(*[1])",
        "def f(a):\n  a = 2\n  textmsg(a)\nf(1)",
    ],
)
def test_what_is_not_certain_is_not_followed(text):
    assert isinstance(value(text), Unknown)


def test_a_list_of_lists_may_change_inside():
    assert isinstance(value("q1 = [[1], [2]]\nx = q1[0]\nx[0] = 3\ntextmsg(q1)"), Unknown)


def test_deep_expressions_are_given_up():
    assert isinstance(value("textmsg(" + "1 + " * 500 + "1)"), Unknown)
    assert isinstance(value("".join(f"a{n} = a{n - 1}\n" for n in range(1, 60)) + "textmsg(a59)"), Unknown)
