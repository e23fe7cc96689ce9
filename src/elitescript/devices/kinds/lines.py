"""Texts that are cut into lines, as devices receive and send them."""

from __future__ import annotations

from typing import Final

from elitescript.devices.device import check_text
from elitescript.errors import UsageError

Answer = str | bytes | None
"""What a device returns to have it sent: a text goes out as a line, bytes as they are, None not at all."""

LINE_MAX: Final = 1 << 20
"""Bytes without a line end that are kept."""


class LineBuffer:
    """Bytes that have come, until they are a line.

    Args:
        line_end: what ends a line; if empty, everything that arrives together is one.
        encoding: of the texts.
    """

    __slots__ = ("_encoding", "_line_end", "rest")

    def __init__(self, line_end: str, encoding: str) -> None:
        self._line_end = line_end.encode(encoding)
        self._encoding = encoding
        self.rest = b""
        """The beginning of a line."""

    def receive(self, data: bytes) -> list[str]:
        """Take bytes; return the lines that are complete, without their ends."""
        self.rest += data
        if not self._line_end:
            lines, self.rest = [self.rest], b""
        else:
            *lines, self.rest = self.rest.split(self._line_end)
            self.rest = self.rest[-LINE_MAX:]
        texts = [line.decode(self._encoding, "backslashreplace") for line in lines]
        # Programs and peers of other systems end lines with \r\n.
        return [text.removesuffix("\r") for text in texts] if self._line_end == b"\n" else texts


def encoded(answer: str | bytes, line_end: str, encoding: str) -> bytes:
    """Return what goes out for an answer."""
    return bytes(answer) if isinstance(answer, bytes | bytearray) else (answer + line_end).encode(encoding)


def check_lines(line_end: object, encoding: object) -> None:
    """Refuse settings that cannot be those of lines.

    Raises:
        UsageError: they cannot; the text begins with the name of the setting.
    """
    check_text("line_end", line_end)
    check_text("encoding", encoding)
    try:
        "".encode(str(encoding))
    except LookupError:
        raise UsageError(f"encoding: there is no encoding called {encoding!r}") from None


def check_encodable(key: str, text: str, encoding: str) -> None:
    """Refuse a text that cannot be sent.

    Raises:
        UsageError: the encoding has not all of its characters; the text begins with the name of the setting.
    """
    try:
        text.encode(encoding)
    except UnicodeEncodeError as error:
        raise UsageError(
            f"{key}: {text!r} has {text[error.start]!r}, which the encoding {encoding!r} has not"
        ) from None
