"""Finds strings, comments, brackets and logical lines of a text; `masked.lex` calls it.

A *logical line* is Python's: physical lines joined by brackets, backslashes and triple quotes,
without the comment behind it. `TextScanner` finds them all and makes a *masked* copy of the text with
the same length, in which strings are runs of `"`, and comments, line ends inside a logical line
and backslashes that continue one are blanks. Rules about the text read the masked copy, so quoted
text never matches. Signs of an input method in code are read as the plain ones; see `wide_signs`.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable
from functools import cache
from keyword import kwlist
from typing import Final

from elitescript.language.text.strings import formatted_end, prefix_start, string_end_pattern
from elitescript.records import NamedTuple
from elitescript.said import said

TAB_WIDTH = 8
STRING_FILL = '"'
CLOSER_OF = {"(": ")", "[": "]", "{": "}"}

# Reading again behind an open bracket or inside a formatted string costs time in proportion to
# the text; after this number of times nothing is read again.
_MAX_RESCANS = 20

# Nesting of brackets in lines that are read at once.
_PLAIN_DEPTH = 4

# No expression can contain one of these words at the start of a line, so they prove that a
# bracket above was never closed.
_IN_EXPRESSIONS = "False None True and as async await elif else for from if in is lambda not or yield"
_STATEMENT_WORDS = frozenset(kwlist).difference(_IN_EXPRESSIONS.split())


class WideSign(NamedTuple):
    """A sign of code that is not plain; see `wide_signs`.

    Attributes:
        start: its offset.
        end: behind it.
        plain: what it stands for; empty if that is not certain.
    """

    start: int
    end: int
    plain: str


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
    """Result of `masked.lex`."""

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


def indentation_width(blank: str) -> int:
    """Return the column, from 0, after leading blanks and tabs; a wide blank is two, a form feed starts again at 0."""
    if "\f" in blank:
        blank = blank.rpartition("\f")[2]
    if "\u3000" in blank:
        blank = blank.replace("\u3000", "  ")
    return len(blank.expandtabs(TAB_WIDTH)) if "\t" in blank else len(blank)


MARKS: Final = (
    "\xb7\u0300-\u036f\u0387\u0483-\u0487\u0591-\u05bd\u05bf\u05c1-\u05c2\u05c4-\u05c5\u05c7\u0610-\u061a"
    "\u064b-\u065f\u0670\u06d6-\u06dc\u06df-\u06e8\u06ea-\u06ed\u0711-\u07f3\u07fd\u0816-\u082d\u0859-\u085b"
    "\u0898-\u08e1\u08e3-\u0963\u0981-\u09e3\u09fe-\u0a75\u0a81-\u0ae3\u0afa-\u0b63\u0b82-\u0bd7\u0c00-\u0c63"
    "\u0c81-\u0c83\u0cbc-\u0d4d\u0d57-\u0d63\u0d81-\u0df3\u0e31-\u0e3a\u0e47-\u0e4e\u0eb1-\u0ecd\u0f18-\u0f19"
    "\u0f35\u0f37\u0f39\u0f3e-\u0f84\u0f86-\u0fbc\u0fc6\u102b-\u103e\u1056-\u109d\u135d-\u135f\u1712-\u1734"
    "\u1752-\u17d3\u17dd\u180b-\u180d\u180f-\u193b\u1a17-\u1a1b\u1a55-\u1a7f\u1ab0-\u1abd\u1abf-\u1b44"
    "\u1b6b-\u1b73\u1b80-\u1bf3\u1c24-\u1c37\u1cd0-\u1cd2\u1cd4-\u1dff\u203f-\u2040\u2054\u20d0-\u20dc\u20e1"
    "\u20e5-\u20f0\u2118\u212e\u2cef-\u2cf1\u2d7f-\u2dff\u302a-\u302f\u3099-\u309a\ua66f\ua674-\ua67d"
    "\ua69e-\ua6f1\ua802-\ua827\ua82c\ua880-\ua8c5\ua8e0-\ua8f1\ua8ff-\ua92d\ua947-\ua953\ua980-\ua9c0"
    "\ua9e5-\uaa4d\uaa7b-\uaac1\uaaeb-\uaaef\uaaf5-\uaaf6\uabe3-\uabea\uabec-\uabed\ufb1e\ufe00-\ufe0f"
    "\ufe20-\ufe2f\ufe33-\ufe34\ufe4d-\ufe4f\uff3f\U000101fd-\U0001037a\U00010a01-\U00010a3f"
    "\U00010ae5-\U00010ae6\U00010d24-\U00010eac\U00010f46-\U00010f50\U00010f82-\U00010f85"
    "\U00011000-\U00011046\U00011070-\U000110ba\U000110c2\U00011100-\U00011134\U00011145-\U00011173"
    "\U00011180-\U000111c0\U000111c9-\U000111cc\U000111ce-\U000111cf\U0001122c-\U00011237\U0001123e"
    "\U000112df-\U00011446\U0001145e-\U000114c3\U000115af-\U000115c0\U000115dc-\U00011640"
    "\U000116ab-\U000116b7\U0001171d-\U0001172b\U0001182c-\U0001183a\U00011930-\U00011943"
    "\U000119d1-\U000119e0\U000119e4-\U00011a3e\U00011a47-\U00011a99\U00011c2f-\U00011c3f"
    "\U00011c92-\U00011ef6\U00016af0-\U00016af4\U00016b30-\U00016b36\U00016f4f-\U00016f92"
    "\U00016fe4-\U00016ff1\U0001bc9d-\U0001bc9e\U0001cf00-\U0001cf46\U0001d165-\U0001d169"
    "\U0001d16d-\U0001d172\U0001d17b-\U0001d182\U0001d185-\U0001d18b\U0001d1aa-\U0001d1ad"
    "\U0001d242-\U0001d244\U0001da00-\U0001da36\U0001da3b-\U0001da6c\U0001da75\U0001da84\U0001da9b-\U0001e136"
    "\U0001e2ae-\U0001e2ef\U0001e8d0-\U0001e94a\U000e0100-\U000e01ef"
)
r"""Ranges of the characters that may stand in a name and are no `\w`, for the class of a pattern: accents that combine
with a letter, vowel signs. What is not assigned between them belongs to them."""

ASCII_NAME: Final = r"[^\W\d]\w*"
NAME: Final = rf"(?:[^\W\d]|[\u2118\u212e])[\w{MARKS}]*"
"""Pattern of an identifier, as Python's tokenizer reads it."""
WORD_START: Final = rf"(?<![\w{MARKS}])"
WORD_END: Final = rf"(?![\w{MARKS}])"
"""Where a word begins and ends, as `\b` for names with such characters."""


