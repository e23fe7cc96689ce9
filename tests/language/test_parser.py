from __future__ import annotations

import ast

import pytest

from elitescript.language.options import LINE, PROGRAM, SCRIPT, SECONDARY, Options
from elitescript.language.parser import MAX_SYNTAX_ERRORS, parse, parse_without
from elitescript.language.text.source import SourceFile
from tests.language.marked import check_marks, codes, findings, unmarked


def parsed(text, **options):
    return parse(SourceFile("f", text), Options(**options))


@pytest.mark.parametrize(
    ("text", "kind", "name"),
    [
        ("def job():\n  f()\nend\n", PROGRAM, "job"),
        ("# note\n\ndef job():\n  f()\n", PROGRAM, "job"),
        ('"""note"""\ndef job():\n  f()\nend\n"""more"""', PROGRAM, "job"),
        ("def 任务():\n  f()\nend\n", PROGRAM, "任务"),
        ("sec go():\n  f()\nend\n", SECONDARY, "go"),
        ("x = 1\n", SCRIPT, ""),
        ("", SCRIPT, ""),
        ("def a():\n  f()\nend\ndef b():\n  f()\nend\n", SCRIPT, ""),
        ("def a():\n  f()\nend\na()\n", SCRIPT, ""),
        ("x = 1\ndef a():\n  f()\nend\n", SCRIPT, ""),
        ("class A:\n  pass\n", SCRIPT, ""),
        ("@d\ndef a():\n  f()\nend\n", SCRIPT, ""),
    ],
)
def test_kinds_of_texts(text, kind, name):
    result = parsed(text)
    assert (result.kind, result.name, result.has_errors) == (kind, name, False)
    assert (result.unit is not None) == (kind in (PROGRAM, SECONDARY))


@pytest.mark.parametrize("kind", [SCRIPT, LINE])
def test_a_wanted_script_is_not_taken_for_a_program(kind):
    result = parsed("def job():\n  f()\nend\n", kind=kind)
    assert (result.kind, result.unit) == (kind, None)


@pytest.mark.parametrize(
    ("text", "kind"),
    [("x = 1", PROGRAM), ("sec go():\n  f()\nend", PROGRAM), ("def go():\n  f()\nend", SECONDARY), ("", PROGRAM)],
)
def test_a_text_of_another_kind_than_wanted_is_refused(text, kind):
    assert codes(text, kind=kind) == ["E001 1"]


def test_an_unknown_kind_is_the_callers_mistake():
    with pytest.raises(ValueError, match="kind must be"):
        parsed("x", kind="task")


@pytest.mark.parametrize(
    "text",
    [
        "def a():\n  «1»abcd\nend",
        "x = («3 4»)",
        "if «x = 3»:\n  f()",
        "f(a=1, 2«)»",
        "x = 1 +«»",
        "for «1» in x:\n  f()",
        "x = [1,\n     «3 4»]",
        "«f(1)» = 2",
        "import «*» from x",
        "del «f()»",
        "«break»",
        "def f(a, «a»): pass\nx = 1",
        "def f():\n  «nonlocal x»\ny = 1",
        "«lambda: x» = 1",
    ],
)
def test_syntax_errors_have_their_place(text):
    plain, ((line, column, _, _),) = unmarked(text)
    (found,) = findings(plain)
    assert found.code == "E001"
    assert found.line == line
    assert abs(found.column - column) <= 2


def test_python_counts_columns_in_characters():
    (found,) = findings("温度 = '온도' 5")
    assert (found.line, found.column) == (1, 11)
    (found,) = findings("def f():\n  温度 = 1\n  for 温 in x: 温 = 3; break\nif 温: x = '温'; break")
    assert (found.line, found.column) == (4, 16)


def test_columns_behind_rewritten_text_are_the_authors():
    found = findings("print'温'; x = 1 2\nprint '온도'; break\ny = '\\e\\e'; break")
    places = [(problem.line, problem.column) for problem in found if problem.code == "E001"]
    assert places == [(1, 17), (2, 13), (3, 13)]


