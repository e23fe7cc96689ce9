"""Programs that are read piece by piece: which pieces are used again, and when nothing is."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from elitescript.language.options import DEFAULT
from elitescript.language.parser import parse
from elitescript.language.text import pieces as pieces_module
from elitescript.language.text.pieces import Pieces
from elitescript.language.text.source import SourceFile

SPECIFICATION = Path(__file__).parent.parent / "spec"

TEXT = "def p():\n  a = 1\n  def f():\n    return 1\n  end\n  # next\n  def g(x):\n    return x\n  end\n  f()\nend\n"


def read(text: str, pieces: Pieces | None = None) -> ast.Module:
    return parse(SourceFile("a", text), DEFAULT, None, pieces).tree


def read_whole(text: str) -> ast.Module:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Pieces, "tree", lambda *_: None)
        return read(text)


def functions(tree: ast.Module) -> list[ast.FunctionDef]:
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]


def dump(tree: ast.Module) -> str:
    return ast.dump(tree, include_attributes=True)


def shared(before: str, after: str) -> list[str]:
    """Return the names of the functions whose trees are used again; the whole tree is the one of the text."""
    pieces = Pieces()
    old, new = read(before, pieces), read(after, pieces)
    assert dump(old) == dump(read_whole(before))
    assert dump(new) == dump(read_whole(after))
    return [node.name for node in functions(new) if node in functions(old)]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("a = 1", "a = 2", ["f", "g"]),
        ("return x", "return x + 1", ["f"]),
        ("return 1", "return f", ["g"]),
        ("# next\n", "# next\n\n", ["f"]),
        ("return x\n", "return x\n\n", ["f", "g"]),
        ("return x", "return (x", ["f"]),
        ("a = 1", "else:", ["f", "g"]),
        ("  def f", "  @x\n  def f", []),
        ("  # next", "  @x", []),
        ("  # next", "    \\", []),
        ("  # next", "  else:", ["g"]),
        ("def p", "sec p", ["f", "g"]),
        ("end\n  f()", "end\nf()", []),
        ("  def g", "\tdef g", ["f"]),
    ],
)
def test_what_is_used_again(old: str, new: str, expected: list[str]) -> None:
    assert shared(TEXT, TEXT.replace(old, new, 1)) == expected


def test_a_function_does_not_keep_a_decorator_of_the_version_before() -> None:
    assert shared(TEXT.replace("  # next", "  @x"), TEXT) == []


@pytest.mark.parametrize(
    ("old", "new"), [("  def g", "\n\n  def g"), ("def p():", "# one\n# two\ndef p():"), ("  a = 1\n", "")]
)
def test_pieces_may_stand_in_other_lines(old: str, new: str) -> None:
    pieces = Pieces(may_move=True)
    before, after = read(TEXT, pieces), TEXT.replace(old, new)
    tree = read(after, pieces)
    assert dump(tree) == dump(read_whole(after))
    assert [node.name for node in functions(tree) if node in functions(before)] == ["f", "g"]
    assert dump(read(TEXT, pieces)) == dump(read_whole(TEXT))


def test_a_piece_is_used_once_where_its_text_is_there_twice() -> None:
    pieces = Pieces(may_move=True)
    one = "  def f():\n    return 1\n  end\n"
    read(f"def p():\n{one}  x = 1\nend\n", pieces)
    after = f"def p():\n  # twice\n{one}{one}  x = 1\nend\n"
    assert dump(read(after, pieces)) == dump(read_whole(after))


@pytest.mark.parametrize("edit", ["", "\n", '$ LINE: (9, "new")\n', "$ LINE: (x)\n", "$ LINE: 3\n"])
@pytest.mark.parametrize("may_move", [True, False])
def test_line_marks_of_pieces_that_are_used_again_stay(edit: str, may_move: bool) -> None:
    marked = TEXT.replace("    return", '    $ LINE: (4, "in it")\n    return').replace(
        "  f()", '  $ LINE: (1, "a", "b")\n  f()'
    )
    pieces = Pieces(may_move=may_move)
    for text in (marked, marked.replace("  a = 1\n", f"  a = 1\n{edit and '  ' + edit}"), marked):
        assert dump(read(text, pieces)) == dump(read_whole(text))


def test_a_tree_without_pieces_is_never_shared() -> None:
    assert not set(functions(read(TEXT))) & set(functions(read(TEXT)))


STATEMENTS = "".join(f"  x = {n}\n  if x > {n}:\n    y = (1,\n     2)\n  else:\n    y = 3\n  end\n" for n in range(100))


def lines_of(tree: ast.Module) -> dict[int, ast.stmt]:
    [unit] = tree.body
    assert isinstance(unit, ast.FunctionDef)
    return {statement.lineno: statement for statement in unit.body}


def test_a_straight_text_is_read_in_pieces_and_those_that_stay_are_used_again() -> None:
    pieces = Pieces()
    before, after = (f"def p():\n{STATEMENTS.replace('x = 50', x)}end\n" for x in ("x = 50", "x = 51 + 1"))
    old, new = read(before, pieces), read(after, pieces)
    assert dump(new) == dump(read_whole(after))
    same = [line for line, statement in lines_of(new).items() if lines_of(old)[line] is statement]
    changed = sorted(lines_of(new).keys() - set(same))
    assert len(same) + len(changed) == 200
    assert 352 in changed and changed[-1] - changed[0] <= pieces_module.PIECE_LINES


def test_a_short_text_is_read_at_once() -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pieces_module, "_read", lambda *_, **__: pytest.fail("it is read in pieces"))
        read("def p():\n  x = 1\n  y = 2\nend\n")


@pytest.mark.parametrize("page", sorted(SPECIFICATION.glob("*.md")), ids=lambda page: page.stem)
def test_what_is_read_in_pieces_is_the_whole_text(page: Path) -> None:
    """Programs and scripts, right and wrong, with pieces as short as they can be."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pieces_module, "PIECE_LINES", 1)
        patch.setattr(pieces_module, "READ_LINES", 1)
        for text in re.findall("```elite[^\n]*\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
            assert dump(read(text)) == dump(read_whole(text)), text
