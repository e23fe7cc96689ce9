"""Finds where strings end that signs of an input method open or close, and which of them are code."""

from __future__ import annotations

import re
from collections.abc import Generator, Iterator
from functools import cache
from itertools import chain
from typing import Final

from elitescript.language.text.lexer import MARKS, WideSign, is_in_word
from elitescript.language.text.strings import string_end_pattern
from elitescript.language.text.wide_signs import (
    BLANKS,
    CORNERS,
    DOUBLE_QUOTES,
    PLAIN,
    SINGLE_QUOTES,
    plain_of,
    plain_of_mark,
    structure_with_wide_signs,
)

_CLOSING: Final = {
    "\u201c": "\u201d",
    "\u2018": "\u2019",
    "\u301d": "\u301e",
    **dict(zip(CORNERS[::2], CORNERS[1::2], strict=True)),
}
_NUMBER: Final = r"\d+(?:\.\d+)?(?![\w.])"
_NAME: Final = r"[^\W\d]\w*"
_FAR: Final = 500
"""Characters from a mark in which the one that closes it is looked for."""
_NESTING_MAX: Final = 2
"""Fields within the format of a field; Python allows one."""
_OPENING: Final = {closing: opening for opening, closing in _CLOSING.items()}


def wide_string_end(text: str, at: int) -> tuple[int, int, str]:
    """Find the end of a string that a wide quotation mark opens.

    Args:
        text: of a program.
        at: offset of the mark.

    Returns:
        Offset of the closing mark, offset behind it, and the plain mark for both: empty if none leaves the text as it
        is, or if it is not certain that the string ends there. (-1, -1, "") if no mark of its line closes it.
    """
    marks, quote = (DOUBLE_QUOTES, '"') if text[at] in DOUBLE_QUOTES else (SINGLE_QUOTES, "'")
    if all(sign in marks for sign in text[at : at + 3]) and len(text[at : at + 3]) == 3:
        found = re.compile(f"[{marks}{quote}]{{3}}").search(text, at + 3)
        if found:
            plain = quote * 3
            return found.start(), found.end(), plain if _holds(text[at + 3 : found.start()], plain) else ""
    line_end = _line_end(text, at)
    places = _places(marks + quote, text, at + 1, line_end)
    if (partner := partner_of(text, at, line_end)) >= 0:
        inside = list(_places(marks + quote, text, at + 1, partner + 1))
        if any(
            text[place] == quote and value_may_end(text, place + 1) and (len(inside) - number) % 2
            for number, place in enumerate(inside)
        ):
            # What follows reads as strings as well: `“a" + "b”`.
            return partner, partner + 1, ""
        places = chain((partner,), places)
    for place in places:
        if value_may_end(text, place + 1):
            body = text[at + 1 : place]
            other = "'" if quote == '"' else '"'
            fitting = (mark for mark in (quote, other, quote * 3, other * 3) if _holds(body, mark))
            return place, place + 1, next(fitting, "")
    return -1, -1, ""


def _line_end(text: str, at: int) -> int:
    """Return the end of the line, or `_FAR`."""
    far = min(len(text), at + _FAR)
    line_end = text.find("\n", at, far)
    return far if line_end < 0 else line_end


def _places(marks: str, text: str, start: int, end: int) -> Iterator[int]:
    return (found.start() for found in re.compile(f"[{marks}]").finditer(text, start, end))


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
    for place in _places(marks, text, body, _line_end(text, body)):
        if not value_may_end(text, place + 1) or not _holds(text[body:place], quote):
            continue
        opening = _OPENING.get(text[place])
        if opening is None or text.count(opening, body, place) <= text.count(text[place], body, place):
            return place
    return -1


def value_may_end(text: str, at: int) -> bool:
    """Return whether what stands at an offset can follow a string."""
    return _behind_value().match(text, at) is not None


@cache
def _behind_value() -> re.Pattern[str]:
    signs = "".join(sign for sign, plain in PLAIN.items() if plain[0] in ")]},:;+-*/%.=!<>#&|^[")
    return re.compile(
        rf"""[ \t\f{BLANKS}]*(?:\Z|[\n)\]}},:;+\-*/%.=!<>#&|^\[\\{re.escape(signs)}]"""
        r"""|(?:if|else|in|is|and|or|not|for|as|from|async)\b|[rRbBuUfF]{0,2}['"])"""
        rf"""|[ \t{BLANKS}]+[rRbBuUfF]{{0,2}}[\u201c\u2018]"""
    )


