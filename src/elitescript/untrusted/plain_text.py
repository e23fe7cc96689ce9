"""Makes text of bytes that people saved as UTF-8, with the byte order mark of Windows or without."""

from __future__ import annotations

from typing import Final

_UTF16: Final = (b"\xff\xfe", b"\xfe\xff")
_MARK: Final = b"\xef\xbb\xbf"
_SEEN: Final = 4_000
"""Bytes in which a zero is looked for, as UTF-16 without a mark has."""


class EncodingError(ValueError):
    """Bytes are no UTF-8.

    Args:
        why: without the place in lines.
        at: where, in bytes from 0.
        line: where, from 1.
        encoding: in which they are, as `GBK`; empty if that is not known.
    """

    def __init__(self, why: str, at: int, line: int, encoding: str = "") -> None:
        super().__init__(why)
        self.why = why
        self.at = at
        self.line = line
        self.encoding = encoding


def plain_text(data: bytes) -> str:
    """Return the text of bytes in UTF-8, without the byte order mark that editors of Windows put in front.

    Raises:
        EncodingError: they are none.
    """
    if data.startswith(_UTF16) or (b"\0" in data[:_SEEN] and _is_utf_16(data)):
        raise EncodingError("it is UTF-16; save it as UTF-8", 0, 1, "UTF-16")
    try:
        return data.removeprefix(_MARK).decode()
    except UnicodeDecodeError as error:
        at = error.start + len(data) - len(error.object)
        line = data.count(b"\n", 0, at) + 1
        from elitescript.text_encoding import GBK, as_gbk

        if as_gbk(data) is not None:
            raise EncodingError(f"it is {GBK}; save it as UTF-8", at, line, GBK) from None
        raise EncodingError(f"{error.reason} at byte {at}", at, line) from None


def _is_utf_16(data: bytes) -> bool:
    from elitescript.text_encoding import as_utf_16

    return as_utf_16(data) is not None


def without_mark(text: str) -> str:
    """Return a text without its byte order mark."""
    return text.removeprefix("\ufeff")
