"""Findings as editors show them."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from elitescript.assist.diagnostics import RULES_PAGE, TAGS, Tag, diagnostics
from elitescript.assist.document import Document, Settings
from elitescript.errors import CODES
from elitescript.lint.engine import check_source
from tests.language.test_invariants import PROGRAMS

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("text", [*PROGRAMS, "def job():\n  x =\nend\n", "movej(1)\n", "\x00 = (", ""])
def test_they_are_those_of_check(text: str) -> None:
    for settings in (Settings(), Settings(strict=True)):
        document = Document("cell.script", text, 1, settings)
        expected = check_source(document.source, settings.profile, strict=settings.strict)
        assert tuple(item.diagnostic for item in diagnostics(document)) == expected
        # Asking for anything else before does not change them, and they leave the tree as it is.
        other = Document("cell.script", text, 2, settings)
        before = [item.span for item in other.names.occurrences]
        assert tuple(item.diagnostic for item in diagnostics(other)) == expected
        assert [item.span for item in type(other.names)(other.program).occurrences] == before


@pytest.mark.parametrize(
    ("text", "code", "tag"),
    [
        ("def job():\n  return\n  sleep(1)\nend\n", "W207", Tag.UNNECESSARY),
        ("def job():\n  x = 1\n  x == 2\nend\n", "W218", Tag.UNNECESSARY),
        ("print 1\n", "E106", Tag.DEPRECATED),
        ("x = 5L\n", "E110", Tag.DEPRECATED),
        ("x = raw_input()\n", "W209", Tag.DEPRECATED),
    ],
)
def test_tags(text: str, code: str, tag: Tag) -> None:
    found = {item.diagnostic.code: item.tags for item in diagnostics(Document("cell.script", text))}
    assert found[code] == (tag,)


def test_tagged_codes_exist() -> None:
    assert TAGS.keys() <= CODES.keys()


def test_the_hint_and_other_lines_are_related() -> None:
    document = Document("cell.script", "def job():\n  if True:\n    x = 1\n  end\n  else:\n    x = 2\n  end\nend\n")
    (problem,) = (item for item in diagnostics(document) if item.diagnostic.code == "E103")
    hint, line = problem.related
    assert hint.span == (5, 3, 5, 7)
    assert hint.text == f"hint: {problem.diagnostic.hint}"
    assert (line.span, line.text) == ((4, 3, 4, 6), "line 4: end")
    assert problem.page == f"{RULES_PAGE}#e103"


def test_the_page_is_in_the_repository() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    home, _, path = RULES_PAGE.partition("/blob/main/")
    assert home == project["urls"]["Homepage"]
    text = (ROOT / path).read_text(encoding="utf-8")
    assert "\n## W204\n" in text
