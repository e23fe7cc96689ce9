"""Finds strings, comments, brackets and logical lines of a text.

A *logical line* is Python's: physical lines joined by brackets, backslashes and triple quotes,
without the comment behind it. `lex` finds them all and makes a *masked* copy of the text with
the same length, in which strings are runs of `"`, and comments, line ends inside a logical line
and backslashes that continue one are blanks. Rules about the text read the masked copy, so quoted
text never matches. Signs of an input method in code are read as the plain ones; see `wide_signs`.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cache
from keyword import kwlist

from elitescript.language.text.strings import formatted_end, prefix_start, string_end_pattern
from elitescript.language.text.wide_signs import (
    WIDE_BLANK,
    WideSign,
    blank_with_wide_signs,
    has_wide_signs,
    plain_of,
    plain_word,
    stand_in,
    structure_with_wide_signs,
    wide_closer,
    wide_string_end,
)
from elitescript.records import NamedTuple

TAB_WIDTH = 8
STRING_FILL = '"'
CLOSER_OF = {"(": ")", "[": "]", "{": "}"}

# Reading again behind an open bracket or inside a formatted string costs time in proportion to
# the text; after this number of times nothing is read again.
_MAX_RESCANS = 20

# No expression can contain one of these words at the start of a line, so they prove that a
# bracket above was never closed.
_IN_EXPRESSIONS = "False None True and as async await elif else for from if in is lambda not or yield"
_STATEMENT_WORDS = frozenset(kwlist).difference(_IN_EXPRESSIONS.split())


class Flaw(NamedTuple):
    """A mistake below the level of grammar: an open string, a bracket without its partner."""

    start: int
    end: int
    text: str
    hint: str


class StringToken(NamedTuple):
    """A string with backslashes in which escapes count; offsets into the text."""

    start: int
    body: int
    end: int


class LogicalLine:
    """One logical line; offsets into the text, lines counted from 1."""

    __slots__ = ("broken", "column", "end", "last_line", "line", "start", "word")

    def __init__(self, start: int, line: int, column: int) -> None:
        self.start = start
        self.end = start
        self.line = line
        self.last_line = line
        self.column = column
        """Width of the indentation, from 0; a tab goes to the next multiple of 8."""
        self.word = ""
        """The identifier or keyword at its start; empty if it starts with something else."""
        self.broken = False
        """Whether it has a flaw, so that Python's parser must not read it."""


class Lexed:
    """Result of `lex`."""

    __slots__ = ("flaws", "lines", "masked", "starts", "strings", "text", "wide_signs")

    def __init__(self, text: str) -> None:
        self.text = text
        """The text; a wide sign of code is a plain one, of the same length."""
        self.wide_signs: list[WideSign] = []
        """Signs of code that are not plain, in the order of the text; blanks before a line are one."""
        self.masked = text
        self.lines: list[LogicalLine] = []
        self.strings: list[StringToken] = []
        self.flaws: list[Flaw] = []
        self.starts = [0]
        """Offset of each physical line."""

    def place(self, offset: int) -> tuple[int, int]:
        """Return (line, column) of an offset, both from 1."""
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    def masked_row(self, line: int) -> str:
        """Return the masked text of one physical line, counted from 1; blank where there are only comments."""
        start = self.starts[line - 1]
        end = self.starts[line] - 1 if line < len(self.starts) else len(self.text)
        return self.masked[start:end]


def lex(text: str) -> Lexed:
    """Scan a text with LF line ends. Never fails: flaws are part of the result."""
    return _TextScanner(text).scan()


def indentation_width(blank: str) -> int:
    """Return the column, from 0, after leading blanks and tabs; a wide blank is two, a form feed starts again at 0."""
    if "\f" in blank:
        blank = blank.rpartition("\f")[2]
    if WIDE_BLANK in blank:
        blank = blank.replace(WIDE_BLANK, "  ")
    return len(blank.expandtabs(TAB_WIDTH)) if "\t" in blank else len(blank)


def _plain_indentation(blank: str) -> str:
    """Return blanks and tabs of the same width as the blanks of an input method."""
    return "".join("  " if sign == WIDE_BLANK else plain_of(sign) for sign in blank)


