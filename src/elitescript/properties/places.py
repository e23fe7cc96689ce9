"""Refuses expressions with their place: the column, the text, and a caret below what is wrong."""

from __future__ import annotations

import ast
from typing import Final

from elitescript.errors import UsageError

_SHOWN: Final = 76
"""Characters of a long text that are shown."""


def wrong_at(text: str, node: ast.AST | None, message: str) -> UsageError:
    """Return the refusal of a part of an expression of one line; of the whole if the node is None."""
    if node is None:
        return located(text, 0, len(text), message)
    begin, end = getattr(node, "col_offset", 0), getattr(node, "end_col_offset", 0)
    return located(text, _characters(text, begin), _characters(text, end), message)


def located(text: str, column: int, end: int, message: str) -> UsageError:
    """Return an error with its place.

    Args:
        text: of the expression.
        column: of the first character, from 0.
        end: of the character after the last.
        message: what is wrong.
    """
    begin = 0 if len(text) <= _SHOWN else max(0, min(column - _SHOWN // 3, len(text) - _SHOWN))
    shown = "".join(char if char.isprintable() else " " for char in text[begin : begin + _SHOWN])
    width = max(1, min(end, begin + len(shown)) - column)
    return UsageError(f"column {column + 1}: {message}\n  {shown}\n  {' ' * (column - begin)}{'^' * width}")


def _characters(text: str, offset: int) -> int:
    """Return a column in characters for one in bytes of UTF-8."""
    return len(text.encode()[:offset].decode(errors="replace"))
