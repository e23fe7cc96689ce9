from __future__ import annotations

import ast
import random

import pytest

from elitescript.language.compiler import check_unit
from elitescript.language.parser import parse
from elitescript.language.text.source import SourceFile, apply_fixes
from tests.language.marked import check_marks, codes, findings
from tests.language.stage import output

EMPTY = [
    "def a():\n  «while True:»\n    # nothing\n  end\nend",
    "«def a():»\nend",
    "def a():\n  if x:\n    y()\n  «else:»\n  end\nend",
    "def a():\n  «if x:»\n  else:\n    y()\n  end\nend",
    "def a():\n  for i in r:\n    «if i:»\n  end\nend",
    "def a():\n  «class B:»  # later\nend",
    "def a():\n  «while f(1,\n    2):»\n  end\nend",
    "def a():\n  try:\n    f()\n  «except E:»\n  end\nend",
    "def a():\n  match x:\n    «case 1:»\n  end\nend",
    "def a():\n  f()\n  «with b:»\n",
    "x = 1\n«def f():»",
]


@pytest.mark.parametrize("text", EMPTY)
def test_an_empty_body_is_reported_at_its_header(text):
    check_marks("E104", text)


@pytest.mark.parametrize(
    "text",
    [
        "def a():\n  while True:\n    pass\n  end\nend",
        "def a():\n  '''only a text'''\nend",
        "def a():\n  if True: f()\n  end\nend",
        'def a():\n  if True:\n    $ LINE: (7, "only this")\n  end\nend',
        "def a():\n  if f(1, # one\n      2): g()\nend",
        "x = {1: 2}\ny = x[1:]\nz = lambda: 0\n",
        "def a():\n  f = lambda x: x\n  if (lambda: 1)(): g()\n  end\n  while lambda: 0: break\n  end\nend",
        "def a():\n  while n := f():\n    pass\n  end\nend",
    ],
)
def test_bodies_that_are_not_empty(text):
    assert codes(text) == []


@pytest.mark.parametrize(
    "text",
    [
        "def a():\n  x = 1\n    «end»\nend",
        "def a():\n  while False:\n    pass\n  x = 1\n  «end»\nend",
        "x = 1\n«end»\n",
        "def a():\n  x = 1\nend\n«end»",
        "def a():\n  if x:\n    f()\n «end» ; # odd\nend",
        "def a():\n\tif x:\n\t    f()\n    «end»\nend",
    ],
)
def test_a_closer_without_a_block_in_its_column(text):
    (found,) = check_marks("E101", text)
    assert found.hint


def test_a_stray_closer_names_the_block_that_was_meant():
    (found,) = findings("def a():\n  while x:\n    f()\n  g()\n  end\nend")
    assert "`while` of line 2" in found.hint and "line 4" in found.hint
    (found,) = findings("def a():\n  while x:\n    f()\n   end\nend")
    assert "`while` of line 2" in found.hint and "column 3" in found.hint


@pytest.mark.parametrize("suffix", ["", ";", "  ; ", "  # done", " ;# done", "\t"])
def test_closers_take_semicolons_blanks_and_comments(suffix):
    assert output(f"def a():\n  if True:\n    textmsg(1)\n  end{suffix}\n  textmsg(2)\nend{suffix}") == ["1", "2"]


def test_one_closer_closes_everything_inside():
    assert output("def a():\n for i in [1]:\n  while True:\n   if i:\n    textmsg(i)\n    break\nend") == ["1"]


@pytest.mark.parametrize(
    "text",
    [
        "end = 3; textmsg(end)",
        "v = [\nend := 3,\n]\ntextmsg(end)",
        "end = 3\nv = [\nend\n]\ntextmsg(v[0])",
        's = """\nend\n"""\ntextmsg(len(s) - 2)',
        "class C: end = 3\ntextmsg(C.end)",
        "def f(end): return end\ntextmsg(f(3))",
        "end = 3\nx = \\\nend\ntextmsg(x)",
        "for end in [3]: textmsg(end)",
        "sec = 3\ntextmsg(sec)",
        "def sec(n): return n\ntextmsg(sec (3))",
        "match = 3\ncase = 0\ntextmsg(match)",
        "thread = 3\ntextmsg(thread)",
    ],
)
def test_the_words_of_the_dialect_stay_names(text):
    assert output(text)[-1] == "3"


