"""Definition, references and highlights of every kind of name."""

from __future__ import annotations

import ast

import pytest

from elitescript.assist.document import Document
from elitescript.assist.names import Access, Names
from elitescript.assist.references import definition, highlights, references
from tests.assist.reading import cut, marked

PROGRAM = """\
def job():
  global count
  count = 0
  speeds = [1, 2]
  def work(n, speed=1):
    total = n
    count += total
    global count
    return [total * x for x in range(n)]
  end
  def watch():
    nonlocal speeds
    speeds = [count]
  end
  class Box:
    size = 3
    def __init__(self, v=2):
      self.v = v
    def get(self): return self.v + self.size
  end
  work(2, speed=3)
  box = Box(v=3)
  textmsg(f"{box.get()} {count:>{speeds[0]}} é")
  handle = start_thread(work, (1,))
  import math as m
  from math import sin
  try:
    socket_open("1.2.3.4", 80, "cam")
    socket_send_line("é", 0, "cam")
  except (ValueError, OSError) as error:
    textmsg(error, m.pi, sin(1))
  end
  for i in range(3):
    i += 1
  end
  if (found := box.v) > 1:
    textmsg(found)
  end
  match count:
    case [first, *rest]:
      textmsg(first, rest)
    case {"a": 1, **others}:
      textmsg(others)
    case _ as whole:
      textmsg(whole)
  end
end
"""


def at(word: str, line: int, nth: int = 1) -> tuple[Document, int, int]:
    """Return the place of a word in a line of the program."""
    document = Document("cell.script", PROGRAM)
    column = -1
    for _ in range(nth):
        column = document.line(line).index(word, column + 1)
    return document, line, column + 1


@pytest.mark.parametrize(
    ("word", "line", "expected"),
    [
        ("job", 1, ["1:job"]),
        ("count", 23, ["3:count"]),
        ("count", 8, ["3:count"]),
        ("count", 39, ["3:count"]),
        ("speeds", 13, ["4:speeds"]),
        ("speeds", 23, ["4:speeds"]),
        ("work", 21, ["5:work"]),
        ("work", 24, ["5:work"]),
        ("speed", 21, ["5:speed"]),
        ("n", 6, ["5:n"]),
        ("x", 9, ["9:x"]),
        ("Box", 22, ["15:Box"]),
        ("v=3", 22, ["17:v"]),
        ("get", 23, ["19:get"]),
        ("size", 19, ["16:size"]),
        ("m.pi", 31, ["25:m"]),
        ("sin", 31, ["26:sin"]),
        ("cam", 29, ["28:cam"]),
        ("error", 31, ["30:error"]),
        ("i +=", 34, ["33:i"]),
        ("found", 37, ["36:found"]),
        ("first", 41, ["40:first"]),
        ("rest", 41, ["40:rest"]),
        ("others", 43, ["42:others"]),
        ("whole", 45, ["44:whole"]),
        ("textmsg", 23, []),
        ("range", 9, []),
        ("é", 23, []),
    ],
)
def test_definition(word: str, line: int, expected: list[str]) -> None:
    document, line, column = at(word, line)
    assert [cut(document, span) for span in definition(document, line, column)] == expected


@pytest.mark.parametrize(
    ("word", "line", "expected"),
    [
        ("count", 3, "text 2, write 3, write 7, text 8, read 13, read 23, read 39"),
        ("speeds", 4, "write 4, text 12, write 13, read 23"),
        ("work", 5, "write 5, read 21, read 24"),
        ("speed", 5, "write 5, text 21"),
        ("total", 6, "write 6, read 7, read 9"),
        ("box", 22, "write 22, read 23, read 36"),
        ("cam", 28, "write 28, text 29"),
        ("i", 33, "write 33, write 34"),
        ("v", 18, "write 18, read 19, read 36"),
        ("textmsg", 23, "read 23, read 31, read 37, read 41, read 43, read 45"),
    ],
)
def test_highlights_tell_reading_from_writing(word: str, line: int, expected: str) -> None:
    document, line, column = at(word, line)
    found = highlights(document, line, column)
    assert ", ".join(f"{item.access} {item.span.line}" for item in found) == expected


def test_references_with_and_without_the_definition() -> None:
    document, line, column = at("work", 24)
    assert [item.span.line for item in references(document, line, column)] == [5, 21, 24]
    assert [item.span.line for item in references(document, line, column, include_definition=False)] == [21, 24]


def test_the_cursor_may_stand_behind_the_name() -> None:
    document, line, column = marked("speed = 1\ntextmsg(speed¦)\n")
    assert [cut(document, span) for span in definition(document, line, column)] == ["1:speed"]


def test_names_of_two_scopes_are_two_things() -> None:
    document, line, column = marked("def f(n):\n  return ¦n\nend\ndef g(n):\n  return n\nend\n")
    assert [item.span.line for item in references(document, line, column)] == [1, 2]


def test_a_function_that_is_defined_twice_has_two_definitions() -> None:
    document, line, column = marked(
        "if True:\n  def f(a):\n    pass\n  end\nelse:\n  def f(a):\n    pass\n  end\nend\nf(¦a=1)\n"
    )
    assert [cut(document, span) for span in definition(document, line, column)] == ["2:a", "6:a"]


@pytest.mark.parametrize("broken", ["  work(sp¦eed, ", "  if sp¦eed >", "  x = [speed, sp¦eed"])
def test_a_name_in_a_line_that_cannot_be_read_yet(broken: str) -> None:
    document, line, column = marked(f"def job():\n  speed = 1\n{broken}\n  sleep(1)\nend\n")
    assert [cut(document, span) for span in definition(document, line, column)] == ["2:speed"]
    assert [item.access for item in references(document, line, column)] == [Access.WRITE]


def test_names_whose_places_are_the_same_are_not_located() -> None:
    # In some formatted strings Python gives two names one place.
    program = Document("cell.script", "a = 1\ntextmsg(f'{a:{a}}')\n").program
    first, second = (node for node in program.nodes(ast.Name) if node.lineno == 2 and node.id == "a")
    assert Names(program).unlocated == set()
    second.col_offset, second.end_col_offset = first.col_offset, first.end_col_offset
    assert Names(program).unlocated == {"a"}


def test_strings_and_comments_hold_no_names() -> None:
    for text in ("speed = 1\ntextmsg('sp¦eed')\n", "speed = 1\nx = 2  # sp¦eed\n", "speed = 1\nx = ( 'sp¦eed\n"):
        document, line, column = marked(text)
        assert definition(document, line, column) == ()
        assert references(document, line, column) == ()
