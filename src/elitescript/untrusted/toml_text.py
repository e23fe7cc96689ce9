"""Parses TOML that others wrote: its bounds are looked at before it is parsed, and refusals name file and line.

`tomllib` is written in Python and recursive: a value of 20 MB keeps it busy for many seconds, and a header of 5,000
parts gives tables within each other that no code can walk.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any, Final

from elitescript.errors import UsageError
from elitescript.untrusted.plain_text import without_mark
from elitescript.untrusted.toml_lines import Path, line_of_refusal, lines_of, nearest

DEPTH_MAX: Final = 32
"""Lists and tables within each other."""

PARTS_MAX: Final = 32
"""Parts of a key with dots, and of a header."""

TOKENS_MAX: Final = 300_000
"""Words, signs, comments and blanks of a file: 50,000 keys with numbers, 100,000 elements of lists."""

LINES_MAX: Final = 100_000

STRING_MAX: Final = 250_000
"""Characters of a string."""

WORD_MAX: Final = 400
"""Characters of a number, a date or a key without quotes."""

_TOKENS: Final = r"""
    "{3}(?:[^"\\]++|\\.|"(?!""))*+(?:"{3})?+ | '{3}(?:[^']++|'(?!''))*+(?:'{3})?+
    | "(?:[^"\\\n]++|\\.)*+"?+ | '[^'\n]*+'?+
    | [ \t\r]++ | \n[ \t\r\n]*+ | \#[^\n]*+
    | [\[\]{}=,]
    | [^\s\[\]{}=,"'\#]++
"""


def toml_tables(text: str, file: str, noun: str) -> dict[str, Any]:
    """Return the tables of a text of TOML.

    Args:
        text: of a file.
        file: its name, for messages.
        noun: what it is, for messages, as `world file`.

    Raises:
        UsageError: it is none, or beyond the bounds; the text names file and line, value and limit.
    """
    import tomllib

    text = without_mark(text)
    _check_bounds(text, file, noun)
    try:
        tables = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        # A number of thousands of digits, and brackets that are not closed, are found by the bounds.
        hint = '; names with an index stand in quotes: "standard_digital_in[3]" = true' if _has_bare_index(text) else ""
        raise UsageError(f"{file}:{line_of_refusal(text, error)}: the {noun} is not TOML: {error}{hint}") from None
    _check_values(tables, text, file)
    return tables


def _check_bounds(text: str, file: str, noun: str) -> None:
    """Refuse a text that would take long to parse, in one quick pass over its words."""

    def refuse(at: int, why: str) -> UsageError:
        line = text.count("\n", 0, at) + 1
        return UsageError(f"{file}:{line}: {why}")

    if (lines := text.count("\n")) >= LINES_MAX:
        raise UsageError(f"{file}: the {noun} has {lines + 1} lines; at most {LINES_MAX} are read")
    depth = parts = 0
    for count, found in enumerate(re.finditer(_TOKENS, text, re.VERBOSE | re.DOTALL)):
        token = found[0]
        first = token[0]
        if first in "\"'":
            if len(token) > STRING_MAX:
                raise refuse(found.start(), f"a text of {len(token)} characters; at most {STRING_MAX} are read")
        elif first in "[{":
            depth += 1
            parts = 0
            if depth > DEPTH_MAX:
                raise refuse(found.start(), f"it is nested too deeply: at most {DEPTH_MAX} brackets within each other")
        elif first in "]}=,":
            depth -= first in "]}"
            parts = 0
        elif first == "\n":
            parts = 0
        elif first not in " \t\r#":
            parts += token.count(".")
            if parts >= PARTS_MAX:
                raise refuse(
                    found.start(), f"a name of {parts + 1} parts with dots between; at most {PARTS_MAX} are read"
                )
            if len(token) > WORD_MAX:
                what = "number" if first in "+-0123456789" else "word"
                raise refuse(found.start(), f"a {what} of {len(token)} characters; at most {WORD_MAX} are read")
        if count >= TOKENS_MAX:
            raise refuse(found.start(), f"the {noun} goes on behind {TOKENS_MAX} words and signs, which is the limit")


def _check_values(tables: Mapping[str, Any], text: str, file: str) -> None:
    """Refuse tables within each other beyond the bound, and whole numbers that no float and no other reader has."""
    left: list[tuple[Any, Any, int]] = [(tables, None, 0)]
    while left:
        value, place, depth = left.pop()
        kind = type(value)
        if kind is int:
            if not -(2**63) <= value < 2**63:
                path = _path(place)
                raise UsageError(f"{file}:{_line(text, path)}: {path[-1]}: whole numbers of TOML are within 64 bits")
            continue
        items: Iterable[tuple[str | int, Any]]
        if kind is dict:
            items = value.items()
        elif kind is list:
            items = enumerate(value)
        else:
            continue
        if depth > 2 * DEPTH_MAX:
            raise UsageError(
                f"{file}:{_line(text, _path(place))}: it is nested too deeply: "
                f"at most {2 * DEPTH_MAX} tables and lists within each other"
            )
        left.extend((item, (place, key), depth + 1) for key, item in items)


def _line(text: str, path: Path) -> int:
    return nearest(lines_of(text), path)


def _path(place: Any) -> Path:
    found = []
    while place is not None:
        place, key = place
        found.append(key)
    return tuple(reversed(found))


def _has_bare_index(text: str) -> bool:
    """Return whether a text has `standard_digital_in[3] = true`, in which the name must be in quotes."""
    return re.search(r"^\s*\w+\[\d+\]\s*=", text, re.MULTILINE) is not None