def partner_of(text: str, at: int, line_end: int) -> int:
    """Return the offset of the mark that closes an opening mark, over pairs inside; -1 if none does."""
    opener = text[at]
    closer = _CLOSING.get(opener)
    if closer is None:
        return -1
    depth = 0
    for place in _places(opener + closer, text, at, line_end):
        depth += 1 if text[place] == opener else -1
        if not depth:
            return place
    return -1


def corner_brackets(text: str, at: int) -> tuple[int, str]:
    """Tell what a corner bracket in code opens.

    Args:
        text: of a program.
        at: offset of the bracket.

    Returns:
        Offset of the bracket that closes it, -1 if its line has none; and the plain sign for it: `"` for a text, `[`
        for numbers, empty if it can be either.
    """
    partner = partner_of(text, at, _line_end(text, at))
    if partner < 0:
        return -1, '"'
    body = "".join(map(plain_of, text[at + 1 : partner])).strip()
    is_index = text[at - 1 : at].isalnum() or is_in_word(text[at - 1 : at]) or text[at - 1 : at] in (")", "]")
    if (is_index or "," in body) and _all_are(_NUMBER, body):
        return partner, "["
    is_code = not body or (body.isascii() and _all_are(rf"(?:{_NUMBER}|{_NAME}(?:\.{_NAME})*)", body))
    return partner, "" if is_code else '"'


def _all_are(term: str, body: str) -> bool:
    return re.compile(rf"[-+]?{term}(?:[ \t]*[,+\-*/][ \t]*[-+]?{term})*").fullmatch(body) is not None


def wide_in_fields(text: str, body: int, end: int, quote: str) -> Iterator[WideSign]:
    """Yield the wide signs in the replacement fields of a formatted string, which are code.

    Args:
        text: of a program.
        body: offset behind the opening mark.
        end: offset of the closing mark.
        quote: the opening mark.
    """
    search = re.compile(r"\{\{|\{|[^{]+").match
    position = body
    while position < end and (found := search(text, position, end)) is not None:
        position = found.end()
        if found.group() == "{":
            position = yield from _wide_in_field(text, position, end, quote)


@cache
def _field_part() -> re.Pattern[str]:
    return re.compile(rf"{structure_with_wide_signs().pattern}|[\w{MARKS}]+|.", re.DOTALL)


def _wide_in_field(text: str, position: int, end: int, quote: str, nesting: int = 0) -> Generator[WideSign, None, int]:
    """Yield the wide signs in one field; return the offset behind it."""
    depth = 0
    while found := _field_part().match(text, position, end):
        written = found.group()
        start, position = found.span()
        if written[0] in "'\"":
            inner = string_end_pattern(written).match(text, position, end)
            if inner is None:
                return end
            position = inner.end()
            continue
        plain = plain_of_mark(written)
        if plain in ("'", '"'):
            position = yield from _wide_in_inner(text, start, end, quote)
            continue
        if plain != written:
            yield WideSign(start, position, plain)
        if plain in ("(", "[", "{"):
            depth += 1
        elif plain == "}" and not depth:
            return position
        elif plain in (")", "]", "}"):
            depth -= 1
        elif plain == ":" and not depth:
            return (yield from _wide_in_format(text, position, end, quote, nesting))
    return end


def _wide_in_format(text: str, position: int, end: int, quote: str, nesting: int) -> Generator[WideSign, None, int]:
    """Yield the wide signs behind the colon of a field: how it is written is text, but for its fields."""
    while position < end:
        sign = text[position]
        position += 1
        if sign == "{" and nesting < _NESTING_MAX:
            position = yield from _wide_in_field(text, position, end, quote, nesting + 1)
        elif sign == "}":
            break
        elif plain_of(sign) == "}" and text.find("}", position, end) < 0:
            yield WideSign(position - 1, position, "}")
            break
    return position


def _wide_in_inner(text: str, at: int, end: int, quote: str) -> Generator[WideSign, None, int]:
    """Yield the wide marks of a string in a field, which cannot have the marks of the string around it."""
    marks = DOUBLE_QUOTES if text[at] in DOUBLE_QUOTES else SINGLE_QUOTES
    far = min(end, at + _FAR)
    closer = partner_of(text, at, far)
    if closer < 0:
        closer = next(_places(marks, text, at + 1, far), -1)
    plain = "'" if quote[0] == '"' else '"'
    if closer < 0 or not _holds(text[at + 1 : closer], plain):
        return end
    yield WideSign(at, at + 1, plain)
    yield WideSign(closer, closer + 1, plain)
    return closer + 1


def _holds(body: str, quote: str) -> bool:
    """Return whether a text between two quotation marks is a string as it is."""
    if (len(body) - len(body.rstrip("\\"))) % 2:
        return False
    return quote not in body and not (len(quote) == 3 and body.endswith(quote[0]))
