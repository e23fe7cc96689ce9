"""Lists the blocks of a text, also of one that Python cannot read."""

from __future__ import annotations

from typing import Final

from elitescript.assist.document import Document
from elitescript.language.text.lexer import LogicalLine
from elitescript.records import NamedTuple

_CLAUSES: Final = frozenset(("elif", "else", "except", "finally"))


class Block(NamedTuple):
    """A block, or a clause of a statement with several.

    Attributes:
        word: the keyword of its header, or of its clause.
        header: its header.
        last_body_line: the last line of its body.
        last_line: the line of its `end`; `last_body_line` if it has none, or if another clause follows.
        is_clause: it continues a statement: `else`, `except`.
    """

    word: str
    header: LogicalLine
    last_body_line: int
    last_line: int
    is_clause: bool


def blocks(document: Document) -> tuple[Block, ...]:
    """Return the blocks whose bodies have lines of their own, in the order of their headers."""
    return document.once(_blocks)


def _blocks(document: Document) -> tuple[Block, ...]:
    translation = document.translation
    ends = {found.opener: found for found in translation.ends}
    headers = sorted(translation.headers, key=lambda line: line.line)
    found: list[Block] = []
    # The statements around the header that is read, each with the headers of its clauses.
    open_ones: list[tuple[LogicalLine, int, int, list[LogicalLine]]] = []

    def close() -> None:
        _, last_body, last, clauses = open_ones.pop()
        for index, header in enumerate(clauses):
            ends_itself = index + 1 == len(clauses)
            body = last_body if ends_itself else clauses[index + 1].line - 1
            found.append(Block(header.word, header, body, last if ends_itself else body, index > 0))

    for header in headers:
        while open_ones and header.line > open_ones[-1][1]:
            close()
        is_clause = header.word in _CLAUSES and bool(open_ones) and open_ones[-1][0].column == header.column
        if is_clause:
            open_ones[-1][3].append(header)
        elif header in ends:
            end = ends[header]
            last_body = max(end.last.last_line, header.last_line)
            last = end.follower.line if end.has_end and end.follower is not None else last_body
            open_ones.append((header, last_body, max(last, last_body), [header]))
    while open_ones:
        close()
    return tuple(sorted(found, key=lambda block: block.header.line))
