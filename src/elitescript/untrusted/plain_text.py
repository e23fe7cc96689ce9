"""Makes text of bytes that people saved as UTF-8, with the byte order mark of Windows or without."""

from __future__ import annotations

from typing import Final

_UTF16: Final = (b"\xff\xfe", b"\xfe\xff")
_MARK: Final = b"\xef\xbb\xbf"


class EncodingError(ValueError):
    """Bytes are no UTF-8.

    Args:
        why: without the place in lines.
        at: where, in bytes from 0.
        line: where, from 1.
        is_utf_16: whether they are UTF-16.
    """

    def __init__(self, why: str, at: int, line: int, *, is_utf_16: bool = False) -> None:
        super().__init__(why)
        self.why = why
        self.at = at
        self.line = line
        self.is_utf_16 = is_utf_16


def plain_text(data: bytes) -> str:
    """Return the text of bytes in UTF-8, without the byte order mark that editors of Windows put in front.

    Raises:
        EncodingError: they are none.
    """
    # Without a mark, every other byte of plain letters is 0.
    if data.startswith(_UTF16) or (len(data) >= 4 and b"\0\0" in (data[:4:2], data[1:4:2])):
        raise EncodingError("it is UTF-16; save it as UTF-8", 0, 1, is_utf_16=True)
    try:
        return data.removeprefix(_MARK).decode()
    except UnicodeDecodeError as error:
        at = error.start + len(data) - len(error.object)
        raise EncodingError(f"{error.reason} at byte {at}", at, data.count(b"\n", 0, at) + 1) from None


def without_mark(text: str) -> str:
    """Return a text without its byte order mark."""
    return text.removeprefix("\ufeff")
