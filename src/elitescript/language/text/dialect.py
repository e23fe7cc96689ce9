"""Translates EliteScript to Python text, line by line.

EliteScript is Python with three additions: `end` on a line of its own closes a block, `sec` in
place of `def` makes a secondary program, and `$ LINE: (n, "label")` marks a node of the pendant's
program tree. `translate` replaces them, and remains of Python 2 and other languages, without
adding or removing a line. Where a replacement changes columns, `Translation.positions` maps back.
"""

from __future__ import annotations

import re
from functools import cache

from elitescript.language.advice.foreign import read_foreign
from elitescript.language.advice.python2 import read_escapes
from elitescript.language.diagnostics import Diagnostic, diagnostic
from elitescript.language.options import DEFAULT, LINE, Options
from elitescript.language.text.blocks import read_blocks
from elitescript.language.text.flat import CLAUSES, INDENT
from elitescript.language.text.lexer import Lexed, LogicalLine
from elitescript.language.text.masked import lex
from elitescript.language.text.rewriting import BlockEnd, Draft, PositionMap, Unfolding
from elitescript.language.text.source import SourceFile
from elitescript.records import NamedTuple
from elitescript.said import said


class Translation(NamedTuple):
    """A text as Python sees it.

    Attributes:
        text: Python text with the same number of lines (an unfolded single line has more).
        positions: the author's positions.
        diagnostics: what was found.
        lines: the logical lines; offsets are those of the author's text.
        headers: the lines that open a block or a clause.
        ends: where blocks end.
        broken: lines with mistakes, which Python's parser must not read.
        dropped: lines that stand outside every block.
        marks: (line, column) of the line marks.
        secondaries: lines of the `sec` headers.
        masked: the author's text without what is in strings and comments; see `lexer`.
    """

    text: str
    positions: PositionMap
    diagnostics: tuple[Diagnostic, ...]
    lines: tuple[LogicalLine, ...]
    headers: frozenset[LogicalLine]
    ends: tuple[BlockEnd, ...]
    broken: frozenset[LogicalLine]
    dropped: frozenset[LogicalLine]
    marks: frozenset[tuple[int, int]]
    secondaries: frozenset[int]
    masked: str


def translate(source: SourceFile, options: Options = DEFAULT) -> Translation:
    """Rewrite a text as Python. Never raises: mistakes are among the diagnostics."""
    folded: list[Diagnostic] = []
    unfolding = None
    lexed = lex(source.text)
    if options.one_line_blocks and options.kind == LINE and len(lexed.lines) == 1:
        unfolded = _unfold(source, lexed, folded)
        if unfolded:
            text, unfolding = unfolded
            lexed = lex(text)
    draft = Draft(source, lexed, options, unfolding)
    for flaw in lexed.flaws:
        draft.report("E001", flaw.start, flaw.end, flaw.text, flaw.hint)
    if lexed.wide_signs:
        from elitescript.language.advice.typed_signs import read_wide_signs

        read_wide_signs(draft)
    read_blocks(draft)
    if not lexed.text.isascii():
        from elitescript.language.advice.saved_as import read_gbk_by_chance

        read_gbk_by_chance(draft)
    if "$" in lexed.masked:
        _marks(draft)
    read_foreign(draft)
    read_escapes(draft)
    text, positions = draft.finish()
    return Translation(
        text,
        positions,
        (*folded, *draft.diagnostics),
        tuple(lexed.lines),
        frozenset(draft.headers),
        tuple(draft.ends),
        frozenset(draft.broken.union(line for line in lexed.lines if line.broken)),
        frozenset(draft.dropped),
        frozenset(draft.marks),
        frozenset(draft.secondaries),
        lexed.masked,
    )


@cache
def _mark() -> re.Pattern[str]:
    return re.compile(r"(?:^|(?<=[;:]))[ \t]*(\$[ \t]*LINE[ \t]*:)(?=[ \t]*\()")


def _marks(draft: Draft) -> None:
    """Rewrite line marks as calls; the name is a filler that the parser replaces."""
    for line in draft.lexed.lines:
        code = draft.code(line)
        if "$" not in code or line.broken or line in draft.dropped:
            continue
        for found in _mark().finditer(code):
            start, end = line.start + found.start(1), line.start + found.end(1)
            draft.marks.add(draft.place(start))
            draft.replace(start, end, "_" * (end - start))


def _unfold(source: SourceFile, lexed: Lexed, problems: list[Diagnostic]) -> tuple[str, Unfolding] | None:
    """Write `def f(): ; a() ; end` in several lines; None if there is no such block."""
    line = lexed.lines[0]
    masked = lexed.masked
    if line.broken or line.last_line != line.line:
        return None
    pieces = _pieces(masked, line)
    if not any(masked[start:end].endswith(":") for start, end in pieces):
        return None
    first = lexed.starts[line.line - 1]
    rows = []
    offsets = []
    open_headers: list[tuple[int, int]] = []
    for start, end in pieces:
        code = masked[start:end]
        closes = code == "end"
        clause = code.partition(" ")[0].rstrip(":") in CLAUSES
        indentation = INDENT * max(0, len(open_headers) - (closes or clause))
        rows.append(indentation + source.text[start:end])
        offsets.append(start - first - len(indentation))
        if closes and open_headers:
            open_headers.pop()
        elif code.endswith(":") and not (clause and open_headers):
            open_headers.append((start, end))
    for start, end in open_headers:
        row, column = lexed.place(start)
        text = said("this `{word}` has no `end`", word=masked[start:end].partition(" ")[0].rstrip(":"))
        hint = "in a single line every block needs its `end`"
        problems.append(diagnostic("E102", row, column, text, end_column=column + end - start, hint=hint))
    return "\n".join(rows), Unfolding(line.line, tuple(offsets))


def _pieces(masked: str, line: LogicalLine) -> list[tuple[int, int]]:
    """Return (start, end) of what stands between the semicolons of a line, without blanks around it."""
    pieces = []
    depth = 0
    begin = line.start
    for index in range(line.start, line.end + 1):
        character = masked[index] if index < line.end else ";"
        if character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        elif character == ";" and depth == 0:
            piece = masked[begin:index]
            if piece.strip():
                start = begin + len(piece) - len(piece.lstrip())
                pieces.append((start, start + len(piece.strip())))
            begin = index + 1
    return pieces
