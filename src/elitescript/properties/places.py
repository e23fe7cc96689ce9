"""Refuses expressions with their place: column, the line, and a caret below what is wrong."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.errors import UsageError

_SHOWN: Final = 76
"""Characters of a long line that are shown."""


def wrong_at(text: str, node: ast.AST | None, message: str) -> UsageError:
    """Return the refusal of a part of an expression; of the whole if the node is None."""
    lines = text.splitlines() or [""]
    number, column, end = 0, 0, len(lines[0])
    if node is not None:
        number = min(getattr(node, "lineno", 1), len(lines)) - 1
        column = _characters(lines[number], getattr(node, "col_offset", 0))
        ends_there = getattr(node, "end_lineno", None) == number + 1
        end = _characters(lines[number], getattr(node, "end_col_offset", 0)) if ends_there else len(lines[number])
    return located(lines, number, column, end, message)


def located(lines: list[str], number: int, column: int, end: int, message: str) -> UsageError:
    """Return an error with its place.

    Args:
        lines: of the expression.
        number: of the line, from 0.
        column: of the first character, from 0.
        end: of the character after the last.
        message: what is wrong.
    """
    begin = 0 if len(lines[number]) <= _SHOWN else max(0, min(column - _SHOWN // 3, len(lines[number]) - _SHOWN))
    shown = "".join(char if char.isprintable() else " " for char in lines[number][begin : begin + _SHOWN])
    width = max(1, min(end, begin + len(shown)) - column)
    place = f"column {column + 1}" if len(lines) == 1 else f"line {number + 1}, column {column + 1}"
    return UsageError(f"{place}: {message}\n  {shown}\n  {' ' * (column - begin)}{'^' * width}")


def _characters(line: str, offset: int) -> int:
    """Return a column in characters for one in bytes of UTF-8."""
    return len(line.encode(errors="surrogatepass")[:offset].decode(errors="replace"))
