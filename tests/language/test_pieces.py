"""Programs that are read piece by piece: which pieces are used again, and when nothing is."""

from __future__ import annotations

import ast

import pytest

from elitescript.language.options import DEFAULT
from elitescript.language.parser import parse
from elitescript.language.text.pieces import Pieces
from elitescript.language.text.source import SourceFile

TEXT = "def p():\n  a = 1\n  def f():\n    return 1\n  end\n  # next\n  def g(x):\n    return x\n  end\n  f()\nend\n"


def read(text: str, pieces: Pieces | None = None) -> ast.Module:
    return parse(SourceFile("a", text), DEFAULT, None, pieces).tree


def functions(tree: ast.Module) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def dump(tree: ast.Module) -> str:
    return ast.dump(tree, include_attributes=True)


def shared(before: str, after: str) -> list[str]:
    """Return the names of the functions whose trees are used again; the whole tree is the one of the text."""
    pieces = Pieces()
    old, new = read(before, pieces), read(after, pieces)
    assert dump(old) == dump(read(before))
    assert dump(new) == dump(read(after))
    return [node.name for node in functions(new) if node in functions(old)]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("a = 1", "a = 2", ["f", "g"]),
        ("return x", "return x + 1", ["f"]),
        ("return 1", "return f", ["g"]),
        ("# next\n", "# next\n\n", []),
        ("return x\n", "return x\n\n", ["f"]),
        ("return x", "return (x", ["f"]),
        ("a = 1", "else:", ["f", "g"]),
        ("  def f", "  @x\n  def f", []),
        ("  # next", "  @x", []),
        ("  # next", "    \\", []),
        ("  # next", "  else:", ["g"]),
        ("def p", "sec p", []),
        ("end\n  f()", "end\nf()", []),
        ("  def g", "\tdef g", []),
    ],
)
def test_what_is_used_again(old: str, new: str, expected: list[str]) -> None:
    assert shared(TEXT, TEXT.replace(old, new, 1)) == expected


def test_a_function_does_not_keep_a_decorator_of_the_version_before() -> None:
    assert shared(TEXT.replace("  # next", "  @x"), TEXT) == []


def test_a_tree_without_pieces_is_never_shared() -> None:
    assert not set(functions(read(TEXT))) & set(functions(read(TEXT)))
