"""What `check` says of programs that are still being typed: few findings, at the place where something is missing."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document

ABOVE = "def job():\n  v = 0.2\n  def work(n):\n    sleep(n)\n  end\n"
BELOW = "  movej([0, -1.57, 1.57, -1.57, -1.57, 0], a=1.4, v=1.05)\n  work(1)\nend\n"

BODY = "should be indented here"
OPEN = "is never closed"

# What is typed in line 6, and the findings: place, code, a part of the text.
TYPED = [
    ("  mov", [("6:3", "W201", "`mov` is not defined")]),
    ("  movej", [("6:3", "W215", "without parentheses")]),
    ("  movej(", [("6:8", "E001", OPEN)]),
    ("  movej([0, -1.57", [("6:8", "E001", OPEN)]),
    ("  movej([0, -1.57, 1.57, -1.57, -1.57, 0], a=", [("6:8", "E001", OPEN)]),
    ("  x =", [("6:6", "E001", "missing behind `=`")]),
    ("  x = v +", [("6:10", "E001", "missing behind `+`")]),
    ("  x = v.", [("6:9", "E001", "missing behind `.`")]),
    ("  x = [1, 2", [("6:7", "E001", OPEN)]),
    ("  x = [\n    1,\n    2", [("6:7", "E001", OPEN)]),
    ("  textmsg('hel", [("6:11", "E001", "string is not closed")]),
    ("  textmsg('a' +", [("6:10", "E001", OPEN)]),
    ("  s = '''abc", [("6:7", "E001", "triple-quoted string is never closed")]),
    ('  s = f"{v', [("6:7", "E001", "string is not closed")]),
    ("  if", [("6:5", "E001", "missing behind `if`")]),
    ("  if v", [("6:7", "E001", "a colon is missing")]),
    ("  if v >", [("6:9", "E001", "missing behind `>`")]),
    ("  if v > 1:", [("7:3", "E001", BODY)]),
    ("  if v > 1:\n    x = 1", []),
    ("  if v > 1:\n    x =", [("7:8", "E001", "missing behind `=`")]),
    ("  if v\n    work(1)\n  end", [("6:7", "E001", "colon behind `if` is missing")]),
    ("  if v > 1:\n    x = 1\n  else", [("8:7", "E001", "colon behind `else` is missing")]),
    ("  if v > 1:\n    x = 1\n  else:", [("9:3", "E001", BODY)]),
    (
        "  if v:\n    work(1)\n  else: +\n    work(2)\n  end",
        [("8:10", "E001", "missing behind `+`"), ("9:5", "E001", "no block begins here")],
    ),
    ("  else\n    work(1)\n  end", [("6:3", "E001", "`else` belongs to no")]),
    ("  while True:\n    mov", [("7:5", "W201", "`mov` is not defined")]),
    ("  while True:\n    movej(\n  end", [("7:10", "E001", OPEN)]),
    ("  for i in", [("6:11", "E001", "missing behind `in`")]),
    ("  for i in range(", [("6:17", "E001", OPEN)]),
    ("  for i in range(3):", [("7:3", "E001", BODY)]),
    ("  def", [("6:6", "E001", "missing behind `def`")]),
    ("  def f", [("6:8", "E001", "opening bracket is missing")]),
    ("  def f(", [("6:8", "E001", OPEN)]),
    ("  def f(\n    work(1)\n  end", [("6:8", "E001", OPEN)]),
    ("  def f():", [("7:3", "E001", BODY)]),
    ("  try:", [("7:3", "E001", BODY)]),
    ("  try:\n  end", [("6:3", "E001", "neither `except` nor `finally`")]),
    ("  try:\n    work(1)", [("6:3", "E001", "neither `except` nor `finally`")]),
    ("  try:\n    work(1)\n  except", [("8:9", "E001", "a colon is missing")]),
    ("  try:\n    work(1)\n  except Exception as", [("8:22", "E001", "missing behind `as`")]),
    ("  global", [("6:9", "E001", "missing behind `global`")]),
    ("  from math import", [("6:19", "E001", "missing behind `import`")]),
    ("  work(n=", [("6:7", "E001", OPEN)]),
    ("  start_thread(work,", [("6:15", "E001", OPEN)]),
    ("  $ LINE", [("6:3", "E001", "only begins a line mark")]),
    ("  $ LINE: (1,", [("6:11", "E001", OPEN)]),
    ("  x = 1 if v else", [("6:18", "E001", "missing behind `else`")]),
    ("  match v:", [("7:3", "E001", BODY)]),
    ("  match v:\n  end", [("6:3", "E104", "`match` is empty")]),
    ("  match v:\n    case", [("6:3", "W212", "Python 3.10"), ("7:9", "E001", "colon behind `case` is missing")]),
    ("  class A:", [("7:3", "E001", BODY)]),
]


def found(text: str) -> list[tuple[str, str, str]]:
    return [(f"{item.line}:{item.column}", item.code, item.text) for item in Document("c", text).problems]


@pytest.mark.parametrize(("typed", "expected"), TYPED, ids=[typed for typed, _ in TYPED])
def test_inside_a_program(typed: str, expected: list[tuple[str, str, str]]) -> None:
    text = f"{ABOVE}{typed}\n{BELOW}"
    problems = found(text)
    assert [item[:2] for item in problems] == [item[:2] for item in expected]
    assert all(part in item[2] for item, (_, _, part) in zip(problems, expected, strict=True))
    # What stands around it is read all the same.
    document = Document("c", text)
    assert document.parsed.is_complete
    assert document.symbols.body.bindings.keys() >= {"v", "work"}


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("", [("1:1", "W216"), ("3:7", "N228")]),
        ("  movej([0, 1", [("6:8", "E001")]),
        ("  if v > 1:", [("6:3", "E104")]),
        ("  while True:\n    movej(", [("7:10", "E001")]),
        ("  def f():", [("6:3", "E104")]),
        ("  try:", [("6:3", "E001")]),
        ("  try:\n    work(1)\n  except", [("8:9", "E001")]),
        ("  match v:", [("6:3", "E104")]),
        ("  class A:\n    def f(self", [("7:10", "E001")]),
    ],
)
def test_at_the_end_of_the_text(typed: str, expected: list[tuple[str, str]]) -> None:
    assert [item[:2] for item in found(ABOVE + typed)] == expected
    assert Document("c", ABOVE + typed).parsed.is_complete
