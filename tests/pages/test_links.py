"""Every link between pages leads to a file and a heading that are there, and every page can be reached."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tools.pages import ROOT, own_pages, read_page

PAGES = {path: read_page(path.read_text(encoding="utf-8")) for path in own_pages()}
ELSEWHERE = ("http:", "https:", "mailto:")


def by_name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def broken_links(path: Path) -> list[str]:
    """List the links of a page that lead nowhere."""
    found = []
    for link in PAGES[path].links():
        if link.target.startswith(ELSEWHERE):
            continue
        name, _, anchor = link.target.partition("#")
        target = (path.parent / name).resolve() if name else path
        where = f"{by_name(path)}:{link.line}: {link.target}"
        if not target.exists():
            found.append(f"{where}: there is no such file")
        elif not target.is_relative_to(ROOT):
            found.append(f"{where}: outside the repository")
        elif anchor and (target not in PAGES or anchor not in PAGES[target].anchors()):
            found.append(f"{where}: there is no such heading")
    return found


@pytest.mark.parametrize("path", PAGES, ids=by_name)
def test_every_link_leads_somewhere(path: Path) -> None:
    assert broken_links(path) == []


def test_every_page_of_docs_can_be_reached_from_the_first_one() -> None:
    docs = {path for path in PAGES if path.is_relative_to(ROOT / "docs")}
    reached: set[Path] = set()
    left = [ROOT / "docs" / "index.md"]
    while left:
        page = left.pop()
        if page in reached or page not in docs:
            continue
        reached.add(page)
        names = [link.target.partition("#")[0] for link in PAGES[page].links()]
        left += [(page.parent / name).resolve() for name in names if name.endswith(".md") and ":" not in name]
    assert sorted(map(by_name, docs - reached)) == []


def test_every_index_lists_its_own_pages() -> None:
    for index in (path for path in PAGES if path.name == "index.md"):
        listed = {link.target for link in PAGES[index].links()}
        beside = {path.name for path in PAGES if path.parent == index.parent} - {"index.md"}
        below = {
            f"{path.parent.name}/index.md"
            for path in PAGES
            if path.name == "index.md" and path.parent.parent == index.parent
        }
        assert sorted((beside | below) - listed) == [], by_name(index)


def test_every_page_has_one_title_in_its_first_line() -> None:
    docs = {path: page for path, page in PAGES.items() if path.is_relative_to(ROOT / "docs")}
    for path, page in docs.items():
        titles = [line for _, _, line in page.prose if line.startswith("# ")]
        assert len(titles) == 1, by_name(path)
        assert page.text.startswith("# "), by_name(path)


def test_every_page_that_a_text_of_the_program_names_is_there() -> None:
    files = [
        *(ROOT / "src").rglob("*.py"),
        *(ROOT / "tools").rglob("*.py"),
        *(path for path in (ROOT / "examples").iterdir() if path.is_file()),
        ROOT / "Makefile",
    ]
    named = {
        (by_name(path), name)
        for path in files
        for name in re.findall(r"\bdocs/[\w/-]+\.md\b", path.read_text(encoding="utf-8"))
    }
    assert len(named) > 5
    assert sorted(f"{path}: {name}" for path, name in named if not (ROOT / name).exists()) == []
