"""Finds what an editor can fold."""

from __future__ import annotations

import re
from collections.abc import Iterator
from enum import StrEnum
from typing import Final

from elitescript.assist.blocks import blocks
from elitescript.assist.document import Document
from elitescript.assist.outline import Symbol, SymbolKind, document_symbols
from elitescript.records import NamedTuple


class FoldKind(StrEnum):
    """What folds."""

    BLOCK = "block"
    COMMENT = "comment"
    IMPORTS = "imports"
    REGION = "region"
    """What is between fences: comments such as `# HEADER_BEGIN` and `# HEADER_END`, `# region` and `# endregion`."""
    NODE = "node"
    """What a `$ LINE` mark begins."""
    LINES = "lines"
    """A statement on several lines, such as a long list."""


class Fold(NamedTuple):
    """Lines that fold into the first one.

    Attributes:
        line: the line that stays.
        end_line: the last line that is hidden: of a block its `end`.
        kind: what it is.
    """

    line: int
    end_line: int
    kind: FoldKind


_FENCE: Final = re.compile(
    r"#+[ \t]*(?:"
    r"(?P<key>\S.*?)[ \t_:-]+(?P<word>BEGINS?|STARTS?|ENDS?|begins?|starts?|ends?)"
    r"|(?P<first>BEGIN|START|END|begin|start|end)[ \t_:]+(?P<title>\S.*?)"
    r"|(?P<region>(?:end)?region)\b.*"
    r")[ \t#-]*"
)
"""A comment that may be a fence; it is one if another comment closes it."""


def folding_ranges(document: Document) -> tuple[Fold, ...]:
    """Return what can be folded, in the order of the text. Never raises."""
    found = [*_blocks(document), *_comments(document), *_imports(document), *_nodes(document_symbols(document))]
    return tuple(sorted(fold for fold in dict.fromkeys(found) if fold.end_line > fold.line))


def _blocks(document: Document) -> Iterator[Fold]:
    headers = set()
    for block in blocks(document):
        headers.add(block.header)
        yield Fold(block.header.line, block.last_line, FoldKind.BLOCK)
    for line in document.translation.lines:
        if line.last_line > line.line and line not in headers:
            yield Fold(line.line, line.last_line, FoldKind.LINES)


def _comments(document: Document) -> Iterator[Fold]:
    """Yield blocks of comments, and what is between fences."""
    first = 0
    fences: list[tuple[str, int]] = []
    for number in range(1, document.line_count + 2):
        text = document.line(number).strip() if not document.code_line(number).strip() else ""
        fence = _FENCE.fullmatch(text) if text.startswith("#") else None
        if text.startswith("#") and fence is None:
            first = first or number
        elif first:
            yield Fold(first, number - 1, FoldKind.COMMENT)
            first = 0
        if fence is not None:
            yield from _fenced(fence, number, fences)


def _fenced(fence: re.Match[str], line: int, fences: list[tuple[str, int]]) -> Iterator[Fold]:
    key = (fence["key"] or fence["title"] or "").lower()
    word = (fence["word"] or fence["first"] or fence["region"]).lower()
    if not word.startswith("end"):
        fences.append((key, line))
        return
    for index in range(len(fences) - 1, -1, -1):
        if fences[index][0] == key:
            yield Fold(fences[index][1], line, FoldKind.REGION)
            del fences[index:]
            return


def _imports(document: Document) -> Iterator[Fold]:
    first = last = 0
    for line in (*document.translation.lines, None):
        if line is not None and line.word in ("import", "from"):
            first, last = first or line.line, line.last_line
        else:
            if last > first:
                yield Fold(first, last, FoldKind.IMPORTS)
            first = last = 0


def _nodes(symbols: tuple[Symbol, ...]) -> Iterator[Fold]:
    for symbol in symbols:
        if symbol.kind is SymbolKind.NODE:
            yield Fold(symbol.span.line, symbol.span.end_line, FoldKind.NODE)
        yield from _nodes(symbol.children)
