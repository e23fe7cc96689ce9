"""Finds where string literals begin and end."""

from __future__ import annotations

import re
from functools import cache

_MAX_NESTING = 8
"""Deepest nesting of formatted strings that is followed."""


@cache
def string_end_pattern(quote: str) -> re.Pattern[str]:
    if len(quote) == 3:
        mark = quote[0]
        plain = rf"[^{mark}\\]*+"
        return re.compile(rf"{plain}(?:(?:\\.|{mark}(?!{mark}{mark})){plain})*+{quote}", re.DOTALL)
    plain = rf"[^{quote}\\\n]*+"
    return re.compile(rf"{plain}(?:\\.{plain})*+{quote}", re.DOTALL)


def prefix_start(text: str, quote_at: int) -> int:
    start = quote_at
    while start > 0 and quote_at - start < 2 and text[start - 1] in "rRbBuUfF":
        start -= 1
    before = text[start - 1 : start]
    if before and (before.isalnum() or ("a" + before).isidentifier()):
        return quote_at
    return start


def formatted_end(text: str, position: int, quote: str, nesting: int = 0, in_spec: bool = False) -> int:
    """Return the end of the literal part of a formatted string: behind `quote`, or at the `}` of a field."""
    while position < len(text):
        character = text[position]
        if character == "\\":
            position += 2
        elif text.startswith(quote, position):
            return -1 if in_spec else position + len(quote)
        elif character == "\n" and len(quote) == 1:
            return -1
        elif character == "}" and in_spec:
            return position
        elif character == "{" and not in_spec and text[position + 1 : position + 2] == "{":
            position += 2
        elif character == "{":
            position = _field_end(text, position + 1, quote, nesting + 1)
            if position < 0:
                return -1
        else:
            position += 1
    return -1


def _field_end(text: str, position: int, quote: str, nesting: int) -> int:
    """Return the end of a replacement field, behind its `}`; -1 if it is not closed."""
    if nesting > _MAX_NESTING:
        return -1
    depth = 0
    while position < len(text):
        character = text[position]
        if character in "'\"":
            inner = character * 3 if text.startswith(character * 3, position) else character
            prefix = text[prefix_start(text, position) : position].lower()
            position += len(inner)
            if "f" in prefix:
                position = formatted_end(text, position, inner, nesting + 1)
            else:
                found = string_end_pattern(inner).match(text, position)
                position = found.end() if found else -1
            if position < 0:
                return -1
            continue
        if character in "([{":
            depth += 1
        elif character == "}" and depth == 0:
            return position + 1
        elif character in ")]}":
            depth -= 1
        elif character == ":" and depth == 0:
            end = formatted_end(text, position + 1, quote, nesting, in_spec=True)
            return -1 if end < 0 else end + 1
        elif character == "\n" and len(quote) == 1:
            return -1
        position += 1
    return -1
