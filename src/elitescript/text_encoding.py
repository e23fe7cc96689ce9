"""Recognises in which encoding a text was saved that should be UTF-8.

Editors and cameras of Chinese systems use GBK, Notepad offers UTF-16. GBK is recognised by its characters: those of a
Chinese text are nearly all in GB 2312, and most of them among its 3,755 common ones, which bytes of another encoding
hardly are.
"""

from __future__ import annotations

import re
from typing import Final

GBK: Final = "GBK"
UTF16: Final = "UTF-16"

_CODEC: Final = "gb18030"
_MARKS: Final = ((b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be"))
_SEEN: Final = 4_000
"""Bytes that are looked at to find UTF-16 without its mark."""

_USUAL: Final = (
    r"[\u00a1-\u017f\u01a0\u01a1\u01af\u01b0]",
    r"[\u0386-\u03ce]",
    r"[\u0401\u0410-\u044f\u0451\u0404\u0406\u0407\u0454\u0456\u0457\u0490\u0491]",
    r"[\u0531-\u0587]",
    r"[\u05d0-\u05ea]",
    r"[\u060c\u061b\u061f\u0621-\u064a\u0660-\u0669]",
)
"""Characters of scripts of two bytes in UTF-8 that texts hold.

Latin with Vietnamese, Greek, Cyrillic, Armenian, Hebrew, Arabic.
"""


def decoded_from(data: bytes) -> tuple[str, str] | None:
    """Return the text that bytes are in another encoding than UTF-8, and the name of the encoding.

    None: they are UTF-8, or nothing known.
    """
    if (text := as_utf_16(data)) is not None:
        return text, UTF16
    if (text := as_gbk(data)) is not None:
        return text, GBK
    return None


def as_utf_16(data: bytes) -> str | None:
    """Return the text that bytes are in UTF-16; None if they have no mark of it and do not look like it."""
    for mark, codec in _MARKS:
        if data.startswith(mark):
            return _text(data.removeprefix(mark), codec)
    part = data[:_SEEN]
    for at, codec in ((1, "utf-16-le"), (0, "utf-16-be")):
        # Blanks, line ends and names are ASCII, whose upper byte is zero. Few characters have a lower byte of zero.
        upper, lower = part[at::2].count(0), part[1 - at :: 2].count(0)
        if upper * 4 > len(part) // 2 and lower * 8 <= upper and (text := _text(data, codec)) is not None:
            return text
    return None


def as_gbk(data: bytes | bytearray) -> str | None:
    """Return the text that bytes are in GBK; None if they are UTF-8, or no likely text in GBK."""
    try:
        data.decode()
    except UnicodeDecodeError:
        return _likely(bytes(data))
    return None


def by_chance(text: str) -> str | None:
    """Return the Chinese text that was saved as GBK and is UTF-8 by chance, as of `停止`; None if none was."""
    if text.isascii():
        return None
    strange = [sign for sign in text if not sign.isascii()]
    if any(sign > "\u07ff" for sign in strange):
        return None
    usual = max(sum(re.match(script, sign) is not None for sign in strange) for script in _USUAL)
    if usual * 2 > len(strange):
        return None
    return _likely(text.encode("utf-8", "replace"), least=1.0)


def likely_gbk(data: bytes) -> str | None:
    """Return the text that was received in GBK, also if it is UTF-8 by chance or was cut in the last character."""
    for part in (data, data[:-1]):
        try:
            return by_chance(part.decode())
        except UnicodeDecodeError:
            if (text := as_gbk(part)) is not None:
                return text
    return None


def _text(data: bytes, codec: str) -> str | None:
    try:
        text = data.decode(codec)
    except UnicodeDecodeError:
        return None
    return None if "\0" in text else text


def _likely(data: bytes, least: float = 0.75) -> str | None:
    """Return bytes as GBK, if at least this part of the characters is in GB 2312 and half are common ones or signs."""
    try:
        text = data.decode(_CODEC)
    except UnicodeDecodeError:
        return None
    codes = [sign.encode("gb2312", "ignore") for sign in text if not sign.isascii()]
    known = sum(bool(code) for code in codes)
    common = sum(b"\xa1" <= code[:1] <= b"\xa3" or b"\xb0" <= code[:1] <= b"\xd7" for code in codes)
    return text if codes and known >= least * len(codes) and common * 2 >= len(codes) else None
