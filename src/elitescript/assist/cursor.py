"""Reads the text around a place: comment, string, word, receiver of an attribute, innermost call.

Only the masked text counts, so a line that does not parse is read like any other. Offsets are those of
`Document.source.text`.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cached_property
from typing import Final

from elitescript.assist.document import Document
from elitescript.language.text.lexer import CLOSER_OF, NAME, WORD_START, LogicalLine, is_in_word
from elitescript.language.text.strings import string_end_pattern
from elitescript.lint.program import Span
from elitescript.records import NamedTuple

_OPENER_OF: Final = {closer: opener for opener, closer in CLOSER_OF.items()}
_CALLEE: Final = re.compile(rf"(?<![.]){WORD_START}({NAME}(?:[ \t]*\.[ \t]*{NAME})*)[ \t]*\Z")
_KEYWORD: Final = re.compile(rf"\s*({NAME})\s*=(?!=)")
_DECLARATION: Final = re.compile(rf"\b(?:def|sec|thread|class)[ \t]+{NAME}[ \t]*\Z")


class StringAt(NamedTuple):
    """A string literal around a place; offsets.

    Attributes:
        start: of its prefix or quote.
        body: of the first character inside.
        end: of what is behind its last character inside.
        prefix: such as `f`, in small letters.
        is_closed: it has its closing quote.
    """

    start: int
    body: int
    end: int
    prefix: str
    is_closed: bool


class Argument(NamedTuple):
    """One argument of a call; offsets, blanks included.

    Attributes:
        start, end: where it stands.
        keyword: its keyword; empty for one by position.
        value: where its value starts.
        is_spread: it begins with `*`.
        is_empty: nothing stands there.
    """

    start: int
    end: int
    keyword: str
    value: int
    is_spread: bool
    is_empty: bool


class CallAt(NamedTuple):
    """A call around a place.

    Attributes:
        function: what is called, as text: `movej`, `math.sin`.
        start: offset of the function's name.
        opener: offset of the `(`.
        arguments: what stands between the brackets, cut at commas; the last one may be empty.
        place: which of them holds the cursor.
        path: openers of brackets between the call and the place, from outside in, each with the index of the element.
    """

    function: str
    start: int
    opener: int
    arguments: tuple[Argument, ...]
    place: int
    path: tuple[tuple[str, int], ...]

    @property
    def at(self) -> Argument:
        """The argument that holds the place."""
        return self.arguments[self.place]

    @property
    def position(self) -> int:
        """Number of arguments by position before the one at the place."""
        return sum(not argument.keyword and not argument.is_empty for argument in self.arguments[: self.place])

    @property
    def others(self) -> tuple[str, ...]:
        """Keywords of the other arguments."""
        return tuple(a.keyword for index, a in enumerate(self.arguments) if a.keyword and index != self.place)

    @property
    def positional(self) -> int:
        """Number of the other arguments without a keyword."""
        return sum(not a.keyword and not a.is_empty and index != self.place for index, a in enumerate(self.arguments))


class Cursor:
    """A place in a document, moved into the text."""

    def __init__(self, document: Document, line: int, column: int) -> None:
        self.document = document
        self.text = document.source.text
        self.masked = document.translation.masked
        self.lines = document.translation.lines
        self.starts = document.source_starts
        self.line = min(max(line, 1), len(self.starts))
        self.column = min(max(column, 1), len(document.line(self.line)) + 1)
        self.offset = self.starts[self.line - 1] + self.column - 1

    def span(self, start: int, end: int) -> Span:
        """Return the range between two offsets."""
        return Span(*self._place(start), *self._place(end))

    def _place(self, offset: int) -> tuple[int, int]:
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1

    # Comment, string

    @cached_property
    def is_in_comment(self) -> bool:
        """Whether the place is behind the `#` of a comment."""
        start = self.starts[self.line - 1]
        at = self.text.find("#", start, self.offset)
        while at >= 0:
            if self.masked[at] == " ":
                return True
            at = self.text.find("#", at + 1, self.offset)
        return False

    @cached_property
    def string(self) -> StringAt | None:
        """The string literal around the place, between its quotes; None outside."""
        return self.string_at(self.offset)

    def string_at(self, offset: int) -> StringAt | None:
        """Return the string literal around an offset, between its quotes; None outside."""
        masked, text = self.masked, self.text
        if offset == 0 or masked[offset - 1] != '"':
            return None
        start = offset
        while start and masked[start - 1] == '"':
            start -= 1
        run_end = offset
        while run_end < len(masked) and masked[run_end] == '"':
            run_end += 1
        while start < offset:
            quote_at = start
            while quote_at < run_end and text[quote_at] not in "'\"":
                quote_at += 1
            quote = text[quote_at : quote_at + 1]
            quote = quote * 3 if text.startswith(quote * 3, quote_at) else quote
            body = quote_at + len(quote)
            if not quote or body > offset:
                return None
            found = string_end_pattern(quote).match(text, body, run_end)
            end = found.end() - len(quote) if found else run_end
            if offset <= end:
                return StringAt(start, body, end, text[start:quote_at].lower(), found is not None)
            start = end + len(quote)
        return None

    @cached_property
    def field(self) -> str | None:
        """The text of the replacement field of a formatted string from its `{` to the place; None outside of one."""
        string = self.string
        if string is None or "f" not in string.prefix:
            return None
        before = self.text[string.body : self.offset].replace("{{", "  ")
        opened = before.rfind("{")
        if opened < 0 or "}" in before[opened:] or ":" in before[opened:]:
            return None
        return before[opened + 1 :]

    # Word

    @cached_property
    def word(self) -> tuple[int, int]:
        """Start and end of the identifier, keyword or number around the place; both the place if there is none."""
        start = end = self.offset
        text = self.text
        while start and _is_word(text[start - 1]):
            start -= 1
        while end < len(text) and _is_word(text[end]):
            end += 1
        return start, end

    @property
    def word_text(self) -> str:
        """The whole word around the place."""
        return self.text[slice(*self.word)]

    @property
    def typed(self) -> str:
        """The part of the word before the place."""
        return self.text[self.word[0] : self.offset]

    @property
    def word_span(self) -> Span:
        """Where the word stands."""
        return self.span(*self.word)

    @cached_property
    def is_in_number(self) -> bool:
        """Whether a number is being written: `1`, `0.5`, `1e-3`."""
        start = self.word[0]
        if self.text[start : start + 1].isdigit():
            return True
        return bool(re.search(r"(?<![\w.\])])\d+\.\Z", self.masked[max(0, start - 40) : start]))

    @cached_property
    def receiver(self) -> str | None:
        """The expression before the `.` in front of the word; None without a `.`."""
        end = self.word[0]
        head = self.masked[self.statement_start : end]
        stripped = head.rstrip()
        if not stripped.endswith(".") or self.is_in_number:
            return None
        end = self.statement_start + len(stripped) - 1
        start = self._expression_start(end)
        return self.text[start:end].strip()

    def _expression_start(self, end: int) -> int:
        """Return where a chain of names, calls and elements that ends at an offset begins."""
        masked, first = self.masked, self.statement_start
        start = end
        while True:
            while start > first and masked[start - 1] in " \t":
                start -= 1
            last = masked[start - 1] if start > first else ""
            if last and last in ")]}":
                opened = self._opener(start - 1)
                if opened < 0:
                    return start
                start = opened
                # A literal list or a bracket around an expression has nothing in front of it.
                before = masked[start - 1 : start]
                if not (_is_word(before) or before in (")", "]", '"')) or last == "}":
                    return start
                continue
            if last == '"':
                while start > first and masked[start - 1] == '"':
                    start -= 1
                return start
            if not last or not _is_word(last):
                return start
            while start > first and _is_word(masked[start - 1]):
                start -= 1
            before = masked[first:start].rstrip()
            if not before.endswith("."):
                return start
            start = first + len(before) - 1

    def _opener(self, at: int) -> int:
        """Return the offset of the bracket that the one at an offset closes; -1 if there is none."""
        depth = 0
        for position in range(at, self.statement_start - 1, -1):
            mark = self.masked[position]
            if mark in _OPENER_OF:
                depth += 1
            elif mark in CLOSER_OF:
                depth -= 1
                if depth == 0:
                    return position
        return -1

    # Statement

    @cached_property
    def logical(self) -> LogicalLine | None:
        """The logical line that begins last before the place or at it; None before the first."""
        lines = self.lines
        index = bisect_right(lines, self.offset, key=lambda line: line.start) - 1
        return lines[index] if index >= 0 else None

    @cached_property
    def statement_start(self) -> int:
        """Offset at which the statement begins, or where one may begin."""
        start = self.starts[self.line - 1]
        logical = self.logical
        # A statement goes on here if no line end outside brackets lies between.
        if logical is not None and logical.start < start and "\n" not in self.masked[logical.start : self.offset]:
            start = logical.start
        depth = 0
        for position in range(start, self.offset):
            mark = self.masked[position]
            if mark in CLOSER_OF:
                depth += 1
            elif mark in _OPENER_OF:
                depth -= 1
            elif mark == ";" and depth <= 0:
                start = position + 1
        return start

    @cached_property
    def head(self) -> str:
        """The masked text of the statement before the word."""
        return self.masked[self.statement_start : self.word[0]]

    # Calls

    @cached_property
    def call(self) -> CallAt | None:
        """The innermost call around the place; None if there is none, or in the brackets of a `def`."""
        path: list[tuple[str, int]] = []
        depth = commas = 0
        first = self.statement_start
        offset = self.string.start if self.string else self.offset
        for position in range(offset - 1, first - 1, -1):
            mark = self.masked[position]
            if mark in _OPENER_OF:
                depth += 1
            elif mark in CLOSER_OF:
                if depth:
                    depth -= 1
                    continue
                before = self.masked[first:position]
                callee = _CALLEE.search(before) if mark == "(" else None
                if callee and not _DECLARATION.search(before):
                    start = first + callee.start(1)
                    function = "".join(self.text[start : first + callee.end(1)].split())
                    arguments, index = self._arguments(position, offset)
                    return CallAt(function, start, position, arguments, index, tuple(reversed(path)))
                if callee:
                    return None
                path.append((mark, commas))
                commas = 0
            elif mark == "," and not depth:
                commas += 1
        return None

    def _arguments(self, opener: int, offset: int) -> tuple[tuple[Argument, ...], int]:
        """Return the arguments behind a `(`, and the index of the one that holds an offset."""
        lines = self.lines
        # An open bracket reaches to the next statement at most.
        following = bisect_right(lines, opener, key=lambda line: line.start)
        limit = lines[following].start if following < len(lines) else len(self.masked)
        masked = self.masked[:limit]
        found: list[Argument] = []
        depth, start, index = 0, opener + 1, -1
        position = start
        while True:
            mark = masked[position : position + 1]
            is_end = mark in ("", "\n") or (mark in _OPENER_OF and depth == 0)
            if is_end or (mark == "," and depth == 0):
                found.append(_argument(masked, start, position))
                if index < 0 and offset <= position:
                    index = len(found) - 1
                start = position + 1
                if is_end:
                    break
            elif mark in CLOSER_OF:
                depth += 1
            elif mark in _OPENER_OF:
                depth -= 1
            position += 1
        return tuple(found), index if index >= 0 else len(found) - 1


def _argument(masked: str, start: int, end: int) -> Argument:
    named = _KEYWORD.match(masked, start, end)
    text = masked[start:end].strip()
    value = named.end() if named else start
    return Argument(start, end, named[1] if named else "", value, text.startswith("*"), not text)


def _is_word(character: str) -> bool:
    return is_in_word(character) or character.isalnum()