def test_several_mistakes_are_found_in_one_pass():
    text = "\n".join(
        [
            "def a():",
            "  x = = 1",
            "  if x = 3:",
            "    f(1 2)",
            "  elif (:",
            "    y = 'abc",
            "  else:",
            "    f(",
            "  end",
            "  while True",
            "    g()",
            "  end",
            "  @@",
            "  def h(",
            "  break",
            "  return )",
            "end",
        ]
    )
    assert codes(text) == [f"E001 {line}" for line in (2, 3, 4, 5, 6, 8, 10, 13, 14, 15, 16)]


def test_a_mistake_in_a_header_does_not_hide_its_body():
    for header in ("if x y:", "while 1 1:", "for x on y:", "def f(1):", "class 1:", "with a b:", "elif x y:", "try 1:"):
        before = "if x:\n  f()\n" if header.startswith("elif") else ""
        assert codes(f"{before}{header}\n  x = = 1\n  y = 1\nz = = 1\n")[-2:] == [
            f"E001 {2 + before.count(chr(10))}",
            f"E001 {4 + before.count(chr(10))}",
        ]


def test_what_can_be_read_is_in_the_tree():
    result = parsed("def a():\n  x = = 1\n  def f():\n    return 1\n  y = (\n  def g():\n    pass\nend")
    names = [node.name for node in ast.walk(result.tree) if isinstance(node, ast.FunctionDef)]
    assert names == ["a", "f", "g"]
    assert result.is_complete


def test_a_line_gets_one_syntax_error():
    assert codes("x = 012 013 = =\n") == ["E001 1", "E001 1"]
    assert codes("x = = = (\ny = 1") == ["E001 1"]


def test_the_number_of_syntax_errors_is_bounded():
    found = codes("x = = 1\n" * 100)
    assert len(found) == MAX_SYNTAX_ERRORS + 1
    assert not parsed("x = = 1\n" * 100).is_complete


@pytest.mark.parametrize("text", ["(" * 5000, "-" * 100_000 + "1", "a" + ".a" * 50_000, "x = " + "[" * 300 + "]" * 300])
def test_texts_that_python_cannot_read_are_refused(text):
    assert {code.split()[0] for code in codes(text)} <= {"E001", "E113"}
    assert codes(text) != []


def test_nul_characters_in_a_row_are_one_mistake():
    assert [(found.code, found.text) for found in findings("x = 1" + "\0" * 5000)] == [
        ("E001", "5000 NUL characters in a row cannot stand in a program")
    ]


def test_characters_that_are_no_text():
    assert [(found.code, found.line, found.column) for found in findings("x = 1\ny = '\0' + '\ud800'")] == [
        ("E001", 2, 6),
        ("E002", 2, 12),
    ]


def test_positions_in_the_tree_are_the_authors():
    result = parsed("def a():\n  print '온도', 温度; y = x\nend")
    names = {node.id: node for node in ast.walk(result.tree) if isinstance(node, ast.Name)}
    row = result.source.line(2).encode()
    for name in ("温度", "x", "y"):
        node = names[name]
        assert row[node.col_offset : node.end_col_offset].decode() == name


def test_positions_in_an_unfolded_line_are_the_authors():
    result = parsed("def f(n): ; y = n ; if n > 1: ; z = y ; end ; end;", kind=LINE, one_line_blocks=True)
    row = result.source.line(1)
    for node in ast.walk(result.tree):
        if isinstance(node, ast.Name):
            assert node.lineno == 1
            assert row[node.col_offset : node.end_col_offset] == node.id


def test_reading_without_a_line():
    first = parsed("x = 1\nif x:\n  break\ny = 2")
    second = parse_without(first, 3)
    assert ast.unparse(second.tree) == "x = 1\nif x:\n    pass\ny = 2"
    assert parse_without(parse_without(second, 3), 3) is None


def test_a_block_header_is_no_line_unit():
    check_marks("E001", "«if True:»", kind=LINE)
    check_marks("E001", "  «t»extmsg(1)", kind=LINE)
    assert codes("if True: f()", kind=LINE) == []