def name_pattern(text: str) -> str:
    """Return the pattern of an identifier in a text; most texts need the small one, which is made faster."""
    return ASCII_NAME if text.isascii() else NAME


def is_in_word(character: str) -> bool:
    """Return whether a character may stand in a name; False for none."""
    return character != "" and ("a" + character).isidentifier()


@cache
def structure_pattern() -> re.Pattern[str]:
    # Every alternative starts with a literal, which lets the search skip ordinary text fast.
    return re.compile(r"""\#|'''|'|\"\"\"|\"|\(|\)|\[|\]|\{|\}|\\|\n""")


@cache
def _plain_line() -> re.Pattern[str]:
    """Return the pattern of a logical line of one physical line without strings, comments and flaws: most lines."""
    other = r"""[^()\[\]{}\n\#'"\\]*+"""
    inside = other
    for _ in range(_PLAIN_DEPTH):
        inside = rf"{other}(?:(?:\({inside}\)|\[{inside}\]|\{{{inside}\}}){other})*+"
    return re.compile(rf"{inside}\n")


LONG_TEXT: Final = 8000
"""Characters of a text from which on plain lines are read at once."""


def _no_plain_line(text: str, position: int) -> None:
    """Find no plain line: each is read sign by sign, with the same result."""


@cache
def _blank() -> re.Pattern[str]:
    return re.compile(r"[ \t\f]*")


@cache
def _word(pattern: str) -> re.Pattern[str]:
    return re.compile(pattern)


