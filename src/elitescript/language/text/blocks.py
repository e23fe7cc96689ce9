"""Reads the block structure of a text: indentation, clauses, `end`, `sec`.

Python's own tokenizer does not know `end`, and its messages about indentation depend on its
version, so the structure is read here, from the logical lines alone. Afterwards no `end` is
left, and Python sees blocks that are complete, even where the author's were not.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Final

from elitescript.language.diagnostics import Fix
from elitescript.language.options import LINE
from elitescript.language.text.flat import CLAUSES, restore_indentation
from elitescript.language.text.lexer import LogicalLine, name_pattern
from elitescript.language.text.masked import header_colon
from elitescript.language.text.rewriting import BlockEnd, Draft
from elitescript.said import said

CLAUSES_OF: Final = {
    "if": ("elif", "else"),
    "for": ("else",),
    "while": ("else",),
    "async": ("else",),
    "try": ("except", "else", "finally"),
}
"""By the word of a statement, the clauses that it may have."""
_COMPOUND = CLAUSES.union(("if", "for", "while", "try", "with", "def", "class"))
_SOFT_COMPOUND = frozenset(("async", "case", "match", "sec", "thread"))


def read_blocks(draft: Draft) -> None:
    """Check the structure, replace `end` and `sec`, and note headers and ends in `draft.headers` and `draft.ends`."""
    restore_indentation(draft)
    _BlockReader(draft).read()


@cache
def _end() -> re.Pattern[str]:
    return re.compile(r"end[ \t]*;?")


@cache
def _soft_header(name: str) -> re.Pattern[str]:
    return re.compile(rf"(?:sec|thread)[ \t]+{name}[ \t]*\(|async[ \t]+(?:def|for|with)\b")


class _Block:
    __slots__ = ("clauses", "colon_missing", "column", "has_lines", "header", "label", "opener", "waits", "word")

    def __init__(self, opener: LogicalLine, word: str) -> None:
        self.opener = opener
        self.header = opener
        """Its newest header: the opener, or the last clause."""
        self.word = word
        self.label = ""
        """What messages call its newest header."""
        self.has_lines = False
        """A body of it begins on the line below its header."""
        self.column = opener.column
        self.waits = False
        """Its header was the last line, and the body has still to come."""
        self.colon_missing = False
        self.clauses: list[str] = []


class _BlockReader:
    __slots__ = ("blocks", "closed", "draft", "indents", "last", "left", "lost", "skip_above", "skipping_at", "waiting")

    def __init__(self, draft: Draft) -> None:
        self.draft = draft
        self.blocks: list[_Block] = []
        self.indents = [0]
        self.waiting: _Block | None = None
        self.closed: tuple[_Block, LogicalLine] | None = None
        """The block that `end`, as the last logical line, closed."""
        self.left: dict[int, tuple[_Block, LogicalLine]] = {}
        """By column, the block that was left last, and the line that left it."""
        self.lost: dict[int, int] = {}
        """By column, how many blocks never got their body; their `end` is not a second mistake."""
        self.last: LogicalLine | None = None
        """The line before the one that is being read."""
        self.skip_above = -1
        self.skipping_at = -1

    def read(self) -> None:
        lines = self.draft.lexed.lines
        last = len(lines) - 1
        for index, line in enumerate(lines):
            following = lines[index + 1] if index < last else line
            deeper_follows = following.column > line.column
            if self._skipped(line, deeper_follows):
                continue
            if self._is_out_of_place(line, following):
                self._report_orphan(line)
                self.draft.dropped.add(line)
            elif line.word == "end" and _end().fullmatch(self.draft.code(line)):
                self._end(line, following.word in CLAUSES and following.column == line.column)
            elif self._indent(line, deeper_follows):
                self._line(line, deeper_follows)
            self.last = line
        while self.blocks:
            self._close(self.blocks.pop(), None)

    # Indentation

    def _skipped(self, line: LogicalLine, deeper_follows: bool) -> bool:
        if self.skip_above < 0:
            return False
        is_inside = line.column > self.skip_above or line.column == self.skipping_at
        if is_inside and line.column not in self.indents:
            self.draft.dropped.add(line)
            return True
        self.skip_above = self.skipping_at = -1
        return False

    def _indent(self, line: LogicalLine, deeper_follows: bool) -> bool:
        """Follow the indentation; False if the line is not where any block is."""
        column, indents = line.column, self.indents
        if self.waiting and column > self.waiting.column:
            indents.append(column)
            return True
        if column > indents[-1]:
            self._unexpected(line)
            return False
        if column not in indents:
            text = said("the indentation of {column} goes back to no earlier line", column=column)
            hint = said("use one of the indentations above it: {indents}", indents=", ".join(map(str, indents)))
            self.draft.report("E001", line.start, line.start + 1, text, _TAB_HINT if self._has_tab(line) else hint)
            self._skip(line, line.column)
            return False
        while indents[-1] > column:
            indents.pop()
        return True

    def _unexpected(self, line: LogicalLine) -> None:
        if self.closed:
            block, end = self.closed
            text = said(
                "this line is indented like the body of the {label}, but `end` in line {line} closed that",
                label=block.label,
                line=end.line,
            )
            hint = "move the `end` behind it, or indent it like the `end`"
        elif line is self.draft.lexed.lines[0]:
            text = "the first line is indented"
            hint = "let the text begin in column 1"
        else:
            text = "this line is indented deeper than the one before, but no block begins here"
            hint = _TAB_HINT if self._has_tab(line) else "give it the same indentation as the line above"
        self.draft.report("E001", line.start, line.start + 1, text, hint)
        self._skip(line, self.indents[-1])

    def _has_tab(self, line: LogicalLine) -> bool:
        row = self.draft.lexed.masked_row(line.line)
        return "\t" in row[: len(row) - len(row.lstrip())]

    def _skip(self, line: LogicalLine, above: int) -> None:
        self.draft.dropped.add(line)
        self.skip_above = above
        self.skipping_at = line.column

    def _is_out_of_place(self, line: LogicalLine, following: LogicalLine) -> bool:
        """Return whether a clause without a colon belongs to no block, and stands left of one that goes on below it.

        What is below is then not its body, and is read as if the line were not there.
        """
        column = line.column
        if line.word not in CLAUSES or line.broken or column not in self.indents or following.column <= column:
            return False
        waiting = self.waiting
        goes_on = following.column in self.indents
        if waiting is not None and column <= waiting.column:
            goes_on = goes_on or following.column > waiting.column
        if not goes_on or header_colon(self.draft.code(line)) >= 0:
            return False
        block = next((block for block in reversed(self.blocks) if block.column <= column), None)
        return block is None or block.column < column or line.word not in CLAUSES_OF.get(block.word, ())

    # Blocks

    def _line(self, line: LogicalLine, deeper_follows: bool) -> None:
        draft = self.draft
        word = line.word
        closed, self.closed = self.closed, None
        waiting, self.waiting = self.waiting, None
        if waiting and line.column > waiting.column:
            waiting.waits = False
        while self.blocks and self.blocks[-1].column > line.column:
            self._leave(line)
        if word in CLAUSES:
            self._clause(line, closed, deeper_follows)
            return
        if self.blocks and self.blocks[-1].column == line.column:
            self._leave(line)
        code = draft.code(line)
        if word == "case":
            if not (self.blocks and self.blocks[-1].word == "match"):
                word = ""
            elif header_colon(code) < 0 and not line.broken:
                self._report_colon(line)
                draft.broken.add(line)
                if not deeper_follows:
                    return
        if word in _COMPOUND:
            self._header(_Block(line, word), line, code, deeper_follows)
        elif word in _SOFT_COMPOUND and self._is_soft_header(word, code):
            if word == "sec":
                self._secondary(line)
            self._header(_Block(line, word), line, code, deeper_follows)
        elif deeper_follows and code.endswith(":"):
            self._open(_Block(line, word), line, len(code) - 1, code)

    @staticmethod
    def _is_soft_header(word: str, code: str) -> bool:
        if word in ("match", "case"):
            return header_colon(code) > 0 and (word == "case" or code.endswith(":"))
        return _soft_header(name_pattern(code)).match(code) is not None

    def _header(self, block: _Block, line: LogicalLine, code: str, deeper_follows: bool) -> None:
        colon = header_colon(code)
        if colon < 0:
            if line.broken:
                # What belongs to its body may have been read as a part of the header.
                self._open(block, line, len(code), code)
                block.waits = deeper_follows
                self.waiting = block if deeper_follows else None
                return
            if deeper_follows or (code == line.word and line.word in ("else", "try", "finally")):
                self._report_colon(line)
                block.colon_missing = True
                colon = len(code)
            else:
                return
        self._open(block, line, colon, code)

    def _report_colon(self, line: LogicalLine) -> None:
        draft, end = self.draft, line.end
        code = draft.code(line)
        if code.endswith((" then", ")then")):
            start = end - len("then")
            text = draft.lexed.text[line.start : start].rstrip()
            fix = Fix("write a colon", (draft.edit(line.start + len(text), end, ":"),), safe=True)
            draft.report("E001", start, end, "`then` does not exist here", "end the line with `:`", fix)
            return
        fix = Fix("put the colon", (draft.edit(end, end, ":"),), safe=True)
        draft.report(
            "E001",
            end,
            end + 1,
            said("the colon behind `{word}` is missing", word=line.word),
            "end the line with `:`",
            fix,
        )

    def _open(self, block: _Block, line: LogicalLine, colon: int, code: str) -> None:
        self.draft.headers[line] = colon
        if not self.blocks or self.blocks[-1] is not block:
            self.blocks.append(block)
        block.header = line
        block.label = f"`{line.word}`" if line.word else "block"
        if not code[colon + 1 :].strip():
            block.waits = block.has_lines = True
            self.waiting = block

    def _secondary(self, line: LogicalLine) -> None:
        if self.blocks:
            block = self.blocks[-1]
            text = said(
                "a secondary program cannot stand inside the {label} of line {line}",
                label=block.label,
                line=block.header.line,
            )
            hint = "move it out and send it by itself, or write `def`"
            self.draft.report("E105", line.start, line.start + 3, text, hint)
        self.draft.secondaries.add(line.line)
        self.draft.replace(line.start, line.start + 3, "def")

    def _clause(self, line: LogicalLine, closed: tuple[_Block, LogicalLine] | None, deeper_follows: bool) -> None:
        """Continue the open statement in this column."""
        draft, word = self.draft, line.word
        code = draft.code(line)
        block = self.blocks[-1] if self.blocks else None
        if block and block.column == line.column and word in CLAUSES_OF.get(block.word, ()):
            if block.waits:
                self._empty(block)
            self._repair(block, empty=block.waits)
        elif closed and closed[0].column == line.column and word in CLAUSES_OF.get(closed[0].word, ()):
            block, end = closed
            text = said(
                "`{word}` comes after the `end` of its `{block_word}` in line {line}",
                word=word,
                block_word=block.word,
                line=end.line,
            )
            hint = "one `end` closes the whole statement; put it behind the last clause"
            draft.report("E103", line.start, line.start + len(word), text, hint)
            self.blocks.append(block)
        else:
            if block and block.column == line.column:
                self._leave(line)
            self._orphan(line, deeper_follows)
            return
        block.clauses.append(word)
        block.waits = block.colon_missing = False
        self._header(block, line, code, deeper_follows)

    def _report_orphan(self, line: LogicalLine) -> None:
        takers = [word for word, clauses in CLAUSES_OF.items() if line.word in clauses and word != "async"]
        near = next((block for block in reversed(self.blocks) if line.word in CLAUSES_OF.get(block.word, ())), None)
        left = self.left.get(line.column)
        if near:
            hint = said(
                "the `{word}` of line {line} starts in column {column}",
                word=near.word,
                line=near.opener.line,
                column=near.column + 1,
            )
        elif left and line.word in CLAUSES_OF.get(left[0].word, ()):
            hint = said(
                "the `{word}` of line {line} ended before line {left_line}",
                word=left[0].word,
                line=left[0].opener.line,
                left_line=left[1].line,
            )
        else:
            hint = "check the indentation of the lines above"
        names = ", ".join(f"`{word}`" for word in takers)
        text = said("`{word}` belongs to no {names} in this column", word=line.word, names=names)
        self.draft.report("E001", line.start, line.start + len(line.word), text, hint)

    def _orphan(self, line: LogicalLine, deeper_follows: bool) -> None:
        self._report_orphan(line)
        label = f"`{line.word}`"
        is_last = line.word in ("else", "finally")
        line.word = ""
        self.draft.broken.add(line)
        code = self.draft.code(line)
        colon = header_colon(code)
        if colon >= 0 or deeper_follows:
            block = _Block(line, "" if colon < 0 and is_last else "if")
            self._open(block, line, colon if colon >= 0 else len(code), code)
            block.label = label

    def _end(self, line: LogicalLine, clause_follows: bool) -> None:
        draft = self.draft
        draft.blank(line.start, line.end)
        depth = len(self.blocks)
        while depth and self.blocks[depth - 1].column > line.column:
            depth -= 1
        if not depth or self.blocks[depth - 1].column != line.column:
            self._stray(line)
            return
        block = self.blocks[depth - 1]
        while len(self.blocks) > depth:
            self._close(self.blocks.pop(), line)
        self.blocks.pop()
        if not clause_follows:
            self._close(block, line, has_end=True)
        self.waiting = None
        while self.indents[-1] > line.column:
            self.indents.pop()
        self.closed = (block, line)

    def _stray(self, line: LogicalLine) -> None:
        if self.lost.get(line.column):
            self.lost[line.column] -= 1
            return
        draft = self.draft
        left = self.left.get(line.column)
        if left:
            block, leaver = left
            hint = said(
                "the {label} of line {line} ends in front of line {leaver_line}",
                label=block.label,
                line=block.header.line,
                leaver_line=leaver.line,
            )
        elif self.blocks:
            block = self.blocks[-1]
            hint = said(
                "the innermost open block is the {label} of line {line}, which starts in column {column}",
                label=block.label,
                line=block.header.line,
                column=block.column + 1,
            )
        else:
            hint = "remove it"
        draft.report("E101", line.start, line.start + 3, "this `end` closes no block that starts in its column", hint)

    # Ends of blocks

    def _leave(self, line: LogicalLine) -> None:
        """Close the innermost block, which the indentation left."""
        block = self.blocks.pop()
        self.left[block.column] = (block, line)
        if block.waits and line.column == block.column:
            self.lost[block.column] = self.lost.get(block.column, 0) + 1
            if not block.colon_missing:
                text = said(
                    "the body of the {label} of line {line} should be indented here",
                    label=block.label,
                    line=block.header.line,
                )
                hint = "indent the lines that belong to it, or write `pass`"
                self.draft.report("E001", line.start, line.start + max(1, len(line.word)), text, hint)
            self._repair(block, empty=True)
            self._without_handlers(block)
            return
        self._close(block, line)

    def _close(self, block: _Block, line: LogicalLine | None, *, has_end: bool = False) -> None:
        outer = self.blocks[-1].word if self.blocks else ""
        last = self.last or block.opener
        if block.has_lines or has_end:
            self.draft.ends.append(BlockEnd(block.word, outer, block.opener, last, line, has_end))
        lacks_handlers = block.word == "try" and not block.clauses and not block.opener.broken
        if block.waits:
            if line is None and self.draft.options.kind == LINE:
                self._single_line(block)
            elif not lacks_handlers:
                self._empty(block)
        self._repair(block, empty=block.waits)
        if lacks_handlers:
            start = block.opener.start
            hint = "say behind its body what to do with an error: `except Exception as e:`"
            self.draft.report("E001", start, start + 3, "this `try` has neither `except` nor `finally`", hint)
            self._without_handlers(block)

    def _without_handlers(self, block: _Block) -> None:
        """Let Python read the body of a `try` that has no handler."""
        if block.word == "try" and not block.clauses and not block.opener.broken:
            self.draft.replace(block.opener.start, block.opener.start + 3, "if 1")

    def _repair(self, block: _Block, empty: bool) -> None:
        header = block.header
        colon = self.draft.headers.get(header)
        if colon is None or header.broken or header in self.draft.broken:
            return
        if empty and header.word == "match":
            # A `match` holds nothing but `case`, not even `pass`.
            self.draft.broken.add(header)
            return
        text = ":" if block.colon_missing else ""
        text += " pass" if empty else ""
        if text:
            at = header.start + (colon if block.colon_missing else colon + 1)
            self.draft.replace(at, at, text)

    def _empty(self, block: _Block) -> None:
        start, colon = block.header.start, self.draft.headers[block.header]
        text = said("the body of this {label} is empty", label=block.label)
        self.draft.report("E104", start, start + colon + 1, text, "write `pass` where nothing is to be done")

    def _single_line(self, block: _Block) -> None:
        text = said("a block cannot begin in a single line: the body of this {label} is missing", label=block.label)
        hint = "send several lines as `def name():` ... `end`"
        self.draft.report("E001", block.header.start, block.header.end, text, hint)


_TAB_HINT: Final = "this line is indented with a tab, which counts up to the next multiple of eight; use blanks"
