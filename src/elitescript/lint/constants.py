"""Gives the values that are certain before the run, as plain values: a view of `values`."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

from elitescript.commands.definition.plausibility import Range
from elitescript.language.symbols import Scope

if TYPE_CHECKING:
    from elitescript.values.description import Value
    from elitescript.values.program import Values

_EXACT_KINDS: Final = (bool, int, float, str, bytes, type(None))


class Unknown:
    """A value that is not known before the run; `text` is its source text."""

    __slots__ = ("text",)

    def __init__(self, text: str = "...") -> None:
        self.text = text


UNKNOWN: Final = Unknown()


class Constants:
    """Values of expressions of one program.

    Args:
        values: returns the descriptions; called when an expression is no literal, because evaluating a program takes
            longer than reading literals.
    """

    __slots__ = ("_known", "_values")

    def __init__(self, values: Callable[[], Values]) -> None:
        self._values = values
        self._known: dict[ast.expr, Any] = {}
        """Of expressions that were asked for: several rules ask for each argument."""

    def value(self, node: ast.expr, scope: Scope) -> Any:
        """Return the value of an expression, or an `Unknown`. A list or tuple may hold `Unknown` elements."""
        if type(node) is ast.Constant:
            return node.value if isinstance(node.value, _EXACT_KINDS) else UNKNOWN
        value = self._known.get(node, self)
        if value is self:
            value = self._known[node] = self._value(node, scope)
        return value

    def _value(self, node: ast.expr, scope: Scope) -> Any:
        literal = _literal(node)
        if literal is not UNKNOWN:
            return literal
        value = self.plain(self._values().evaluated(node, scope))
        if isinstance(value, (list, tuple)) and value and all(item is UNKNOWN for item in value):
            return UNKNOWN
        return value

    def bounds(self, node: ast.expr, scope: Scope) -> Any:
        """Return the value of an expression as `value` does, but a `Range` for a number of which a range is known."""
        value = self.value(node, scope)
        parts = value if isinstance(value, (list, tuple)) else (value,)
        if Unknown not in map(type, parts):
            return value
        return self.plain(self._values().evaluated(node, scope), has_ranges=True)

    def plain(self, value: Value, *, has_ranges: bool = False) -> Any:
        """Return the only value that a description allows, or an `Unknown`; or a `Range` that excludes 0."""
        if value.has_constant:
            return value.constant
        if has_ranges and value.is_number and not value.low <= 0 <= value.high:
            return Range(value.low, value.high) if value.low > 0 else Range(value.high, value.low)
        items = value.items
        if items is None:
            return UNKNOWN if value.node is None else Unknown(self._text(value.node))
        found = [self.plain(item, has_ranges=has_ranges) for item in items]
        return found if value.is_list else tuple(found)

    def _text(self, node: ast.expr) -> str:
        symbols = self._values().symbols
        line, column, end_line, end_column = symbols.range_of(node)
        return symbols.parsed.source.line(line)[column - 1 : end_column - 1] if line == end_line else "..."


def _literal(node: ast.expr) -> Any:
    """Return the value of a literal; `UNKNOWN` for anything else."""
    kind = type(node)
    if kind is ast.Constant:
        value = node.value  # type: ignore[attr-defined]
        return value if isinstance(value, _EXACT_KINDS) else UNKNOWN
    if isinstance(node, ast.UnaryOp):
        if type(node.op) is not ast.USub or type(node.operand) is not ast.Constant:
            return UNKNOWN
        number: Any = node.operand.value
        return -number if type(number) in (int, float) else UNKNOWN
    if isinstance(node, (ast.List, ast.Tuple)):
        items = []
        for element in node.elts:
            # Poses and joint positions are most of a program.
            item = element.value if type(element) is ast.Constant else _literal(element)
            if item is UNKNOWN or (not isinstance(item, _EXACT_KINDS) and type(element) is ast.Constant):
                return UNKNOWN
            items.append(item)
        return items if kind is ast.List else tuple(items)
    return UNKNOWN
