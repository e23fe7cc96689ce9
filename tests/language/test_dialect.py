from __future__ import annotations

import ast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elitescript.language.options import LINE, Options
from elitescript.language.text.dialect import translate
from elitescript.language.text.source import SourceFile
from tests.language.marked import check_marks, codes
from tests.language.stage import Stage, output


def translated(text, **options):
    return translate(SourceFile("f", text), Options(**options))


def test_python_stays_as_it_is():
    text = "import math\n\n\ndef f(a, *b, c=1, **d):\n    return {x: y for x, y in d.items() if x is not None}\n"
    assert translated(text).text == text
    assert translated(text).positions.is_identity


def test_closers_become_blanks_of_the_same_width():
    assert translated("def a():\n  f()\n  end;  # x\nend").text == "def a():\n  f()\n        # x\n   "


def test_secondary_programs_become_functions_in_the_same_columns():
    translation = translated("sec  go():\n  f()\nend")
    assert translation.text.startswith("def  go():")
    assert translation.secondaries == {1}


@pytest.mark.parametrize(
    "mark",
    [
        '$ LINE: (1, "main")',
        '$LINE:(1,"main")',
        '$  LINE :  (1, "main")',
        '$ LINE: (1, "main"); f()',
        '$ LINE: (1, "main")  # x',
    ],
)
def test_line_marks_become_calls_in_the_same_columns(mark):
    translation = translated(f"def a():\n  {mark}\nend")
    call = ast.parse(translation.text).body[0].body[0].value
    assert [argument.value for argument in call.args] == [1, "main"]
    assert translation.marks == {(2, 3)}
    assert len(translation.text.split("\n")[1]) == len(f"  {mark}")


def test_line_marks_run():
    stage = Stage()
    stage.run('def a():\n  $ LINE: (1, "主")\n  if True: $ LINE: (2, "x", "after")\n  y = 1; $ LINE: (3, "z")\nend')
    assert stage.marks == [(1, "主"), (2, "x", "after"), (3, "z")]


@pytest.mark.parametrize(
    "arguments",
    [
        "()",
        "(1)",
        '("x", 1)',
        '(1, "x", "y", "z")',
        "(1, x)",
        '(n, "x")',
        '(1, label="x")',
        '(True, "x")',
        '(1.0, "x")',
        '(1, "x") + 1',
    ],
)
def test_malformed_line_marks(arguments):
    assert codes(f"def a():\n  $ LINE: {arguments}\nend") == ["E001 2"]


@pytest.mark.parametrize(
    ("text", "column", "author_column"),
    [
        ("print'a'; x", 13, 11),
        ("print x; y", 9, 8),
        ("print x; y", 11, 10),
        ('f("\\e", x)', 10, 8),
        ('f("\\e", x)', 4, 4),
        ('f("\\e", x)', 6, 6),
        ('f("\\e", x)', 7, 6),
        ('f("\\e\\e", x)', 14, 10),
    ],
)
def test_columns_behind_a_rewrite_lead_back(text, column, author_column):
    assert translated(text).positions.to_source(1, column) == (1, author_column)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_line_ends_of_every_kind(end):
    text = "def a():\n  for k in [1, 2]:\n    textmsg(k)\n  end\nend\n"
    assert output(text.replace("\n", end)) == ["1", "2"]


# A function on one line


def unfolded(text):
    return translated(text, kind=LINE, one_line_blocks=True).text


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("def f(): ; a() ; b() ; end ;", ["def f():", "  a()", "  b()", "   "]),
        ("while x: ; a() ; end", ["while x:", "  a()", "   "]),
        (
            "if x: ; a() ; elif y: ; b() ; else: ; c() ; end; d()",
            ["if x:", "  a()", "elif y:", "  b()", "else:", "  c()", "   ", "d()"],
        ),
        ("try: ; a(';', [1 ; end", None),
        ("def f(): return 1", None),
        ("a(); b();", None),
        ("x = {1: 2}; y = x[1:]", None),
    ],
)
def test_one_line_blocks_are_unfolded(text, rows):
    assert unfolded(text) == (text if rows is None else "\n".join(rows))


def test_one_line_blocks_run():
    text = 'def f(n): ; textmsg("f", n) ; if n > 1: ; textmsg("big") ; end ; end; f(1); f(2);'
    assert output(text, kind=LINE, one_line_blocks=True) == ["f1", "f2", "big"]


def test_one_line_blocks_are_for_the_interpreter_channel_alone():
    assert codes("def f(): ; a() ; end", kind=LINE) != []
    assert codes("def f(): ; a() ; end", one_line_blocks=True) != []


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("E102", "«def f():» ; a()"),
        ("E102", "«def f():» ; if x: ; a() ; end"),
        ("E101", "if x: ; a() ; end; «end»"),
        ("E104", "«def f():» ; end"),
        ("E001", "def f(): ; a(«b c») ; end"),
        ("E111", "def f(): ; if a «<>» b: ; c() ; end ; end"),
        ("E106", "def f(): ; «print» x ; end"),
        ("E115", "def f(): ; x.«__dict__» ; end"),
    ],
)
def test_mistakes_in_one_line_blocks_have_their_place_in_the_line(code, text):
    check_marks(code, text, kind=LINE, one_line_blocks=True)


FRAGMENTS = [
    r"",
    r"def a():",
    r"sec b():",
    r"  x = 1",
    r"  if x:",
    r"    f(x)",
    r"  else:",
    r"  end",
    r"end",
    r"    end",
    r"  print x,",
    r"  y = 12L",
    r'  s = "\e\o12"',
    r'  $ LINE: (1, "n")',
    r"  global z = 1",
    r"  x++",
    r"  t = '''",
    r"  '''",
    r"  f(1,",
    r"  2)",
    r"",
    r"  # c",
    r"	x",
    r" x",
    r"  while x",
    r"  try:",
    r"  except E, e:",
    r"  x = a ? b : c",
    r"  raise E, 1",
    r"  `x`",
    r"  x = 'a",
    r"温度 = 1",
    r"",
]


@settings(max_examples=300)
@given(st.lists(st.sampled_from(FRAGMENTS), max_size=12))
def test_no_line_is_ever_added_or_removed(fragments):
    text = "\n".join(fragments)
    translation = translated(text)
    assert translation.text.count("\n") == text.count("\n")


@settings(max_examples=200)
@given(st.lists(st.sampled_from(FRAGMENTS), max_size=12))
def test_what_was_translated_needs_no_translation(fragments):
    first = translated("\n".join(fragments))
    if not first.diagnostics and not first.marks:
        assert translated(first.text).text == first.text
