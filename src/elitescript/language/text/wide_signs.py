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

CORNERS: Final = "\u300c\u300d\u300e\u300f\ufe41\ufe42\ufe43\ufe44"
"""Quotation marks of Traditional Chinese; Japanese input methods type the first two for brackets."""
DOUBLE_QUOTES: Final = "\u201c\u201d\u201e\u201f\uff02\u301d\u301e\u301f" + CORNERS
SINGLE_QUOTES: Final = "\u2018\u2019\u201a\u201b\uff07"
WIDE_BLANK: Final = "\u3000"
DASHES: Final = "\u2014\u2014"
BLANKS: Final = "\u00a0\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u202f\u205f" + WIDE_BLANK

PLAIN: Final = {
    **{chr(code + 0xFEE0): chr(code) for code in range(0x21, 0x7F)},
    **dict.fromkeys(BLANKS, " "),
    **dict.fromkeys(DOUBLE_QUOTES, '"'),
    **dict.fromkeys(SINGLE_QUOTES, "'"),
    **dict.fromkeys("\u2010\u2011\u2013\u2014\u2015\u2212\u30fc\ufe63", "-"),
    **dict.fromkeys("\u00d7\u2217\u22c5", "*"),
    **dict.fromkeys("\u00f7\u2044\u2215", "/"),
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
    "\u3016": "[",
    "\u3017": "]",
    "\u301a": "[",
    "\u301b": "]",
    "\ufe5d": "[",
    "\ufe5e": "]",
    "\uff5f": "(",
    "\uff60": ")",
    "\uff61": ".",
    "\uff64": ",",
    **dict(
        zip(
            "\ufe50\ufe52\ufe54\ufe55\ufe57\ufe59\ufe5a\ufe5b\ufe5c\ufe5f\ufe60\ufe61\ufe62\ufe64\ufe65\ufe66\ufe68\ufe6a\ufe6b",
            ",.;:!(){}#&*+<>=\\%@",
            strict=True,
        )
    ),
}
"""By a sign, its plain form in code."""

LONG_VOWEL: Final = "\u30fc"
"""The minus of Japanese input methods; behind a letter it is a letter itself."""
_SIGNS: Final = "".join(
    sign for sign, plain in PLAIN.items() if not (plain.isalnum() or plain == "_" or sign == LONG_VOWEL)
)
_STATEMENT_WORDS: Final = ("end", "sec")


def plain_of(sign: str) -> str:
    """Return the plain form of a sign; the sign itself if it has none."""
    return PLAIN.get(sign, sign)


def stand_in(sign: str) -> str:
    """Return one plain character that is read like a sign: `<` for `≤`."""
    plain = PLAIN.get(sign, sign)
    return "<" if len(plain) > 1 else plain


def has_wide_signs(text: str) -> bool:
    """Return whether there is a sign in a text, in code or elsewhere."""
    return not text.isascii() and _any().search(text) is not None


@cache
def _any() -> re.Pattern[str]:
    return re.compile("[" + re.escape("".join(PLAIN)) + "]")


@cache
def structure_with_wide_signs() -> re.Pattern[str]:
    """Return the pattern of what the lexer stops at in a text that has such signs; a word counts as a whole."""
    signs = re.escape(_SIGNS)
    wide = "\uff10-\uff19\uff21-\uff3a\uff41-\uff5a\uff3f"
    # A word is looked at from its start alone, so that a long one takes no longer than its length.
    words = rf"{DASHES}|(?<![^\W\d]){LONG_VOWEL}|(?<={LONG_VOWEL})[{wide}]\w*|(?<!\w)\w*[{wide}]\w*"
    return re.compile(rf"""\#|'''|'|\"\"\"|\"|\(|\)|\[|\]|\{{|\}}|\\|\n|{words}|[{signs}]""")


@cache
def blank_with_wide_signs() -> re.Pattern[str]:
    """Return the pattern of the blanks before a line."""
    return re.compile(rf"[ \t\f{BLANKS}]*")


def plain_word(word: str) -> str:
    """Return a number or word in plain characters; the word itself if Python reads it as it is.

    Python takes a name in wide letters for the same name in plain ones, but reads no keyword and no number in them.
    """
    plain = "".join(map(plain_of, word))
    if plain[:1].isdigit() or iskeyword(plain) or plain in _STATEMENT_WORDS or not word.isidentifier():
        return plain
    return word


def plain_of_mark(mark: str) -> str:
    """Return the plain form of what `structure_with_wide_signs` has found."""
    if mark == DASHES:
        # An input method types two dashes for the underscore.
        return "_"
    return plain_word(mark) if mark[0].isalnum() and mark != LONG_VOWEL else plain_of(mark)
