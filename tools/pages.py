"""Read the Markdown of pages: blocks of code, links, and the anchors of headings as GitHub names them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parent.parent

_FENCE: Final = re.compile(r"^( *)(`{3,}|~{3,})(.*)$")
_INLINE_CODE: Final = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)")
_LINK: Final = re.compile(r"\]\(<?([^()\s<>]*(?:\([^()\s]*\)[^()\s<>]*)*)>?(?: \"[^\"]*\")?\)")
_DEFINITION: Final = re.compile(r"^ {0,3}\[[^\]]+\]: *<?([^\s<>]+)>?")
_ATTRIBUTE: Final = re.compile(r"\b(?:href|src)=\"([^\"]*)\"")
_HEADING: Final = re.compile(r"^ {0,3}#{1,6} +(.*?)(?: +#+)? *$")
_ID: Final = re.compile(r"\bid=\"([^\"]*)\"")
_WORD: Final = re.compile(r'([\w-]+)(?:="([^"]*)"|=(\S+))?')


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block.

    Args:
        line: of its opening fence, from 1.
        language: first word behind the fence; empty without one.
        words: the other words; one without a value has the value "".
        text: its lines without the indentation of the fence, each with its line end.
    """

    line: int
    language: str
    words: dict[str, str]
    text: str


@dataclass(frozen=True, slots=True)
class Link:
    """The target of a link or picture, and where it stands.

    Args:
        line: number, from 1.
        start: index of the target's first character in the text of the page.
        target: as written.
    """

    line: int
    start: int
    target: str


@dataclass(frozen=True, slots=True)
class Page:
    """A page, cut into what is code and what is not.

    Args:
        text: all of it.
        blocks: its fenced blocks in order.
        prose: number, index of the first character and text of each line outside of blocks, code spans blanked.
    """

    text: str
    blocks: tuple[Block, ...]
    prose: tuple[tuple[int, int, str], ...]

    def links(self) -> Iterator[Link]:
        """Find the targets of links, pictures and link definitions."""
        for number, start, line in self.prose:
            for pattern in (_LINK, _DEFINITION, _ATTRIBUTE):
                for found in pattern.finditer(line):
                    yield Link(number, start + found.start(1), found.group(1))

    def indented_code(self) -> list[int]:
        """Find the first line of each block of code that is indented instead of fenced."""
        found, previous, in_list, in_code = [], "", False, False
        for number, _, line in self.prose:
            if line.strip():
                is_indented = line.startswith("    ")
                starts_item = re.match(r" *([-*+]|\d+[.)]) ", line) is not None
                if not is_indented:
                    in_list = starts_item or (in_list and bool(previous.strip() or line.startswith(" ")))
                if is_indented and not in_list and not in_code and not previous.strip():
                    found.append(number)
                    in_code = True
                elif not is_indented:
                    in_code = False
            previous = line
        return found

    def anchors(self) -> set[str]:
        """List what a link may name behind `#`: headings and elements with an id."""
        found: set[str] = set()
        lines = self.text.split("\n")
        for number, _, line in self.prose:
            heading = _HEADING.match(lines[number - 1])
            if heading is not None and line.strip():
                slug = github_slug(heading.group(1))
                again = 0
                while (name := f"{slug}-{again}" if again else slug) in found:
                    again += 1
                found.add(name)
            found.update(_ID.findall(line))
        return found


def read_page(text: str) -> Page:
    """Cut the text of a page into blocks and prose.

    Raises:
        ValueError: a fence that is not closed.
    """
    blocks: list[Block] = []
    prose: list[tuple[int, int, str]] = []
    start = 0
    opened: tuple[int, str, str, str] | None = None
    body: list[str] = []
    for number, line in enumerate(text.split("\n"), start=1):
        fence = _FENCE.match(line)
        if opened is not None:
            first, indent, marks, info = opened
            if fence is not None and fence.group(2).startswith(marks) and not fence.group(3).strip():
                language, _, rest = info.strip().partition(" ")
                words = {found.group(1): found.group(2) or found.group(3) or "" for found in _WORD.finditer(rest)}
                blocks.append(Block(first, language, words, "".join(body)))
                opened, body = None, []
            else:
                body.append(line.removeprefix(indent) + "\n")
        elif fence is not None and "`" not in fence.group(3):
            opened = (number, *fence.groups())
        else:
            prose.append((number, start, _INLINE_CODE.sub(lambda code: "`" * len(code.group()), line)))
        start += len(line) + 1
    if opened is not None:
        raise ValueError(f"line {opened[0]}: a block that is not closed")
    return Page(text, tuple(blocks), tuple(prose))


def github_slug(title: str) -> str:
    """Name the anchor of a heading as GitHub does."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title)
    return re.sub(r"[^\w\- ]", "", plain.lower()).strip().replace(" ", "-")


def own_pages() -> list[Path]:
    """List the pages whose links are checked: docs, the specification and the pages at the root."""
    return sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "tests" / "spec").glob("*.md")])
