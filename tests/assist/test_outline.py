"""Symbols of one text and of many."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document
from elitescript.assist.outline import Symbol, document_symbols, workspace_symbols
from tests.assist.reading import cut

PROGRAM = """\
def job():
  $ LINE: (1, "main")
  def work(n, speed=(1,
      2)):
    sleep(n)
  end
  class Box:
    def get(self): return 1
  end
  start_thread(work, (1,))
  while True:
    $ LINE: (2, "步骤")
    if x:
      $ LINE: (3, "in")
      a = 1
    else:
      a = 2
    end
    $ LINE: (4, "")
    b = 1
  end
  $ LINE: (1, "main", "after")
  c = 1
end
"""


def tree(document: Document, symbols: tuple[Symbol, ...], depth: int = 0) -> list[str]:
    rows = []
    for symbol in symbols:
        lines = f"{symbol.span.line}-{symbol.span.end_line}"
        rows.append("  " * depth + f"{symbol.kind} {symbol.name}{symbol.detail} {lines}")
        name = cut(document, symbol.name_span).partition(":")[2]
        assert name == symbol.name or not name
        assert symbol.span[:2] <= symbol.name_span[:2] <= symbol.name_span[2:] <= symbol.span[2:]
        rows += tree(document, symbol.children, depth + 1)
    return rows


def test_programs_functions_threads_classes_and_nodes() -> None:
    document = Document("cell.script", PROGRAM)
    assert tree(document, document_symbols(document)) == [
        "program job() 1-24",
        "  node main1 2-21",
        "    thread work(n, speed=(1, 2)) 3-6",
        "    class Box 7-9",
        "      method get(self) 8-8",
        "    node 步骤2 12-18",
        "      node in3 14-15",
        "    node 44 19-20",
    ]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", []),
        ("x = 1\n", []),
        ("sec go():\n  textmsg(1)\nend\n", ["secondary go() 1-3"]),
        ("def f():\n  pass\nend\ndef g(a):\n  pass\n\n\nf()\n", ["function f() 1-3", "function g(a) 4-5"]),
        ("def job():\r\n  x = (\r\n  def f(\r\nend\r\n", ["program job() 1-4", "  function f 3-3"]),
        ("def job():\n  def f(a", ["program job() 1-2", "  function f 2-2"]),
        ("def job()\n  x = 1\nend\n", ["program job() 1-3"]),
    ],
)
def test_broken_and_small_texts(text: str, expected: list[str]) -> None:
    document = Document("cell.script", text)
    assert tree(document, document_symbols(document)) == expected


def test_a_query_over_documents_ranks_its_matches() -> None:
    documents = [
        Document("a.script", "def move_up():\n  pass\nend\ndef up():\n  pass\nend\n"),
        Document("b.script", "def outer():\n  def upper():\n    pass\n  end\n  def u_p():\n    pass\n  end\nend\n"),
    ]

    def found(query: str) -> list[str]:
        return [f"{item.document}:{item.container}:{item.symbol.name}" for item in workspace_symbols(documents, query)]

    assert found("UP") == ["a.script::up", "b.script:outer:upper", "a.script::move_up", "b.script:outer:u_p"]
    assert found("mvup") == ["a.script::move_up"]
    assert found("zz") == []
    assert len(found("")) == 5
    assert len(workspace_symbols(documents, "", limit=2)) == 2