@cache
def structure_pattern() -> re.Pattern[str]:
    # Every alternative starts with a literal, which lets the search skip ordinary text fast.
    return re.compile(r"""\#|'''|'|\"\"\"|\"|\(|\)|\[|\]|\{|\}|\\|\n""")


@cache
def _blank() -> re.Pattern[str]:
    return re.compile(r"[ \t\f]*")


@cache
def _word() -> re.Pattern[str]:
    return re.compile(r"[^\W\d]\w*")


class _TextScanner:
    __slots__ = ("blank", "broken", "fills", "is_wide", "lexed", "line", "rescans", "signs", "stack", "text")

    def __init__(self, text: str) -> None:
        self.text = text
        self.rescans = 0
        self.is_wide = has_wide_signs(text)
        self.blank = (blank_with_wide_signs() if self.is_wide else _blank()).match
        self.lexed = Lexed(text)
        starts = self.lexed.starts
        position = text.find("\n")
        while position >= 0:
            starts.append(position + 1)
            position = text.find("\n", position + 1)
        self.fills: list[tuple[int, int, str]] = []
        self.signs: list[WideSign] = []
        self.stack: list[tuple[str, int]] = []
        self.line = 1
        self.broken = False

    def scan(self) -> Lexed:
        text, lexed = self.text, self.lexed
        blank, word = self.blank, _word().match
        position, size = 0, len(text)
        while position < size:
            found = blank(text, position)
            start = found.end() if found else position
            if start == size:
                break
            first = text[start]
            if first == "\n":
                self.line += 1
                position = start + 1
            elif first == "#":
                position = self._comment(start)
            elif first == "\uff03":
                self.signs.append(WideSign(start, start + 1, "#"))
                position = self._comment(start)
            elif first == "\\" and text[start + 1 : start + 2] == "\n":
                self._fill(start, start + 2, " ")
                self.line += 1
                position = start + 2
            else:
                before = text[position:start]
                logical = LogicalLine(start, self.line, indentation_width(before))
                if self.is_wide and not before.isascii():
                    self.signs.append(WideSign(position, start, _plain_indentation(before)))
                if named := word(text, start):
                    logical.word = plain_word(named.group()) if self.is_wide else named.group()
                position = self._logical_line(logical)
                lexed.lines.append(logical)
        lexed.masked = self._masked()
        if self.signs:
            lexed.wide_signs = self.signs
            lexed.text = self._plain_text()
        lexed.flaws.sort()
        return lexed

    def _logical_line(self, logical: LogicalLine) -> int:
        """Read up to the end of the logical line; return where the next one may start."""
        text, search = self.text, (structure_with_wide_signs() if self.is_wide else structure_pattern()).search
        stack = self.stack = []
        self.broken = False
        depth_at_line_start = 0
        position = logical.start
        while True:
            found = search(text, position)
            if found is None:
                if stack:
                    position = self._unclosed(logical)
                    break
                return self._finish(logical, len(text))
            mark, at = found.group(), found.start()
            position = found.end()
            if not mark.isascii():
                if (behind := self._wide(mark, at, depth_at_line_start)) >= 0:
                    position = behind
                    continue
                mark = plain_of(mark)
            if mark in "([{":
                stack.append((mark, at))
            elif mark in ")]}":
                self._close(mark, at)
            elif mark == "\n":
                if not stack:
                    self._finish(logical, at)
                    self.line += 1
                    return position
                self._fill(at, position, " ")
                self.line += 1
                depth_at_line_start = len(stack)
                if self._starts_statement(position):
                    position = self._unclosed(logical)
                    break
            elif mark == "#":
                position = self._comment(at, keep_line=True)
            elif mark == "\\":
                if text[position : position + 1] == "\n":
                    position += 1
                    self._fill(at, position, " ")
                    self.line += 1
            else:
                position = self._string(mark, at, depth_at_line_start)
        return position

    def _finish(self, logical: LogicalLine, end: int) -> int:
        position = end
        # Comments are already in `fills`; the code ends before the last one and its blanks.
        if self.fills and self.fills[-1][1] == end and self.text[self.fills[-1][0]] in "#\uff03":
            end = self.fills[-1][0]
        code = self.text[logical.start : end]
        if self.is_wide:
            size = len(code)
            while size and stand_in(code[size - 1]) in " \t\f\\\n":
                size -= 1
        else:
            size = len(code.rstrip(" \t\f\\\n"))
        logical.end = logical.start + max(1, size)
        logical.last_line = self.line
        logical.broken = self.broken
        return position

    def _comment(self, at: int, keep_line: bool = False) -> int:
        end = self.text.find("\n", at)
        if end < 0:
            end = len(self.text)
        self._fill(at, end, " ")
        if keep_line or end == len(self.text):
            return end
        self.line += 1
        return end + 1

    def _string(self, quote: str, at: int, depth_at_line_start: int) -> int:
        """Read a string whose opening quote is at `at`; return where it ends."""
        text = self.text
        start = prefix_start(text, at)
        prefix = text[start:at].lower()
        body = at + len(quote)
        end = self._string_end(body, quote, "f" in prefix)
        if self.is_wide and len(quote) == 1 and (closer := wide_closer(text, body, end, quote)) >= 0:
            self.signs.append(WideSign(closer, closer + 1, quote))
            end = closer + 1
        if end < 0:
            hint = f"close it with {quote}"
            if len(quote) == 3:
                self._flaw(start, body, "this triple-quoted string is never closed", hint)
                self.line += text.count("\n", at)
                self.stack.clear()
                self._fill(start, len(text), STRING_FILL)
                return len(text)
            end = text.find("\n", at)
            end = len(text) if end < 0 else end
            self._flaw(start, end, "this string is not closed at the end of its line", hint)
            del self.stack[depth_at_line_start:]
            self._fill(start, end, STRING_FILL)
            return end
        if "\\" in text[body:end] and "r" not in prefix:
            self.lexed.strings.append(StringToken(start, body, end))
        self.line += text.count("\n", at, end)
        self._fill(start, end, STRING_FILL)
        return end

    def _string_end(self, body: int, quote: str, formatted: bool) -> int:
        found = string_end_pattern(quote).match(self.text, body)
        if found is None:
            return -1
        inside = self.text[body : found.end()] if formatted else ""
        if inside.count("{") != inside.count("}") and self.rescans < _MAX_RESCANS:
            # The first matching quote may belong to a string inside a replacement field.
            nested = formatted_end(self.text, body, quote)
            if nested >= 0:
                return nested
            self.rescans += 1
        return found.end()

    def _close(self, mark: str, at: int) -> None:
        if not self.stack:
            self._flaw(at, at + 1, f"this '{mark}' closes nothing", "remove it, or open the bracket before it")
            return
        opener, opened_at = self.stack.pop()
        if CLOSER_OF[opener] != mark:
            line, column = self.lexed.place(opened_at)
            text = f"'{mark}' cannot close the '{opener}' of line {line}, column {column}"
            self._flaw(at, at + 1, text, f"close it with '{CLOSER_OF[opener]}'")

    def _unclosed(self, logical: LogicalLine) -> int:
        """Report the open bracket and decide where reading goes on.

        What follows belongs to the bracket as long as it is indented deeper than the statement.
        """
        opener, at = self.stack[0]
        hint = f"add the missing '{CLOSER_OF[opener]}'"
        if opener == "{" and self.text[at + 1 : at + 2] in ("", "\n"):
            hint += ", or `:` if a block begins here"
        self._flaw(at, at + 1, f"this '{opener}' is never closed", hint)
        self.rescans += 1
        starts, text = self.lexed.starts, self.text
        line = self._line_behind(logical, at) if self.rescans < _MAX_RESCANS else len(starts)
        resume = starts[line] if line < len(starts) else len(text)
        self.fills = [fill for fill in self.fills if fill[0] < resume]
        self.lexed.strings = [string for string in self.lexed.strings if string.start < resume]
        self.lexed.flaws = [flaw for flaw in self.lexed.flaws if flaw.start < resume]
        self.signs = [sign for sign in self.signs if sign.start < resume]
        self.line = line
        self._finish(logical, resume)
        logical.end = min(logical.end, resume)
        if resume < len(text):
            self.line = line + 1
        return resume

    def _line_behind(self, logical: LogicalLine, at: int) -> int:
        """Return the index of the first physical line after offset `at` that is not deeper than `logical`."""
        starts, text = self.lexed.starts, self.text
        strings = [fill for fill in self.fills if fill[0] > at and fill[2] == STRING_FILL]
        blank = self.blank
        line, _ = self.lexed.place(at)
        while line < len(starts):
            start = starts[line]
            found = blank(text, start)
            code = found.end() if found else start
            goes_on = plain_of(text[code : code + 1]) in ("", "\n", "#", ")", "]", "}")
            if not goes_on and indentation_width(text[start:code]) <= logical.column:
                while strings and strings[0][1] <= start:
                    del strings[0]
                if not (strings and strings[0][0] < start):
                    break
            line += 1
        return line

    def _starts_statement(self, position: int) -> bool:
        found = self.blank(self.text, position)
        named = _word().match(self.text, found.end()) if found else None
        return named is not None and named.group() in _STATEMENT_WORDS

    def _wide(self, mark: str, at: int, depth_at_line_start: int) -> int:
        """Note a wide sign of code; return where reading goes on, -1 to read it as its plain form."""
        end = at + len(mark)
        if mark[0].isalnum() or mark[0] == "_" or mark[0] == "\uff3f":
            if (plain := plain_word(mark)) != mark:
                self._sign(at, end, plain, plain)
            return end
        if len(mark) == 2:
            # An input method types the two dashes for the underscore.
            self._sign(at, end, "_", "__")
            return end
        plain = plain_of(mark)
        if plain in "'\"":
            return self._wide_string(at, depth_at_line_start)
        if plain in "#\\":
            self.signs.append(WideSign(at, end, plain))
            return -1
        self._sign(at, end, plain, stand_in(mark))
        return -1 if plain in "()[]{}" else end

    def _wide_string(self, at: int, depth_at_line_start: int) -> int:
        text = self.text
        start = prefix_start(text, at)
        closer, end, quote = wide_string_end(text, at)
        if end < 0:
            line_end = text.find("\n", at)
            end = len(text) if line_end < 0 else line_end
            self.signs.append(WideSign(at, at + 1, ""))
            self.broken = True
            del self.stack[depth_at_line_start:]
        else:
            body = at + end - closer
            self.signs += (WideSign(at, body, quote), WideSign(closer, end, quote))
            if not quote:
                self.broken = True
            elif "\\" in text[body:closer] and "r" not in text[start:at].lower():
                self.lexed.strings.append(StringToken(start, body, end))
            self.line += text.count("\n", at, end)
        self._fill(start, end, STRING_FILL)
        return end

    def _sign(self, start: int, end: int, plain: str, fill: str) -> None:
        self.signs.append(WideSign(start, end, plain))
        for at, character in enumerate(fill, start):
            self._fill(at, at + 1, character)

    def _flaw(self, start: int, end: int, text: str, hint: str) -> None:
        self.broken = True
        self.lexed.flaws.append(Flaw(start, end, text, hint))

    def _fill(self, start: int, end: int, character: str) -> None:
        self.fills.append((start, end, character))

    def _plain_text(self) -> str:
        parts = []
        position = 0
        for start, end, plain in self.signs:
            parts.append(self.text[position:start])
            old = self.text[start:end]
            if len(plain) == end - start and (plain[0] not in "'\"" or len(plain) == 1):
                parts.append(plain)
            else:
                parts.append("".join(map(stand_in, old)) if plain else old)
            position = end
        parts.append(self.text[position:])
        return "".join(parts)

    def _masked(self) -> str:
        parts = []
        position = 0
        for start, end, character in self.fills:
            parts.append(self.text[position:start])
            parts.append(character * (end - start))
            position = end
        parts.append(self.text[position:])
        return "".join(parts)
