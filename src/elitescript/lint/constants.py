"""Gives the values that are certain before the run, as plain values: a view of `values`."""

from __future__ import annotations

import ast
from typing import Any, Final

from elitescript.language.symbols import Scope
from elitescript.values.description import LIST, TUPLE, Value
from elitescript.values.program import Values


class Unknown:
    """A value that is not known before the run; `text` is its source text."""

    __slots__ = ("text",)

    def __init__(self, text: str = "...") -> None:
        self.text = text


UNKNOWN: Final = Unknown()


class Constants:
    """Values of expressions of one program."""

    __slots__ = ("_values",)

    def __init__(self, values: Values) -> None:
        self._values = values

    def value(self, node: ast.expr, scope: Scope) -> Any:
        """Return the value of an expression, or an `Unknown`. A list or tuple may hold `Unknown` elements."""
        value = self.plain(self._values.evaluated(node, scope))
        if isinstance(value, (list, tuple)) and value and all(item is UNKNOWN for item in value):
            return UNKNOWN
        return value

    def plain(self, value: Value) -> Any:
        """Return the only value that a description allows, or an `Unknown`."""
        if value.has_constant:
            return value.constant
        shape = value.shape
        if value.kinds not in (LIST, TUPLE) or shape is None or shape.items is None:
            return UNKNOWN if value.node is None else Unknown(self._text(value.node))
        items = [self.plain(item) for item in shape.items]
        return items if value.kinds == LIST else tuple(items)

    def _text(self, node: ast.expr) -> str:
        symbols = self._values.symbols
        line, column, end_line, end_column = symbols.range_of(node)
        return symbols.parsed.source.line(line)[column - 1 : end_column - 1] if line == end_line else "..."
