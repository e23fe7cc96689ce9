"""Restores lost indentation, as of texts copied from PDF viewers and chat windows.

Such a text begins every line in column 1. Its `end`s still show which lines belong together, so the columns are
restored before the blocks are read, and the loss is reported once instead of at every header.
"""

from __future__ import annotations

from typing import Final

from elitescript.language.diagnostics import Fix
from elitescript.language.text.lexer import LogicalLine
from elitescript.language.text.masked import header_colon
from elitescript.language.text.rewriting import Draft
from elitescript.said import said

INDENT: Final = "  "

_DEEPEST: Final = 50
"""Deepest nesting that is restored; a text with more is not a program that lost its blanks."""

CLAUSES: Final = frozenset(("elif", "else", "except", "finally"))
_HEADERS: Final = frozenset(("if", "for", "while", "try", "with", "def", "class", "sec", "thread"))


def restore_indentation(draft: Draft) -> None:
    """Report a text without indentation, and give its lines the columns that their headers and `end`s imply."""
    lines = draft.lexed.lines
    if len(lines) < 2 or any(line.column for line in lines):
        return
    headers = [index for index, line in enumerate(lines) if _opens(draft, line)]
    with_body = [index for index in headers if index + 1 < len(lines) and not _closes(draft, lines[index + 1])]
    if not with_body or (len(headers) == 1 and not any(_is_end(draft, line) for line in lines)):
        return
    depths, is_certain = _depths(draft, lines)
    if max(depths) > _DEEPEST:
        return
    header, first = lines[with_body[0]], lines[with_body[0] + 1]
    fix = None
    hint = "indent the lines that belong to each header by two or four blanks"
    if is_certain:
        edits = [
            draft.edit(line.start, line.start, INDENT * depth)
            for line, depth in zip(lines, depths, strict=True)
            if depth
        ]
        fix = Fix("indent the lines as their `end`s say", tuple(edits), safe=True)
        hint = "indent the lines between each header and its `end` by two or four blanks"
    text = said(
        "the indentation is lost: every line begins in column 1, so nothing is inside the `{word}` of line {line}",
        word=header.word,
        line=header.line,
    )
    draft.report("E001", first.start, first.start + max(1, len(first.word)), text, hint, fix)
    for line, depth in zip(lines, depths, strict=True):
        if depth:
            line.column = len(INDENT) * depth
            draft.replace(line.start, line.start, INDENT * depth)


def _opens(draft: Draft, line: LogicalLine) -> bool:
    """Return whether the body of a line has to stand on the lines below it."""
    if line.word not in _HEADERS and line.word not in CLAUSES:
        return False
    code = draft.code(line)
    return header_colon(code) == len(code) - 1


def _is_end(draft: Draft, line: LogicalLine) -> bool:
    return line.word == "end" and draft.code(line).rstrip(" \t;") == "end"


def _closes(draft: Draft, line: LogicalLine) -> bool:
    return line.word in CLAUSES or _is_end(draft, line)


def _depths(draft: Draft, lines: list[LogicalLine]) -> tuple[list[int], bool]:
    """Return the depth of each line, and whether every block has its `end`, which leaves no other reading."""
    depths = []
    depth = 0
    is_certain = True
    for line in lines:
        if _is_end(draft, line):
            is_certain = is_certain and depth > 0
            depth = max(0, depth - 1)
            depths.append(depth)
        elif line.word in CLAUSES:
            is_certain = is_certain and depth > 0 and _opens(draft, line)
            depths.append(max(0, depth - 1))
        else:
            depths.append(depth)
            depth += _opens(draft, line)
    return depths, is_certain and depth == 0
