"""Tells which plain sign of code a sign of an input method, or of a word processor, stands for.

An input method for Chinese types its own brackets, commas, quotation marks, digits and blanks. In strings and comments
they are text; in code Python reads none of them. The lexer reads them as the plain signs, so that brackets and strings
are found as they are meant, and notes each with its place and its plain form.
"""

from __future__ import annotations

import re
from functools import cache
from keyword import iskeyword
from typing import Final

DOUBLE_QUOTES: Final = "\u201c\u201d\u201e\u201f\uff02"
SINGLE_QUOTES: Final = "\u2018\u2019\u201a\u201b\uff07"
_OPENING: Final = {"\u201c": "\u201d", "\u2018": "\u2019"}
WIDE_BLANK: Final = "\u3000"
_BLANKS: Final = "\u00a0\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u202f\u205f" + WIDE_BLANK

_PLAIN: Final = {
    **{chr(code + 0xFEE0): chr(code) for code in range(0x21, 0x7F)},
    **dict.fromkeys(_BLANKS, " "),
    **dict.fromkeys(DOUBLE_QUOTES, '"'),
    **dict.fromkeys(SINGLE_QUOTES, "'"),
    **dict.fromkeys("\u2013\u2014\u2212\ufe63", "-"),
    "\u00d7": "*",
    "\u00f7": "/",
    "\u2264": "<=",
    "\u2266": "<=",
    "\u2265": ">=",
    "\u2267": ">=",
    "\u2260": "!=",
    "\u3001": ",",
    "\u3002": ".",
    "\u3008": "<",
    "\u3009": ">",
    "\u300a": "<",
    "\u300b": ">",
    "\u3010": "[",
    "\u3011": "]",
    "\u3014": "[",
    "\u3015": "]",
    "\uff61": ".",
    "\uff64": ",",
    **dict(
        zip(
            "\ufe50\ufe52\ufe54\ufe55\ufe59\ufe5a\ufe5b\ufe5c\ufe5f\ufe60\ufe61\ufe62\ufe64\ufe65\ufe66",
            ",.;:(){}#&*+<>=",
            strict=True,
        )
    ),
}
"""By a sign, its plain form in code."""

_SIGNS: Final = "".join(sign for sign, plain in _PLAIN.items() if not (plain.isalnum() or plain == "_"))
_STATEMENT_WORDS: Final = ("end", "sec")


def plain_of(sign: str) -> str:
    """Return the plain form of a sign; the sign itself if it has none."""
    return _PLAIN.get(sign, sign)


def stand_in(sign: str) -> str:
    """Return one plain character that is read like a sign: `<` for `≤`."""
    plain = _PLAIN.get(sign, sign)
    return "<" if len(plain) > 1 else plain


def has_wide_signs(text: str) -> bool:
    """Return whether there is a sign in a text, in code or elsewhere."""
    return not text.isascii() and _any().search(text) is not None


@cache
def _any() -> re.Pattern[str]:
    return re.compile("[" + re.escape("".join(_PLAIN)) + "]")


@cache
def structure_with_wide_signs() -> re.Pattern[str]:
    """Return the pattern of what the lexer stops at in a text that has such signs; a word counts as a whole."""
    signs = re.escape(_SIGNS)
    wide = "\uff10-\uff19\uff21-\uff3a\uff41-\uff5a\uff3f"
    return re.compile(
        rf"""\#|'''|'|\"\"\"|\"|\(|\)|\[|\]|\{{|\}}|\\|\n|\w*[{wide}]\w*|(?<=\w)\u2014\u2014(?=\w)|[{signs}]"""
    )


@cache
def blank_with_wide_signs() -> re.Pattern[str]:
    """Return the pattern of the blanks before a line."""
    return re.compile(rf"[ \t\f{_BLANKS}]*")


