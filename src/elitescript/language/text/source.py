"""Holds the text of a program and its lines, and makes repairs in it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Final

from elitescript.errors import ProgramError
from elitescript.language.diagnostics import Diagnostic, Fix, diagnostic
from elitescript.records import field, record
from elitescript.said import said
from elitescript.shown import shown, shown_word
from elitescript.untrusted.plain_text import EncodingError, plain_text

BOM = "\ufeff"
_READS: Final = 60
"""Characters of a line that are shown in the encoding that it is in."""


@record
class TreeFacts:
    """What a script does not say of the tree from which it was generated.

    Attributes:
        arm: name of the arm for which it was made; empty: it does not say it.
        unset: variables whose lack of a value the notes of the text have told.
        installation: variables of the installation: the name of each and that in the script.
        task: variables of the task, in the same form.
        file_line: returns the line of the file in which the node of a line of the script begins.
    """

    arm: str = ""
    unset: tuple[str, ...] = ()
    installation: tuple[tuple[str, str], ...] = ()
    task: tuple[tuple[str, str], ...] = ()
    file_line: Callable[[int], int] | None = field(default=None, repr=False, compare=False)


@record
class SourceFile:
    """Holds a text under a name.

    Line ends become LF and a leading byte order mark is dropped, so that a line is what an
    editor shows as one and columns count the characters that the author sees.

    Attributes:
        places: of the script of a graphical program, the node of each line, as people say it; empty for a line that
            belongs to none. A text that was written by hand has none at all.
        notes: what is known of the text besides: of the graphical program that it was generated from.
        tree: of the script of a graphical program, what is known of its tree.
    """

    name: str
    text: str
    places: tuple[str, ...] = field(default=(), repr=False, compare=False)
    notes: tuple[Diagnostic, ...] = field(default=(), repr=False, compare=False)
    tree: TreeFacts | None = field(default=None, repr=False, compare=False)
    lines: tuple[str, ...] = field(init=False, repr=False, compare=False)

    @property
    def arm(self) -> str:
        """Name of the arm for which a graphical program was made; empty: it says none, or is a script."""
        return "" if self.tree is None else self.tree.arm

    def __post_init__(self) -> None:
        text = self.text.removeprefix(BOM)
        if "\r" in text:
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "lines", tuple(text.split("\n")))

    @classmethod
    def from_bytes(cls, name: str, data: bytes) -> SourceFile:
        """Decode a file; a byte order mark is no part of the text.

        Raises:
            ProgramError: E002 at the first byte that is not UTF-8.
        """
        try:
            return cls(name, plain_text(data))
        except EncodingError as error:
            raise ProgramError((_bad_byte(data, error),), name) from None

    @classmethod
    def to_show(cls, name: str, data: bytes) -> SourceFile:
        """Return a file that `from_bytes` may refuse: in the encoding that it is in, or with bytes replaced."""
        try:
            return cls.from_bytes(name, data)
        except ProgramError:
            from elitescript.text_encoding import decoded_from

            other = decoded_from(data)
            return cls(name, data.decode("utf-8", "replace") if other is None else other[0])

    def line(self, n: int) -> str:
        """Return the line `n`, counted from 1, without its line end; empty outside the text."""
        return self.lines[n - 1] if 1 <= n <= len(self.lines) else ""

    def place(self, n: int) -> str:
        """Return the node of a graphical program to which the line `n` belongs; empty, if it belongs to none."""
        return self.places[n - 1] if 1 <= n <= len(self.places) else ""

    def file_line(self, n: int) -> int:
        """Return the line of the file that has the line `n`: of a graphical program, that in which its node begins."""
        return n if self.tree is None or self.tree.file_line is None else self.tree.file_line(n)

    def where(self, line: int, column: int = 0) -> str:
        """Return a place as reports begin with it: `FILE:LINE:COLUMN`, or `FILE: NODE (script line LINE)`."""
        if self.places:
            node = self.place(line)
            return f"{shown_word(self.name)}: {shown(node)} (script line {line})" if node else self._script_line(line)
        return f"{shown_word(self.name)}:{line}:{column}" if column else f"{shown_word(self.name)}:{line}"

    def line_words(self, line: int) -> str:
        """Return a line as sentences name it: `line 12`, or `10 MoveJ > 11 Home (script line 12)`."""
        if node := self.place(line):
            return f"{shown(node)} (script line {line})"
        return f"script line {line}" if self.places else f"line {line}"

    def _script_line(self, line: int) -> str:
        return f"{shown_word(self.name)}: script line {line}"


def apply_fixes(text: str, fixes: Iterable[Fix]) -> str:
    """Return `text` with the edits of `fixes` made.

    Args:
        text: the text that was examined, with its own line ends and perhaps a byte order mark.
        fixes: repairs whose edits do not overlap.
    """
    mark = BOM if text.startswith(BOM) else ""
    body = text[len(mark) :]
    starts = [0, *(found.end() for found in re.finditer(r"\r\n|\r|\n", body)), len(body)]
    first = re.search(r"\r\n|\r|\n", body)
    line_end = first[0] if first else "\n"
    for edit in sorted((edit for fix in fixes for edit in fix.edits), reverse=True):
        start = starts[edit.line - 1] + edit.column - 1
        end = starts[edit.end_line - 1] + edit.end_column - 1
        body = body[:start] + edit.text.replace("\n", line_end) + body[end:]
    return mark + body


def _bad_byte(data: bytes, error: EncodingError) -> Diagnostic:
    lines = SourceFile("", data[: error.at].decode("utf-8")).lines
    from elitescript.text_encoding import decoded_from

    line, column = len(lines), len(lines[-1]) + 1
    other = decoded_from(data) if error.encoding else None
    if other is None:
        text = said("byte 0x{data:02X} is not UTF-8 text", data=data[error.at])
        if error.encoding:
            text = said("the text is {encoding}, not UTF-8", encoding=error.encoding)
        return diagnostic("E002", line, column, text, hint="save the file as UTF-8")
    reads = SourceFile("", other[0]).line(line).strip()
    reads = reads if len(reads) <= _READS else f"{reads[:_READS]}..."
    text = said("the text is {encoding}, not UTF-8: this line reads `{reads}`", encoding=error.encoding, reads=reads)
    hint = "`elitescript check --fix` converts the file to UTF-8; or save it as UTF-8 in the editor"
    return diagnostic("E002", line, column, text, hint=hint)


def find_word(row: str, word: str, start: int = 0) -> int:
    """Return the index of the first place of a line, from `start` on, where a word stands by itself; -1 if none."""
    place = row.find(word, start)
    while place >= 0:
        end = place + len(word)
        if (place == start or not _is_of_words(row[place - 1])) and (end == len(row) or not _is_of_words(row[end])):
            return place
        place = row.find(word, place + 1)
    return -1


def _is_of_words(sign: str) -> bool:
    return sign.isalnum() or sign == "_"
