"""Bounds of the text of a program, which are looked at before it is parsed.

A tree takes some 500 bytes of memory for each word and sign of the text (*measured*), so that a text of a few megabytes
would take gigabytes.
"""

from __future__ import annotations

from typing import Final

from elitescript.language.diagnostics import Diagnostic, diagnostic
from elitescript.said import said

MAX_UNIT_BYTES: Final = 16_000_000
"""Bytes of a program that a client sends; those of a file are the same (`untrusted.files.PROGRAM`)."""
LINES_MAX: Final = 200_000
"""Lines of a program."""
SYMBOLS_MAX: Final = 2_500_000
"""Words, numbers and signs of a program: 70,000 lines of `movej([...], a=1.2, v=0.8)`. What is in strings and comments
counts as well, as it is not known before the text is read."""

LONG_TEXT: Final = 8_000
"""Characters of a text that takes about as long to compile as a stop may take (*measured*: 20 ms)."""
SMALL_TEXT: Final = 500_000
"""Characters of a text for which there is memory everywhere."""

HINT: Final = "split the program, or read long lists of points from a file"

_CHUNK: Final = 1 << 17
_WORD: Final = bytes(97 if chr(byte).isalnum() or byte in b"_" or byte >= 128 else 32 for byte in range(256))
"""Each byte of a word is `a`, all others blanks."""
_SIGNS: Final = bytes(byte for byte in range(33, 127) if not (chr(byte).isalnum() or byte in b"_"))


def excess(text: str) -> Diagnostic | None:
    """Return what makes a text too large to be read; None if nothing does."""
    if (problem := excess_at_once(text)) is not None:
        return problem
    count = SymbolCount(text)
    while not count.is_over:
        count.go_on()
    return count.problem


def excess_at_once(text: str) -> Diagnostic | None:
    """Return what makes a text too large, as far as that is known within milliseconds: its bytes and its lines."""
    if len(text) > MAX_UNIT_BYTES // 4 and (size := _bytes(text)) > MAX_UNIT_BYTES:
        return _problem(1, size, "bytes", MAX_UNIT_BYTES)
    if (lines := text.count("\n") + 1) > LINES_MAX + text.endswith("\n"):
        return _problem(LINES_MAX + 1, lines - text.endswith("\n"), "lines", LINES_MAX)
    return None


class SymbolCount:
    """Counts the words and signs of a text bit by bit: of 16 MB that takes 60 ms altogether (*measured*).

    Args:
        text: of a program.

    Attributes:
        problem: that there are too many, once that is known.
    """

    __slots__ = ("_at", "_line", "_text", "_total", "problem")

    def __init__(self, text: str) -> None:
        self._text = text
        # Each of them has a character at least.
        self._at = 0 if len(text) > SYMBOLS_MAX else len(text)
        self._total = self._line = 0
        self.problem: Diagnostic | None = None

    @property
    def is_over(self) -> bool:
        """Whether everything was counted."""
        return self._at >= len(self._text)

    def go_on(self) -> None:
        """Count on, for half a millisecond or so."""
        text, at = self._text, self._at
        data = text[at : at + _CHUNK].encode("utf-8", "surrogatepass")
        self._total += (b" " + data.translate(_WORD)).count(b" a") + len(data) - len(data.translate(None, _SIGNS))
        self._at += _CHUNK
        if self._total > SYMBOLS_MAX and not self._line:
            self._line = text.count("\n", 0, at) + 1
        if self.is_over and self._total > SYMBOLS_MAX:
            self.problem = _problem(self._line, self._total, "words and signs", SYMBOLS_MAX)


def too_deep(text: str, error: BaseException, verb: str) -> str:
    """Return the words for an error that Python's parser or compiler has ended with.

    For what is nested too deeply it says that there is no memory, as it does if there is none.

    Args:
        text: of the program.
        error: it.
        verb: what could not be done with the text.
    """
    if isinstance(error, MemoryError) and len(text) > SMALL_TEXT:
        lines = text.count("\n") + 1
        return said(
            "there is too little memory for the program to be {verb}: {lines:,} lines, {bytes:,} bytes",
            verb=verb,
            lines=lines,
            bytes=_bytes(text),
        )
    return said("the program is nested too deeply to be {verb}", verb=verb)


def _problem(line: int, count: int, what: str, limit: int) -> Diagnostic:
    return diagnostic(
        "E001",
        line,
        1,
        said("the program has {count:,} {what}, at most {limit:,} are read", count=count, what=what, limit=limit),
        hint=HINT,
    )


def _bytes(text: str) -> int:
    return len(text) if text.isascii() else len(text.encode("utf-8", "surrogatepass"))
