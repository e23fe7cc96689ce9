"""What is typed for the author."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document
from elitescript.assist.typing_edits import typing_edits
from elitescript.language.diagnostics import Fix
from elitescript.language.text.source import apply_fixes


def typed(text: str) -> str:
    """What becomes of a text in which the character before `|` was typed last."""
    before, _, after = text.partition("|")
    lines = before.split("\n")
    document = Document("p", before + after)
    edits = typing_edits(document, len(lines), len(lines[-1]) + 1, before[-1] if lines[-1].strip() else "\n")
    return apply_fixes(document.text, [Fix("typing", edits, safe=True)])


@pytest.mark.parametrize(
    ("text", "result"),
    [
        # The body of a new block, and its `end`.
        ("def job():\n|\n", "def job():\n  \nend\n"),
        ("def job():\n|", "def job():\n  \nend"),
        ("def job():\n  if a:\n  |\nend\n", "def job():\n  if a:\n    \n  end\nend\n"),
        ("def job():\n  if a:   # c\n  |\nend\n", "def job():\n  if a:   # c\n    \n  end\nend\n"),
        ("def job():\r\n  if a:\r\n  |\r\nend\r\n", "def job():\r\n  if a:\r\n    \r\n  end\r\nend\r\n"),
        # It has an `end`, or a body, or goes on.
        ("def job():\n  if a:\n  |\n  end\nend\n", "def job():\n  if a:\n    \n  end\nend\n"),
        ("def job():\n  if a:\n  |\n    b()\nend\n", "def job():\n  if a:\n    \n    b()\nend\n"),
        ("def job():\n  if a:\n  |\n  else:\n    b()\nend\n", "def job():\n  if a:\n    \n  else:\n    b()\nend\n"),
        # A clause is no new block.
        ("def job():\n  if a:\n    b()\n  else:\n  |\nend\n", "def job():\n  if a:\n    b()\n  else:\n    \nend\n"),
        # A program without `end`s inside gets none.
        (
            "def job():\n  if a:\n    b()\n  if c:\n  |\n  d()\nend\n",
            "def job():\n  if a:\n    b()\n  if c:\n    \n  d()\nend\n",
        ),
        # The indentation of the line above.
        ("def job():\n  a()\n|\nend\n", "def job():\n  a()\n  \nend\n"),
        ("def job():\n  if a:\n    b()\n  end\n|\nend\n", "def job():\n  if a:\n    b()\n  end\n  \nend\n"),
        ("def job():\n  if a: b()\n|\nend\n", "def job():\n  if a: b()\n  \nend\n"),
        # The rest of a line that was cut goes into the body.
        ("def job():\n|a()\nend\n", "def job():\n  a()\nend\n"),
        # The author decides.
        ("def job():\n  a(\n|\nend\n", "def job():\n  a(\n\nend\n"),
        ("def job():\n  a()\n\n|\nend\n", "def job():\n  a()\n\n\nend\n"),
        ("|", ""),
    ],
)
def test_a_new_line(text, result):
    assert typed(text) == result


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("def job():\n  if a:\n    b()\n    end|\nend\n", "def job():\n  if a:\n    b()\n  end\nend\n"),
        ("def job():\n  a()\n  end|\n", "def job():\n  a()\nend\n"),
        ("def job():\n  if a:\n    b()\n  end\n  end|\n", "def job():\n  if a:\n    b()\n  end\nend\n"),
        # It stands where a block begins.
        ("def job():\n  if a:\n    while b:\n      c()\n  end|\nend\n", None),
        ("def job():\n  if a:\n    b()\n  end|\nend\n", None),
        # Not the word.
        ("def job():\n  if a:\n    b()\n    send|\nend\n", None),
        ("def job():\n  if a:\n    b('''\n    end|\n''')\nend\n", None),
        ("    end|\n", None),
    ],
)
def test_end(text, result):
    assert typed(text) == (text.replace("|", "") if result is None else result)


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("def job():\n  if a:\n    b()\n    else:|\nend\n", "def job():\n  if a:\n    b()\n  else:\nend\n"),
        ("def job():\n  if a:\n    b()\n    elif c:|\nend\n", "def job():\n  if a:\n    b()\n  elif c:\nend\n"),
        (
            "def job():\n  try:\n    if a:\n      b()\n      except:|\nend\n",
            "def job():\n  try:\n    if a:\n      b()\n  except:\nend\n",
        ),
        ("def job():\n  if a:\n    b()\n  else:|\nend\n", None),
        ("def job():\n  x = {1:|\nend\n", None),
        ("def job():\n  a()\n  else:|\nend\n", None),
    ],
)
def test_a_clause(text, result):
    assert typed(text) == (text.replace("|", "") if result is None else result)
