"""Converts places between texts and the protocol: nothing else in this package counts in code units.

The protocol counts lines and characters from 0, and characters in units of an encoding that client and server agree
on; UTF-16 if they do not. A place outside the text is moved into it, one inside a character to its beginning.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from lsprotocol.types import Position, PositionEncodingKind, Range, TextEdit

from elitescript.assist.document import Document
from elitescript.language.diagnostics import Edit
from elitescript.language.text.source import BOM
from elitescript.lint.program import Span

UTF8: Final = PositionEncodingKind.Utf8.value
UTF16: Final = PositionEncodingKind.Utf16.value
UTF32: Final = PositionEncodingKind.Utf32.value
ENCODINGS: Final = (UTF16, UTF8, UTF32)
"""Those that can be agreed on; the first one without an agreement."""

_LAST_OF_ONE_UNIT: Final = "\uffff"


def chosen_encoding(offered: Iterable[str] | None) -> str:
    """Return the first encoding of a client's list that this server has; UTF-16 if there is none."""
    return next((name for name in offered or () if name in ENCODINGS), UTF16)


def units(text: str, encoding: str) -> int:
    """Return the length of a text in units of an encoding."""
    if encoding == UTF32 or text.isascii():
        return len(text)
    if encoding == UTF8:
        return len(text.encode("utf-8", "surrogatepass"))
    return len(text) + sum(character > _LAST_OF_ONE_UNIT for character in text)


def characters(text: str, count: int, encoding: str) -> int:
    """Return how many whole characters the first `count` units of a text are."""
    if encoding == UTF32 or text.isascii():
        return min(max(count, 0), len(text))
    passed = 0
    for index, character in enumerate(text):
        passed += units(character, encoding)
        if passed > count:
            return index
    return len(text)


class Positions:
    """Converts places of one version of a text.

    A byte order mark counts as the first character of its line in the protocol, since clients that keep it count it,
    and is column 0 here.

    Args:
        document: the text.
        encoding: what the client counts in.
    """

    __slots__ = ("_encoding", "_mark", "document")

    def __init__(self, document: Document, encoding: str) -> None:
        self.document = document
        self._encoding = encoding
        self._mark = units(BOM, encoding) if document.text.startswith(BOM) else 0

    # ---------------------------------------------------------------- from the client

    def place(self, position: Position) -> tuple[int, int]:
        """Return line and column, from 1."""
        line = position.line + 1
        if line > self.document.line_count:
            line = self.document.line_count
            return line, len(self.document.line(line)) + 1
        count = position.character
        if line == 1 and self._mark:
            if count < self._mark:
                return 1, 0
            count -= self._mark
        return line, characters(self.document.line(line), count, self._encoding) + 1

    def span(self, place: Range) -> Span:
        """Return a range of the text."""
        return Span(*self.place(place.start), *self.place(place.end))

    # ---------------------------------------------------------------- to the client

    def position(self, line: int, column: int) -> Position:
        """Return the position of a line and column, from 1."""
        count = units(self.document.line(line)[: max(column - 1, 0)], self._encoding)
        if line == 1 and column > 0:
            count += self._mark
        return Position(line - 1, count)

    def range(self, span: Span) -> Range:
        """Return the range of a span."""
        return Range(self.position(span.line, span.column), self.position(span.end_line, span.end_column))

    def length(self, line: int, column: int, count: int) -> int:
        """Return the length in units of so many characters from a place on."""
        return units(self.document.line(line)[column - 1 : column - 1 + count], self._encoding)

    def text_edit(self, edit: Edit) -> TextEdit:
        """Return an edit of the text."""
        start, end = self.position(edit.line, edit.column), self.position(edit.end_line, edit.end_column)
        return TextEdit(Range(start, end), self.with_line_ends(edit.text))

    def with_line_ends(self, text: str) -> str:
        """Return a new piece of text with the line ends that the document has."""
        if "\n" not in text:
            return text
        old = self.document.text
        first = old.find("\r")
        if first < 0 or 0 <= old.find("\n") < first:
            return text
        return text.replace("\n", "\r\n" if old[first + 1 : first + 2] == "\n" else "\r")
