from __future__ import annotations

import pytest

from tests.language.marked import findings, range_of, unmarked

TEXTS = [
    ("if x == 1\n  f()", "colon"),
    ("if x = 1:\n  f()", "=="),
    ("f(x = = 1)", ""),
    ("f(a b)", "comma"),
    ("f(a.b=1)", "=="),
    ("def f:\n  pass", "bracket"),
    ("x = 12abc", "name"),
    ("x = 0b12", "digit"),
    ("x = 5 ° 3", "character"),
    ("f() = 1", "left of `=`"),
    ("1 = x", "left of `=`"),
    ("def f():\n\tx = 1\n        y = 1", "tabs"),
    ("break", "loop"),
    ("continue", "loop"),
    ("def f(a):\n  global a", "parameter"),
    ("def f():\n  nonlocal a", "enclosing"),
    ("def f(a, a): pass\nx = 1", "twice"),
    ("f(a=1, 2)", "last"),
    ("f(a=1, a=2)", "twice"),
    ("def f(a=1, b): pass\nx = 1", "default"),
    ("from x import *", "import"),
    ("try:\n  f()\nexcept:\n  g()\nexcept E:\n  h()", "except"),
    ("x = 1 \\ 2", "backslash"),
    ("x = 'C:\\Users'", "backslash"),
    ("x = b'\\x4'", "broken escape"),
    ("x = b'é'", "ASCII"),
    ("f(x for x in y, 1)", "brackets"),
    ("movej q1", "movej(...)"),
    ("if x:\n  f()\nelse if y:\n  g()", "elif"),
    ("if x then\n  f()", "then"),
    ("if x => 1:\n  f()", ">="),
    ("if (x) {\n  f()", ":"),
    ("int x = 1", "type"),
    ("if a & & b:\n  f()", "C"),
    ("end if", "alone"),
    ("// text", "#"),
    ("for (i=0; i<3; i+1):\n  f()", "range"),
    ("foreach x in y:\n  f()", "for"),
    ("loop 5:\n  f()", "while"),
    ("switch x:\n  f()", "elif"),
    ("case 3:\n  f()", "match"),
    ("catch e:\n  f()", "except"),
    ("x = new Box()", "new"),
    ("if a AND b:\n  f()", "small"),
    ("x === 3", "=="),
    ("x := 3", "="),
    ("function f()\n  x = 1", "def"),
    ("x = f'{'", "brace"),
    ("x = f'{a b}'", ""),
    ("x: int = 1\nglobal x", ""),
    ("x = " + "9" * 5000, "digits"),
    ("class = 1", ""),
    ("def f():\n  return\nreturn = 1", ""),
]


@pytest.mark.parametrize(("text", "word"), TEXTS)
def test_messages_are_plain_and_helpful(text, word):
    found = [problem for problem in findings(text) if problem.code in ("E001", "E109")]
    assert found
    message = f"{found[0].text} {found[0].hint}"
    assert word in message
    assert "invalid syntax" not in message
    assert not message.startswith("E001")
    assert message[0] == message[0].lower() or message[0] == "`"


@pytest.mark.parametrize(
    "text",
    [
        'x = """one\n  ok \\n \\x41\n  «\\x4»\n  """\ny = 1',
        "x = 'ab' + 'cd«\\x4» ef'; y = 1",
        "x = '温\\t' 'C:«\\U»sers'",
        "x = ['a',\n  '\\\\x4 «\\u12»']",
        "x = '«\\U00110000»'",
        "x = '\\N{DIGIT ONE} «\\N{NO SUCH SIGN}»'",
        "x = '«\\N»orth'",
        "x = b'\\u «\\x»g'",
        "x = r'\\x4', '«\\x4»'",
        "x = f'{1} «\\x4»'",
        "if x == '«\\x4»':\n  y = 1",
    ],
)
def test_a_broken_escape_is_marked_where_it_stands(text):
    plain, ranges = unmarked(text)
    (problem,) = (problem for problem in findings(plain) if problem.is_error)
    assert [range_of(problem)] == ranges
    assert problem.text == "the string has a broken escape"
