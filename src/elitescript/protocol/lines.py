"""Cuts a byte stream into lines, for the text ports."""

from __future__ import annotations

from typing import Final

from elitescript.records import record
from elitescript.shown import encodable

SHOWN: Final = 60
"""Characters of a peer's text that an answer repeats."""


@record
class TextLine:
    """One line without its end."""

    text: str
    """Decoded as UTF-8, invalid bytes as the replacement character; of a line that is too long, its beginning."""
    problem: str = ""
    """Why the line is invalid; empty if it is not."""


class LineSplitter:
    """Collects bytes until a line feed; a carriage return before it is tolerated.

    A line over the limit is reported once, as soon as it is; its rest is dropped. Bytes after the last line feed are
    not a line.

    Args:
        limit: of a line, in bytes, without its end.
    """

    __slots__ = ("_buffer", "_is_skipping", "limit")

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self._buffer = bytearray()
        self._is_skipping = False

    @property
    def held(self) -> int:
        """Number of bytes of the line that has begun, at most the limit and a carriage return."""
        return len(self._buffer)

    def feed(self, data: bytes) -> list[TextLine]:
        """Take the next bytes; return the lines that end in them."""
        lines: list[TextLine] = []
        start = 0
        while (end := data.find(b"\n", start)) >= 0:
            self._add(data[start:end], lines, is_whole=True)
            start = end + 1
        self._add(data[start:], lines, is_whole=False)
        return lines

    def _add(self, part: bytes, lines: list[TextLine], *, is_whole: bool) -> None:
        if not self._is_skipping:
            # One byte above the limit may be the carriage return; a second one shows that it is not.
            self._buffer += part[: self.limit + 2 - len(self._buffer)]
            content = self._buffer.removesuffix(b"\r")
            if len(content) > self.limit:
                beginning = bytes(content[: self.limit]).decode("utf-8", "replace")
                lines.append(TextLine(beginning, f"the line is longer than {self.limit} bytes"))
                self._buffer.clear()
                self._is_skipping = True
            elif is_whole:
                lines.append(_decoded(bytes(content)))
                self._buffer.clear()
        if is_whole:
            self._is_skipping = False


class PacedLines:
    """The lines of a client, with a limit for each tick; the bytes behind them wait.

    Args:
        limit: of a line, in bytes, without its end.
        per_tick: lines in a tick.
    """

    __slots__ = ("_left", "_per_tick", "_raw", "_splitter", "_tick")

    def __init__(self, limit: int, per_tick: int) -> None:
        self._splitter = LineSplitter(limit)
        self._per_tick = self._left = per_tick
        self._raw = bytearray()
        self._tick = -1

    @property
    def is_waiting(self) -> bool:
        """Whether bytes wait for the next tick, so that no more should be read from the client."""
        return bool(self._raw)

    def feed(self, data: bytes) -> None:
        """Take the next bytes."""
        self._raw += data

    def take(self, tick: int) -> list[TextLine]:
        """Return further lines, as many as the tick allows."""
        if tick != self._tick:
            self._tick, self._left = tick, self._per_tick
        end = 0
        while self._left > 0 and end < len(self._raw):
            end = self._raw.find(b"\n", end) + 1 or len(self._raw)
            self._left -= self._raw[end - 1] == 0x0A
        return self._cut(end)

    def renew(self) -> None:
        """Allow as many lines again in this tick."""
        self._left = self._per_tick

    def rest(self) -> list[TextLine]:
        """Return all lines that wait."""
        return self._cut(len(self._raw))

    def _cut(self, end: int) -> list[TextLine]:
        piece = bytes(self._raw[:end])
        del self._raw[:end]
        return self._splitter.feed(piece)


def shown(text: str) -> str:
    """Return a peer's text for an answer: shortened and printable."""
    clean = "".join(char if char.isprintable() else "?" for char in text[:SHOWN])
    return clean if len(text) <= SHOWN else clean + "..."


def text_bytes(text: str) -> bytes:
    """Return a text for a client: UTF-8, halves of surrogate pairs, which programs may hold, as escapes."""
    return encodable(text).encode()


def one_line(text: str) -> str:
    """Return the text without line breaks, for replies that are one line."""
    return " ".join(text.splitlines()) if "\n" in text or "\r" in text else text


def _decoded(content: bytes) -> TextLine:
    try:
        return TextLine(content.decode("utf-8"))
    except UnicodeDecodeError as error:
        from elitescript.text_encoding import as_gbk

        reads = as_gbk(content)
        why = f"the line is not UTF-8 at byte {error.start}"
        return TextLine(content.decode("utf-8", "replace"), why if reads is None else f"{why}; as GBK it is {reads!r}")