@pytest.mark.parametrize(
    "text",
    [
        "def a():\n  if False:\n    pass\n  end\n  «else»:\n    pass\n  end\nend",
        "def a():\n  try:\n    pass\n  end\n  «except» E:\n    pass\nend",
        "def a():\n  for i in r:\n    pass\n  end\n  «else»:\n    pass\n  end\nend",
        "def a():\n  if x:\n    pass\n  end\n  «elif» y:\n    pass\n  else:\n    pass\n  end\nend",
    ],
)
def test_a_clause_behind_the_closer_of_its_statement(text):
    check_marks("E103", text)


@pytest.mark.parametrize(
    "text",
    [
        "def a():\n  «sec» inner():\n    pass\n  end\nend",
        "def a():\n  if x:\n    «sec» inner ():\n      pass\nend",
        "«sec» one():\n  pass\nend\nsec_ = 1",
    ],
)
def test_a_secondary_program_inside_something(text):
    check_marks("E105", text)


def test_a_secondary_program_by_itself():
    assert codes("sec one():\n  pass\nend") == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def a():\nif True:\n  textmsg(1)\nend\nend\n", ["E001 2"]),
        ("def a():\n  x = 1\n    y = 2\n    z = 3\n  w = 4\nend", ["E001 3"]),
        ("def a():\n    x = 1\n   y = 2\n    z = 3\nend", ["E001 3"]),
        ("def a():\n    while x:\n        f()\n      g()\n      h()\n    i()\nend", ["E001 4"]),
        ("  x = 1\n  y = 2\n", ["E001 1"]),
        ("while x:\n  f()\nend\n  g()\n", ["E001 4"]),
        ("def a():\n  else:\n    f()\nend", ["E001 2"]),
        ("def a():\n  if x:\n    f()\n  g()\n  else:\n    h()\nend", ["E001 5"]),
        ("def a():\n  try:\n    f()\n  g()\nend", ["E001 2"]),
        ("def a():\n  while x\n    f()\n  else\n    g()\nend", ["E001 2", "E001 4"]),
        ("def a():\n  while x\n    f()\n  end\n  else\nend", ["E001 2", "E103 5", "E104 5", "E001 5"]),
        ("def a():\nelse:\n  f()\nend", ["E001 2", "E001 2"]),
        ("def a()\n  f()\nend", ["E001 1"]),
    ],
)
def test_structure_mistakes_are_reported_once_each(text, expected):
    assert codes(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        "def a():\n  x = 1\n«finally»\n  y = 2\nend",
        "def a():\n  if x:\n    f()\n«elif» y\n  end\nend",
        "def a():\n  if x:\n    f()\n«except» E\n  else:\n    g()\n  end\nend",
        "def a():\n  def b():\n«else»\n    f()\n  end\n  g()\nend",
        "def a():\n  try:\n«else»\n    f()\n  except E:\n    g()\n  end\nend",
        "def a():\n  while x:\n    f()\n  «finally»\n    g()\n  end\nend",
    ],
)
def test_a_clause_of_no_statement_does_not_end_the_block_that_goes_on_below_it(text):
    check_marks("E001", text)


def test_mistakes_below_a_clause_of_no_statement_are_found():
    (clause, below) = findings("def a():\n  x = 1\nfinally\n  while x:\n  end\nend")
    assert (clause.line, below.code, below.line) == (3, "E104", 4)
    assert codes("x = 1\nelse\n  f()\nelif x:\n  g()\nend") == ["E001 2", "E001 4"]


def test_a_line_behind_the_closer_of_its_block_is_explained():
    (found,) = findings("while x:\n  f()\nend\n  g()\n")
    assert "`end` in line 3" in found.text


