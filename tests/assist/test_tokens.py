"""What names are, for their colours."""

from __future__ import annotations

import pytest

from elitescript.assist.document import Document, Settings
from elitescript.assist.tokens import TOKEN_MODIFIERS, TOKEN_TYPES, semantic_tokens
from elitescript.lint.program import Span
from elitescript.messages.profile import PROFILES


def shown(document: Document, line: int) -> list[str]:
    """Return `text type modifiers` of the tokens of a line."""
    return [
        " ".join((document.line(line)[token.column - 1 :][: token.length], token.type, *token.modifiers))
        for token in semantic_tokens(document)
        if token.line == line
    ]


@pytest.mark.parametrize(
    ("text", "line", "expected"),
    [
        ("movej(q)\n", 1, ["movej command defaultLibrary"]),
        ("def job():\n  pass\nend\n", 1, ["job function definition"]),
        ("def job():\n  pass\nend\n", 3, ["end keyword"]),
        ("sec go():\n  pass\nend\n", 1, ["sec keyword", "go function definition"]),
        ("def job():\n  global a\n  a = f()\nend\n", 2, ["a variable global"]),
        (
            "def job():\n  global a\n  a = len(a)\nend\n",
            3,
            ["a variable modification global", "len function defaultLibrary", "a variable global"],
        ),
        ("def job():\n  a = 5\nend\n", 2, ["a variable modification unused readonly"]),
        ("def job():\n  a = 5\n  def f(): return a\n  f()\nend\n", 2, ["a variable modification captured readonly"]),
        ("def job():\n  a = 5\n  textmsg([a for b in (1,)])\nend\n", 2, ["a variable modification readonly"]),
        (
            "def f(n, m):\n  return n\nend\n",
            1,
            ["f function definition", "n parameter definition", "m parameter definition unused"],
        ),
        ("def f():\n  pass\nend\nstart_thread(f, ())\n", 1, ["f function definition thread"]),
        (
            "import math\nx = math.sin(math.pi)\n",
            2,
            [
                "x variable modification readonly",
                "math namespace defaultLibrary",
                "sin function defaultLibrary",
                "math namespace defaultLibrary",
                "pi property defaultLibrary",
            ],
        ),
        (
            "class A:\n  v = 1\n  def f(self): return self.v\nend\n",
            3,
            ["f method definition", "self parameter definition", "self parameter", "v property"],
        ),
        (
            "try:\n  pass\nexcept ValueError as e:\n  pass\nend\n",
            3,
            ["ValueError class defaultLibrary", "e variable modification"],
        ),
        ('socket_open("1.2.3.4", 80, "cam")\n', 1, ["socket_open command defaultLibrary", "cam signal modification"]),
        ('$ LINE: (1, "x")\n', 1, ["$ LINE keyword"]),
        ("x = 'é' + nowhere\n", 1, ["x variable modification"]),
        ("def f(a): return a\nf(a=1)\n", 2, ["f function", "a parameter"]),
        # A script may be a part of a longer program: nothing is certain about what reads its names.
        ("a = 5\n", 1, ["a variable modification readonly"]),
    ],
)
def test_tokens_of_a_line(text: str, line: int, expected: list[str]) -> None:
    assert shown(Document("cell.script", text), line) == expected


def test_what_the_firmware_lacks_and_what_comes_from_outside() -> None:
    oldest = min(PROFILES.values(), key=lambda profile: profile.release)
    document = Document("c", "movel(speed)\nend_force_mode()\n", 1, Settings(oldest, presets=frozenset(("speed",))))
    assert shown(document, 1) == ["movel command defaultLibrary", "speed variable global"]
    assert shown(document, 2) == ["end_force_mode command defaultLibrary unavailable"]
    assert shown(Document("c", document.text), 2) == ["end_force_mode command defaultLibrary"]


def test_a_range_has_the_tokens_of_its_lines() -> None:
    document = Document("cell.script", "a = 1\nb = 2\nc = 3\n")
    assert [token.line for token in semantic_tokens(document, Span(2, 3, 3, 1))] == [2, 3]


def test_the_legend_does_not_change_its_order() -> None:
    # Clients keep the legend of the start of a session.
    assert TOKEN_TYPES == (
        "command",
        "function",
        "class",
        "method",
        "parameter",
        "variable",
        "property",
        "namespace",
        "keyword",
        "signal",
    )
    assert TOKEN_MODIFIERS == (
        "definition",
        "modification",
        "captured",
        "global",
        "defaultLibrary",
        "unused",
        "unavailable",
        "thread",
        "readonly",
    )
