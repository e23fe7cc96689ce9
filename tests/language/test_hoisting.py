from __future__ import annotations

import pytest

from elitescript.language.diagnostics import Severity
from elitescript.language.text.source import apply_fixes
from tests.language.marked import check_marks, codes, findings, unmarked
from tests.language.stage import Stage

LATE = [
    ("x = 1\nglobal «x»\nx = 2", "global x\nx = 1\nx = 2"),
    (
        "def a():\n  speed = 0.25\n  textmsg(speed)\n  global «speed»\n  speed = 0.1\nend",
        "def a():\n  global speed\n  speed = 0.25\n  textmsg(speed)\n  speed = 0.1\nend",
    ),
    (
        "def a():\n  '''doc'''\n  f(x)\n  global «x»  # note\nend",
        "def a():\n  '''doc'''\n  global x\n  f(x)\n  pass  # note\nend",
    ),
    (
        "def a():\n  x = 1\n  if x:\n    global «x»\n  end\nend",
        "def a():\n  global x\n  x = 1\n  if x:\n    pass\n  end\nend",
    ),
    (
        "def a():\n  def b():\n    y = x\n    global z, «x»\n    z = 1\n  end\nend",
        "def a():\n  def b():\n    global z, x\n    y = x\n    z = 1\n  end\nend",
    ),
    ("def a():\n  x = y = 1\n  global «y», «x»\n  f()\nend", "def a():\n  global y, x\n  x = y = 1\n  f()\nend"),
    (
        "class C:\n  x = 1\n  global «x»\n  y = 2\nz = 1",
        "class C:\n  global x\n  x = 1\n  y = 2\nz = 1",
    ),
    ("for i in y:\n  f(i)\nend\nglobal «i»\ni = 1", "global i\nfor i in y:\n  f(i)\nend\ni = 1"),
    ("def f(): x = 1; global «x»\nz = 1", None),
    ("global x\nx = 1\nglobal «x»\nf()", "global x\nglobal x\nx = 1\nf()"),
]


@pytest.mark.parametrize(("text", "repaired"), LATE)
def test_late_declarations_are_accepted_with_a_warning(text, repaired):
    found = check_marks("E109", text)
    assert {problem.severity for problem in found} == {Severity.WARNING}
    assert (found[0].fix is None) == (repaired is None)
    if found[0].fix:
        assert apply_fixes(unmarked(text)[0], [found[0].fix]) == repaired
        assert codes(repaired, strict=True) == []


@pytest.mark.parametrize(("text", "repaired"), LATE)
def test_strict_refuses_them(text, repaired):
    found = check_marks("E109", text, strict=True)
    assert {problem.severity for problem in found} == {Severity.ERROR}


@pytest.mark.parametrize(
    "text",
    [
        "global x\nx = 1",
        "f()\nglobal x\nx = 1",
        "global u\nglobal u\nu = 3",
        "x = 1\ndef f():\n  global x\n  x = 2\n",
        "def f():\n  y = x\ndef g():\n  global x\n  x = 1\n",
        "if y:\n  global x\nelse:\n  global x\nx = 1",
    ],
)
def test_declarations_in_time(text):
    assert codes(text, strict=True) == []


@pytest.mark.parametrize(
    ("text", "out", "values"),
    [
        ("speed = 0.25\ntextmsg(speed)\nglobal speed\nspeed = 0.1", ["0.25"], {"speed": 0.1}),
        ("def f():\n  n = 1\n  global n\n  n += 1\nend\nf()\ntextmsg(n)", ["2"], {"n": 2}),
        ("for i in [1]:\n  x = i\n  global x\nend\ndef f():\n  textmsg(x)\nend\nf()", ["1"], {"x": 1}),
    ],
)
def test_a_late_declaration_counts_from_the_start(text, out, values):
    stage = Stage()
    unit = stage.run(text)
    assert (stage.out, stage.globals) == (out, values)
    assert unit.global_names == set(values)
    assert [problem.code for problem in unit.diagnostics] == ["E109"]


def test_it_says_where_the_name_was_used():
    (found,) = findings("f()\ng(x)\nx = 1\nglobal x")
    assert "line 2" in found.text


@pytest.mark.parametrize("text", ["def f(a):\n  global a\nz = 1", "def f(a):\n  a = 1\n  global a\nz = 1"])
def test_a_parameter_cannot_be_global(text):
    found = findings(text)
    assert [problem.code for problem in found] == ["E001"]
    assert "parameter" in found[0].text


def test_late_declarations_and_other_mistakes_are_found_together():
    assert codes("x = 1\nglobal x\nbreak\ny = 1\nglobal y\ncontinue\ndef f(a, a): pass") == [
        "E109 2",
        "E001 3",
        "E109 5",
        "E001 6",
        "E001 7",
    ]
