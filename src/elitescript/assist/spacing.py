"""Sets the blanks between the words and signs of one row of code."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from keyword import kwlist
from typing import Final

from elitescript.language.text.lexer import name_pattern

_KEYWORDS: Final = frozenset(kwlist).difference(("True", "False", "None"))
_SOFT_HEADERS: Final = frozenset(("match", "case"))
_SIGNS: Final = frozenset(("+", "-", "*", "**", "~"))
"""Operators that may stand before a single value."""
_UNKNOWN: Final = frozenset("$?!`\\")
_ROWS_KEPT: Final = 4096


@cache
def _tokens(name: str) -> re.Pattern[str]:
    number = (
        r"0[xX][\da-fA-F_]+|0[bB][01_]+|0[oO][0-7_]+"
        r"|(?:\d[\d_]*(?:\.[\d_]*)?|\.\d[\d_]*)(?:[eE][+-]?\d[\d_]*)?[jJ]?"
    )
    signs = r"\*\*=?|//=?|>>=?|<<=?|->|:=|[-+*/%@&|^=<>!]=|\.\.\.|\S"
    return re.compile(rf'[ \t\f]*(?:({name})|({number})|("+)|({signs}))')


@lru_cache(_ROWS_KEPT)
def gaps(code: str, is_header: bool = False) -> tuple[tuple[int, int, str], ...] | None:
    """Return what changes between the tokens of a row.

    Args:
        code: masked code that begins with a statement; strings are runs of `"`.
        is_header: whether it opens a block or a clause.

    Returns:
        (start, end, blanks) for each place whose blanks are others than they should be, in their order; None for a
        row with signs that mean nothing here.
    """
    changes = []
    brackets: list[str] = []
    lambdas: list[int] = []
    is_definition = code.startswith(("def ", "def\t", "async", "sec ", "sec\t"))
    has_annotation = False
    expects_value = is_start = True
    # What stood before: nothing between it and the next token; a number; a sign of a single value; a keyword; a comma.
    glues = True
    before = ""
    position = 0
    for found in _tokens(name_pattern(code)).finditer(code):
        word, number, string, sign = found.groups()
        start = found.start(found.lastindex or 0)
        old = code[position:start]
        wanted = "" if glues else " "
        glues = False
        if word is not None:
            if word in _KEYWORDS or (is_start and is_header and word in _SOFT_HEADERS):
                expects_value = True
                if word == "lambda":
                    lambdas.append(len(brackets))
                elif word == "import" and before == ".":
                    wanted = " "
                before = "keyword"
            else:
                expects_value = False
                before = "value"
        elif number is not None:
            expects_value = False
            before = "number"
        elif string is not None:
            expects_value = False
            before = "value"
        elif sign in ("(", "[", "{"):
            is_behind_value = not expects_value
            if is_behind_value:
                wanted = ""
            brackets.append("subscript" if sign == "[" and is_behind_value else sign)
            expects_value = glues = True
            before = "open"
        elif sign in (")", "]", "}"):
            wanted = ""
            if brackets:
                brackets.pop()
            while lambdas and lambdas[-1] > len(brackets):
                lambdas.pop()
            expects_value = False
            before = "value"
        elif sign in (",", ";"):
            wanted = ""
            if sign == "," and len(brackets) == 1:
                has_annotation = False
            while lambdas and sign == ";":
                lambdas.pop()
            expects_value = True
            before = sign
        elif sign == ".":
            if before == "number":
                wanted = " " if old else ""
            elif before != "keyword":
                wanted = ""
            glues = True
            before = "."
        elif sign == "...":
            expects_value = False
            before = "value"
        elif sign == ":":
            if lambdas and lambdas[-1] == len(brackets):
                lambdas.pop()
                wanted = ""
            elif brackets and brackets[-1] == "subscript":
                if before != ",":
                    wanted = ""
                glues = True
            else:
                wanted = ""
                is_definition = is_definition and bool(brackets)
                has_annotation = is_definition and len(brackets) == 1
            expects_value = True
            before = ":"
        elif sign == "=" and (
            (lambdas and lambdas[-1] == len(brackets))
            or (brackets and brackets[-1] == "(" and not (has_annotation and len(brackets) == 1))
        ):
            wanted = ""
            expects_value = glues = True
            before = "="
        elif sign in _UNKNOWN:
            return None
        elif (expects_value and sign in _SIGNS) or (is_start and sign == "@"):
            if before == "sign":
                # Two signs without a blank may be meant as an operator of C.
                wanted = " " if old else ""
            expects_value = glues = True
            before = "sign"
        else:
            expects_value = True
            before = "operator"
        if is_start:
            wanted = ""
            is_start = False
        if old != wanted:
            changes.append((position, start, wanted))
        position = found.end()
    return tuple(changes)


def spaced(text: str, masked: str, is_header: bool = False) -> str:
    """Return a row of code with one blank around operators and behind commas, and none inside brackets.

    Args:
        text: the row; it begins with a statement, and may end in the middle of it.
        masked: the same row, masked.
        is_header: whether it opens a block or a clause.
    """
    changes = gaps(masked, is_header)
    if not changes:
        return text
    parts: list[str] = []
    position = 0
    for start, end, blanks in changes:
        parts += (text[position:start], blanks)
        position = end
    parts.append(text[position:])
    return "".join(parts)