class TextScanner:
    """Finds the logical lines of a text; `WideScanner` also reads signs of input methods."""

    __slots__ = ("blank", "broken", "fills", "lexed", "line", "plain", "rescans", "search", "signs", "stack", "text")

    def __init__(self, text: str) -> None:
        self.text = text
        # Making the pattern takes as long as reading a text of that length without it.
        is_long = len(text) >= LONG_TEXT
        self.plain: Callable[[str, int], re.Match[str] | None] = _plain_line().match if is_long else _no_plain_line
        self.rescans = 0
        self.blank = _blank().match
        self.search = structure_pattern().search
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
        blank, word, plain = self.blank, _word(name_pattern(text)).match, self.plain
        position, size = 0, len(text)
        split = 0
        while position < size:
            found = blank(text, position)
            start = found.end() if found else position
            if start == size:
                break
            first = text[start]
            if first == "\n":
                self.line += 1
                position = start + 1
                split = 0
            elif first == "#" or (first == "\uff03" and self._notes_comment(start)):
                position = self._comment(start)
                split = 0
            elif first == "\\" and text[start + 1 : start + 2] == "\n":
                # As Python's tokenizer has it: the first blanks before a backslash indent what stands below.
                split = split or indentation_width(text[position:start])
                self._fill(start, start + 2, " ")
                self.line += 1
                position = start + 2
            else:
                logical = LogicalLine(start, self.line, split or indentation_width(text[position:start]))
                split = 0
                if named := word(text, start):
                    logical.word = named.group()
                self._begins(logical, position)
                if (whole := plain(text, start)) is not None:
                    position = whole.end()
                    logical.end = start + max(1, self._code_size(text[start : position - 1]))
                    logical.last_line = self.line
                    self.line += 1
                else:
                    position = self._logical_line(logical)
                lexed.lines.append(logical)
        lexed.masked = self._masked()
        self._ends()
        lexed.flaws.sort()
        return lexed

    def _logical_line(self, logical: LogicalLine) -> int:
        """Read up to the end of the logical line; return where the next one may start."""
        text, search = self.text, self.search
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
                mark, position = self._wide(mark, at, depth_at_line_start)
            if not mark:
                pass
            elif mark in "([{":
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
        size = self._code_size(self.text[logical.start : end])
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
        end = self._closed(quote, body, end, "f" in prefix)
        if end < 0:
            hint = said("close it with {quote}", quote=quote)
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
            self._flaw(
                at, at + 1, said("this '{mark}' closes nothing", mark=mark), "remove it, or open the bracket before it"
            )
            return
        opener, opened_at = self.stack.pop()
        if CLOSER_OF[opener] != mark:
            line, column = self.lexed.place(opened_at)
            text = said(
                "'{mark}' cannot close the '{opener}' of line {line}, column {column}",
                mark=mark,
                opener=opener,
                line=line,
                column=column,
            )
            self._flaw(at, at + 1, text, said("close it with '{closer}'", closer=CLOSER_OF[opener]))

    def _unclosed(self, logical: LogicalLine) -> int:
        """Report the open bracket and decide where reading goes on.

        What follows belongs to the bracket as long as it is indented deeper than the statement.
        """
        opener, at = self.stack[0]
        hint = said("add the missing '{closer}'", closer=CLOSER_OF[opener])
        if opener == "{" and self.text[at + 1 : at + 2] in ("", "\n"):
            hint = said("{hint}, or `:` if a block begins here", hint=hint)
        self._flaw(at, at + 1, said("this '{opener}' is never closed", opener=opener), hint)
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
            goes_on = text[code : code + 1] in ("", "\n", "#", ")", "]", "}")
            if not goes_on and indentation_width(text[start:code]) <= logical.column:
                while strings and strings[0][1] <= start:
                    del strings[0]
                if not (strings and strings[0][0] < start):
                    break
            line += 1
        return line

    def _starts_statement(self, position: int) -> bool:
        found = self.blank(self.text, position)
        named = _word(name_pattern(self.text)).match(self.text, found.end()) if found else None
        return named is not None and named.group() in _STATEMENT_WORDS

    # What differs in a text with wide signs

    def _begins(self, logical: LogicalLine, position: int) -> None:
        """Note what is wide at the start of a logical line; its physical line starts at `position`."""

    def _notes_comment(self, at: int) -> bool:
        """Note a wide sign that begins a comment; return whether it does."""
        return False

    def _wide(self, mark: str, at: int, depth_at_line_start: int) -> tuple[str, int]:
        """Note a wide sign; return the plain one that is read for it, if it counts here, and where reading goes on."""
        raise AssertionError(mark)

    def _code_size(self, code: str) -> int:
        """Return the length of code without what may stand behind it."""
        return len(code.rstrip(" \t\f\\\n"))

    def _closed(self, quote: str, body: int, end: int, is_formatted: bool) -> int:
        """Return the end of a string that a plain mark has opened; `end` is where a plain one closes it."""
        return end

    def _ends(self) -> None:
        """Finish `lexed`."""

    def _flaw(self, start: int, end: int, text: str, hint: str) -> None:
        self.broken = True
        self.lexed.flaws.append(Flaw(start, end, text, hint))

    def _fill(self, start: int, end: int, character: str) -> None:
        self.fills.append((start, end, character))

    def _masked(self) -> str:
        parts = []
        position = 0
        for start, end, character in self.fills:
            parts.append(self.text[position:start])
            parts.append(character * (end - start))
            position = end
        parts.append(self.text[position:])
        return "".join(parts)