def plain_word(word: str) -> str:
    """Return a number or word in plain characters; the word itself if Python reads it as it is.

    Python takes a name in wide letters for the same name in plain ones, but reads no keyword and no number in them.
    """
    plain = "".join(map(plain_of, word))
    if plain[:1].isdigit() or iskeyword(plain) or plain in _STATEMENT_WORDS or not word.isidentifier():
        return plain
    return word


def wide_string_end(text: str, at: int) -> tuple[int, int, str]:
    """Find the end of a string that a wide quotation mark opens.

    Args:
        text: of a program.
        at: offset of the mark.

    Returns:
        Offset of the closing mark, offset behind it, and the plain mark for both: empty if none leaves the text as it
        is. (-1, -1, "") if no mark of its line closes it.
    """
    marks, quote = (DOUBLE_QUOTES, '"') if text[at] in DOUBLE_QUOTES else (SINGLE_QUOTES, "'")
    closers = marks + quote
    if all(sign in marks for sign in text[at : at + 3]) and len(text[at : at + 3]) == 3:
        found = re.compile(f"[{closers}]{{3}}").search(text, at + 3)
        if found:
            plain = quote * 3
            return found.start(), found.end(), plain if _holds(text[at + 3 : found.start()], plain) else ""
    line_end = text.find("\n", at)
    line_end = len(text) if line_end < 0 else line_end
    places = [place for place in range(at + 1, line_end) if text[place] in closers]
    if (partner := _partner(text, at, line_end)) >= 0:
        places.insert(0, partner)
    for place in places:
        if value_may_end(text, place + 1):
            body = text[at + 1 : place]
            other = "'" if quote == '"' else '"'
            fitting = (mark for mark in (quote, other, quote * 3, other * 3) if _holds(body, mark))
            return place, place + 1, next(fitting, "")
    return -1, -1, ""


def wide_closer(text: str, body: int, end: int, quote: str) -> int:
    """Return the offset of the wide mark that closes a string with a plain opening mark; -1 if none does.

    Args:
        text: of a program.
        body: offset behind the opening mark.
        end: offset behind the plain closing mark; -1 if its line has none.
        quote: the opening mark.
    """
    if end >= 0 and value_may_end(text, end):
        return -1
    marks = DOUBLE_QUOTES if quote == '"' else SINGLE_QUOTES
    line_end = text.find("\n", body)
    for place in range(body, len(text) if line_end < 0 else line_end):
        if text[place] in marks and value_may_end(text, place + 1) and _holds(text[body:place], quote):
            return place
    return -1


def value_may_end(text: str, at: int) -> bool:
    """Return whether what stands at an offset can follow a string."""
    return _behind_value().match(text, at) is not None


@cache
def _behind_value() -> re.Pattern[str]:
    signs = "".join(sign for sign, plain in _PLAIN.items() if plain[0] in ")]},:;+-*/%.=!<>#&|^[")
    return re.compile(
        rf"""[ \t\f{_BLANKS}]*(?:\Z|[\n)\]}},:;+\-*/%.=!<>#&|^\[\\{re.escape(signs)}]"""
        r"""|(?:if|else|in|is|and|or|not|for|as|from|async)\b|[rRbBuUfF]{0,2}['"])"""
        rf"""|[ \t{_BLANKS}]+[rRbBuUfF]{{0,2}}[\u201c\u2018]"""
    )


def _partner(text: str, at: int, line_end: int) -> int:
    """Return the offset of the mark that closes an opening mark, over pairs inside; -1 if none does."""
    opener = text[at]
    closer = _OPENING.get(opener)
    if closer is None:
        return -1
    depth = 0
    for place in range(at, line_end):
        depth += (text[place] == opener) - (text[place] == closer)
        if not depth:
            return place
    return -1


def _holds(body: str, quote: str) -> bool:
    """Return whether a text between two quotation marks is a string as it is."""
    if (len(body) - len(body.rstrip("\\"))) % 2:
        return False
    return quote not in body and not (len(quote) == 3 and body.endswith(quote[0]))
