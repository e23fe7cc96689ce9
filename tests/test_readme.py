"""The README is short, says the same in both languages, and its numbers are those of the product.

That its code runs and its links lead somewhere is tested with the other pages, in `tests/pages`.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from elitescript.commands.catalogue import CATALOGUE
from tools.plot_picture import LARGEST, PICTURE

ROOT = Path(__file__).resolve().parent.parent
ENGLISH = (ROOT / "README.md").read_text(encoding="utf-8")
CHINESE = (ROOT / "README.zh.md").read_text(encoding="utf-8")
SIMULATED = (ROOT / "docs" / "explanation" / "simulated.md").read_text(encoding="utf-8")
WORDS_MAX = 900
"""As `wc -w README.md` counts."""


def blocks(text: str) -> list[str]:
    """Return the fenced blocks of a page, each with its first line."""
    return re.findall(r"^```.*?^```$", text, re.DOTALL | re.MULTILINE)


def prose(text: str) -> str:
    return re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)


def links(text: str) -> list[str]:
    """Return the targets of links and pictures in their order, without the link to the other language.

    A Chinese page counts as the English one that it translates.
    """
    targets = re.findall(r"\]\(([^)]+)\)", prose(text))
    return [target.replace(".zh.md", ".md") for target in targets if not target.startswith("README")]


def commands(text: str) -> list[str]:
    """Return the commands within sentences, sorted: the order of words differs between languages."""
    return sorted(re.findall(r"`((?:elitescript|make|pip) [^`]+)`", prose(text)))


def test_the_readme_is_short() -> None:
    assert len(ENGLISH.split()) <= WORDS_MAX


@pytest.mark.parametrize("part", [blocks, links, commands], ids=["blocks", "links", "commands"])
def test_both_languages_have_the_same(part) -> None:
    assert len(part(ENGLISH)) > 3
    assert part(CHINESE) == part(ENGLISH)


def test_both_languages_have_the_same_headings_and_rows() -> None:
    def shape(text: str) -> list[str]:
        return re.findall(r"^(#+ |\||- )", prose(text), re.MULTILINE)

    assert shape(CHINESE) == shape(ENGLISH)


def test_each_language_links_to_the_other() -> None:
    assert "[中文](README.zh.md)" in ENGLISH
    assert "[English](README.md)" in CHINESE


@pytest.mark.parametrize("text", [ENGLISH, CHINESE, SIMULATED], ids=["English", "Chinese", "what is simulated"])
def test_the_number_of_commands_is_true(text: str) -> None:
    numbers = re.findall(r"\b(\d{3}) (?:commands|条指令)", text)
    assert numbers == [str(len(CATALOGUE))]


def test_pictures_are_small() -> None:
    sizes = {path.name: path.stat().st_size for path in PICTURE.parent.glob("*.png")}
    assert PICTURE.name in sizes
    assert [name for name, size in sizes.items() if size > LARGEST] == []
