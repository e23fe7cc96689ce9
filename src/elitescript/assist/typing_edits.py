"""Sets indentation, and the `end` of a block, while somebody types."""

from __future__ import annotations

import re
from functools import cache
from typing import Final

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit
from elitescript.language.text.blocks import CLAUSES_OF
from elitescript.language.text.dialect import Translation
from elitescript.language.text.flat import CLAUSES, INDENT
from elitescript.language.text.lexer import LogicalLine
from elitescript.records import NamedTuple

TRIGGERS: Final = ("\n", "d", ":")
"""Characters after which `typing_edits` has something to say: a new line, the last one of `end`, of a clause."""


def typing_edits(document: Document, line: int, column: int, typed: str) -> tuple[Edit, ...]:
    """Return the edits that follow from a character that was typed.

    They refer to the text as it is after the character. A new line below a header gets the indentation of the body, and
    the block its `end`, if it has none and the program uses them; below another line, the indentation of that. `end`
    and the clauses of a statement go into the column of the block that they continue or close.

    Args:
        document: the text, with the character in it.
        line: where the cursor is, from 1.
        column: the same, from 1.
        typed: the character, one of `TRIGGERS`.
    """
    translation = document.translation
    if typed == "\n":
        return _new_line(document, translation, line)
    found = next((logical for logical in translation.lines if logical.line == line), None)
    if found is None or found.last_line != line or column <= found.column:
        return ()
    code = document.line(line).strip()
    word = code.partition(" ")[0].rstrip(":")
    if (typed == "d" and code == "end") or (typed == ":" and code.endswith(":") and word in CLAUSES):
        return _closing(document, translation, found, word)
    return ()


@cache
def _opener() -> re.Pattern[str]:
    return re.compile(r"(?:def|sec|if|for|while|with|try|class|match|async)\b")


def _new_line(document: Document, translation: Translation, line: int) -> tuple[Edit, ...]:
    above = [logical for logical in translation.lines if logical.line < line]
    if not above:
        return ()
    before = above[-1]
    if before.last_line != line - 1 or before.broken:
        # Behind a blank line, inside a bracket or a string the author decides.
        return ()
    header_ends = before in translation.headers and _ends_with_colon(document, before)
    column = before.column + (len(INDENT) if header_ends else 0)
    row = document.line(line)
    blank = row[: len(row) - len(row.lstrip())]
    wanted = " " * column if header_ends or not row.strip() else blank
    edits = []
    if header_ends and not row.strip() and _wants_end(document, translation, before, line):
        end = " " * before.column + "end"
        if line == document.line_count:
            return (Edit(line, 1, line, len(blank) + 1, f"{wanted}\n{end}"),)
        # At the start of the next line, so that the cursor stays where it is.
        edits.append(Edit(line + 1, 1, line + 1, 1, f"{end}\n"))
    if blank != wanted:
        edits.insert(0, Edit(line, 1, line, len(blank) + 1, wanted))
    return tuple(edits)


def _ends_with_colon(document: Document, line: LogicalLine) -> bool:
    return document.source.text[line.start : line.end].endswith(":")


def _wants_end(document: Document, translation: Translation, header: LogicalLine, line: int) -> bool:
    """Return whether a header opens a block that has no body and no `end` yet, in a program that closes its blocks."""
    if not _opener().match(document.source.text, header.start):
        return False
    below = next((logical for logical in translation.lines if logical.line >= line), None)
    if below is not None and (
        below.column > header.column or (below.column == header.column and below.word in (*CLAUSES, "end"))
    ):
        return False
    others = [end for end in translation.ends if end.opener is not header and end.outer]
    return not others or any(end.has_end for end in others)


class _Open(NamedTuple):
    column: int
    word: str


def _closing(document: Document, translation: Translation, closer: LogicalLine, word: str) -> tuple[Edit, ...]:
    """Move `end` or a clause to the innermost block that it can close or continue, unless it stands at one."""
    blocks: list[_Open] = []
    for line in translation.lines:
        if line is closer:
            break
        while blocks and blocks[-1].column > line.column:
            blocks.pop()
        if blocks and blocks[-1].column == line.column and line.word not in CLAUSES:
            # What closes it is this line, whatever it is.
            blocks.pop()
        if line in translation.headers and line.word not in CLAUSES and _ends_with_colon(document, line):
            blocks.append(_Open(line.column, line.word))
    if word in CLAUSES:
        blocks = [block for block in blocks if word in CLAUSES_OF.get(block.word, ())]
    if not blocks or any(block.column == closer.column for block in blocks):
        return ()
    return (Edit(closer.line, 1, closer.line, _first(document, closer), " " * blocks[-1].column),)


def _first(document: Document, line: LogicalLine) -> int:
    row = document.line(line.line)
    return len(row) - len(row.lstrip()) + 1