@pytest.mark.parametrize("header", ["def a()", "while x", "if x", "else", "for i in r", "try", "class C", "with x"])
def test_a_missing_colon_is_put_there_by_the_fix(header):
    before = "if y:\n  g()\n" if header == "else" else ""
    after = "except E:\n  pass\n" if header == "try" else ""
    text = f"{before}{header}\n  f()\n{after}"
    (found,) = findings(text)
    assert (found.code, found.column) == ("E001", len(header) + 1)
    assert findings(apply_fixes(text, [found.fix])) == []


def test_tabs_and_blanks_mix_as_in_python():
    assert output('def a():\n\tx = 1\n\tif x:\n\t    textmsg("tab")\nend\n') == ["tab"]
    assert codes("def a():\n\tx = 1\n        y = 2\nend") == ["E001 3"]


def test_comments_at_the_margin_do_not_close_blocks():
    assert output("def a():\n  if True:\n# left\n    textmsg(1)\n# left\n  end\nend") == ["1"]


@pytest.mark.parametrize(
    "text", ["def a():\n  x = 1\n\ty = 2\nend\n", "def a():\n    if x:\n            y = 1\n\tz = 1\nend\n"]
)
def test_a_tab_among_blanks_is_named(text):
    (problem, *_) = check_unit(SourceFile("a", text))
    assert problem.code == "E001"
    assert "tab" in problem.hint


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def a():\n  else:\n  f()\nend\n", "the body of the `else` of line 2 should be indented here"),
        ("def a():\n  if x:\n    f()\n  else:\n  end\nend\n", "the body of this `else` is empty"),
        ("def a():\n  else:\nend\n", "the body of this `else` is empty"),
    ],
)
def test_messages_name_the_header_whose_body_is_missing(text, expected):
    assert expected in [problem.text for problem in check_unit(SourceFile("f", text))]


def test_no_message_quotes_an_empty_word():
    for header in ("else:", "elif x:", "except:", "finally:", "loop 5:", "(a):", '"x":', "case 1:"):
        for body in ("", "  f()\n", "    f()\n"):
            text = f"def a():\n  {header}\n{body}end\n"
            messages = [problem.text + problem.hint for problem in check_unit(SourceFile("f", text))]
            assert not any("``" in message or "` `" in message for message in messages), text


@pytest.mark.parametrize(
    "text",
    [
        'def f():\n    \\\n"text"\n    \\\na = 0\n    print(a)\n',
        "def f():\n\\\n    a = 0\n    b = 1\n",
        "def f():\n    \\\n  \\\na = 0\n    b = 1\n",
        "def f():\n    if a:\n        \\\nb = 1\n    \\\nelse:\n        c = 1\n",
        "def f():\n    \\\n\n    a = 0\n",
        "def f():\n    \\\n# c\n    a = 0\n",
    ],
)
def test_blanks_before_a_backslash_indent_the_line_below_as_in_python(text):
    parsed = parse(SourceFile("<test>", text))
    assert parsed.diagnostics == ()
    assert ast.dump(parsed.tree) == ast.dump(ast.parse(text))


def test_rows_of_a_backslash_are_read_as_python_reads_them():
    chance, rows = random.Random(5), ("a = 1", '"t"', "\\", "\\", "\\", "if a:", "", "# c", "pass")
    accepted = 0
    for _ in range(400):
        lines = [" " * chance.choice((0, 2, 4, 4, 4, 8)) + chance.choice(rows) for _ in range(chance.randint(1, 5))]
        text = "\n".join(("def f():", *lines, ""))
        try:
            tree = ast.dump(ast.parse(text))
        except SyntaxError:
            tree = ""
        parsed = parse(SourceFile("<test>", text))
        is_right = all(problem.severity != "error" for problem in parsed.diagnostics)
        accepted += is_right
        assert (ast.dump(parsed.tree) if is_right else "") == tree, text
    assert accepted > 50
