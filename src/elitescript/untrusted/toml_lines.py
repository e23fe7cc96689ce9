"""Where the keys of a TOML text are: `tomllib` gives values without lines."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from elitescript.untrusted.plain_text import without_mark

Path = tuple[str | int, ...]
"""Keys, and numbers of list elements from 0: `("tcp", 1, "replies", 0, "to")`."""

_CONTENTS: Final = {
    "'''": re.compile(r"(?:[^']++|'(?!''))*+"),
    '"""': re.compile(r'(?:[^"\\]++|\\.|"(?!""))*+', re.DOTALL),
    "'": re.compile(r"[^']*+"),
    '"': re.compile(r'(?:[^"\\]++|\\.)*+', re.DOTALL),
}
"""What stands between quotes, longest quotes first."""

_BLANK: Final = re.compile(r"(?:[ \t\n]++|#[^\n]*+)*+")
_BARE_VALUE: Final = re.compile(r"[^,\]}#\n]*+")
_BARE_PART: Final = {end: re.compile(rf"[^\{end}\"'. \t\n]++") for end in "]="}
"""A part of a key without quotes, by the character behind the key."""


def lines_of(text: str) -> dict[Path, int]:
    """Return the line, from 1, of every table, key and list element.

    Args:
        text: TOML that `tomllib` accepts; of other texts the lines make no sense.
    """
    return _TomlScanner(text).scan()


def nearest(lines: Mapping[Path, int], path: Path) -> int:
    """Return the line of a path, or of the nearest one above it; 1 if there is none."""
    while path and path not in lines:
        path = path[:-1]
    return lines.get(path, 1)


def line_of_refusal(text: str, error: Exception) -> int:
    """Return the line, from 1, at which `tomllib` gave up on a text."""
    found = re.search(r"\(at line (\d+)", str(error))
    if found:
        return int(found[1])
    if "end of document" in str(error):
        return max(1, len(text.splitlines()))
    # A number with too many digits, or too many brackets: the line that has most of them.
    numbered = enumerate(text.splitlines(), 1)
    return max(numbered, key=lambda row: len(re.sub(r"[^0-9\[{]", "", row[1])), default=(1, ""))[0]


class _TomlScanner:
    """One pass over the text."""

    __slots__ = ("_at", "_counts", "_line", "_lines", "_text")

    def __init__(self, text: str) -> None:
        self._text = without_mark(text).replace("\r\n", "\n")
        self._at = 0
        self._line = 1
        self._lines: dict[Path, int] = {}
        self._counts: dict[Path, int] = {}
        """How many `[[...]]` tables there have been, by path."""

    def scan(self) -> dict[Path, int]:
        table: Path = ()
        while self._blank():
            if self._peek() == "[":
                table = self._header()
            else:
                self._assignment(table)
        return self._lines

    def _peek(self) -> str:
        return self._text[self._at : self._at + 1]

    def _step(self, size: int = 1) -> str:
        passed = self._text[self._at : self._at + size]
        self._line += passed.count("\n")
        self._at += size
        return passed

    def _blank(self) -> bool:
        """Pass white space and comments; return whether something follows."""
        found = _BLANK.match(self._text, self._at)
        if found is not None:
            self._step(len(found[0]))
        return bool(self._peek())

    def _string(self) -> str:
        """Pass a string and return what is between its quotes, escapes as they are written."""
        quote = next(quote for quote in _CONTENTS if self._text.startswith(quote, self._at))
        self._step(len(quote))
        found = _CONTENTS[quote].match(self._text, self._at)
        content = found[0] if found is not None else ""
        self._step(len(content) + len(quote))
        while len(quote) == 3 and self._peek() == quote[0]:
            self._step()  # a string in three quotes may end with up to two more of them
        return content

    def _key(self, ends: str) -> list[str]:
        """Pass a dotted key up to one of some characters."""
        parts = [""]
        while (here := self._peek()) and here not in ends:
            if here in "\"'":
                parts[-1] = self._string()
            elif here == ".":
                parts.append("")
                self._step()
            elif here in " \t\n":
                self._step()
            else:
                parts[-1] += self._step(len(_BARE_PART[ends].match(self._text, self._at)[0]))  # type: ignore[index]
        self._step()
        return parts

    def _header(self) -> Path:
        line = self._line
        self._step()
        is_list = self._peek() == "["
        if is_list:
            self._step()
        *parents, last = self._key("]")
        if is_list:
            self._step()
        path: Path = ()
        for part in parents:
            path = self._inside((*path, part))
            self._lines.setdefault(path, line)
        path = (*path, last)
        self._lines.setdefault(path, line)
        if is_list:
            self._counts[path] = self._counts.get(path, 0) + 1
        path = self._inside(path)
        self._lines[path] = line
        return path

    def _inside(self, path: Path) -> Path:
        """Return the last table of a list of tables, or the table itself."""
        return (*path, self._counts[path] - 1) if path in self._counts else path

    def _assignment(self, table: Path) -> None:
        line = self._line
        path = table
        for part in self._key("="):
            path = (*path, part)
            self._lines.setdefault(path, line)
        self._blank()
        self._value(path)

    def _value(self, path: Path) -> None:
        self._lines.setdefault(path, self._line)
        here = self._peek()
        if here and here in "\"'":
            self._string()
        elif here == "[":
            self._step()
            number = 0
            while self._blank() and self._peek() != "]":
                if self._peek() == ",":
                    self._step()
                else:
                    self._value((*path, number))
                    number += 1
            self._step()
        elif here == "{":
            self._step()
            while self._blank() and self._peek() != "}":
                if self._peek() == ",":
                    self._step()
                else:
                    self._assignment(path)
            self._step()
        else:
            found = _BARE_VALUE.match(self._text, self._at)
            self._step(len(found[0]) if found is not None else 1)
