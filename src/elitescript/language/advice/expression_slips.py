"""Explains signs of other languages in what is no expression: of world files, sweeps and debuggers."""

from __future__ import annotations

import re
from typing import Final

from elitescript.language.advice.unknown_names import WORDS
from elitescript.records import NamedTuple
from elitescript.said import said

_LOGIC: Final = {"&&": "and", "||": "or", "!": "not", "AND": "and", "OR": "or", "NOT": "not", "XOR": "!="}
_COMPARISONS: Final = {"===": "==", "!==": "!=", "<>": "!=", "=": "==", "=<": "<=", "=>": ">=", ":=": "=="}
_SIGNS: Final = {**_LOGIC, **_COMPARISONS}
_FOUND: Final = re.compile(r"""'[^']*'?|"[^"]*"?|!==|===|[=!<>]=|<>|=<|=>|:=|&&|\|\||[!=?]|\b(?:AND|OR|NOT|XOR)\b""")
_KEYWORD: Final = re.compile(r"""(?<![\w.])(global[.\[]\s*["']?(\w+)["']?\]?)""")
_FINE: Final = ("==", "!=", "<=", ">=")


class Slip(NamedTuple):
    """A sign or word of another language.

    Attributes:
        start, end: where it stands, in characters from 0.
        text: what is wrong, and what to write.
    """

    start: int
    end: int
    text: str


def slip(text: str) -> Slip | None:
    """Return the first sign of another language in a text that is no expression; None if there is none."""
    for found in _FOUND.finditer(text):
        sign = found.group()
        if sign[0] in "'\"" or sign in _FINE:
            continue
        if sign == "?":
            return Slip(*found.span(), "write `a if condition else b` for `condition ? a : b`")
        what = "compares" if sign in _COMPARISONS else "joins conditions"
        what = "says that a condition is not true" if _SIGNS[sign] == "not" else what
        return Slip(
            *found.span(),
            said("write `{signs}` instead of `{sign}`: it {what}", signs=_SIGNS[sign], sign=sign, what=what),
        )
    word = _KEYWORD.search(text)
    return None if word is None else Slip(*word.span(1), said('write globals["{group}"]', group=word.group(2)))


def plain_word(name: str) -> str:
    """Return the word of Python for one of another language, as `True` for `true`; empty for any other name."""
    return WORDS.get(name, "")
