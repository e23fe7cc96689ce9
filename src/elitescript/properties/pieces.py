"""Parts of a checked expression: what kind of value each has, how it is computed, how far it is from its edge."""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping, Sequence
from math import inf, isnan
from typing import Any, Final

from elitescript.properties.units import Unit
from elitescript.properties.verdicts import Undefined
from elitescript.records import NamedTuple

Value = Callable[[Any], Any]
"""Computes the value of a part for a moment, or for the record of a run."""

Margin = Callable[[Any], float]
"""Computes how far a part is from the other answer, > 0 if it holds; infinite where no number of this unit matters."""

NUMBER: Final = "a number"
LEVEL: Final = "a level"
"""Of a digital signal: true or false, and 1 or 0 in sums."""
TRUTH: Final = "true or false"
TEXT: Final = "a text"
LIST: Final = "a list"
TABLE: Final = "a table"
NONE: Final = "None"
ANY: Final = "any value"
"""What a program puts in a global is known at the end of a run alone."""

NUMBERS: Final = frozenset({NUMBER, LEVEL})
SIZED: Final = frozenset({TEXT, LIST, TABLE})


class MarginKey(NamedTuple):
    """What a margin is measured in: margins of two keys are never compared with each other."""

    unit: Unit
    of: str
    """What is compared, if it has no unit of its own: each register and each global has an own key."""


class Piece(NamedTuple):
    """A checked part of an expression."""

    node: ast.expr
    kind: str
    value: Value
    unit: Unit = None
    margins: Mapping[MarginKey, Margin] = {}
    """Of something that is true or false; a part without numbers has none."""
    items: Sequence[Piece] | None = None
    """Of a list of known length: what each item is."""
    keys: Mapping[str, tuple[str, Unit]] | None = None
    """Of a list of tables, or a table: kind and unit of the entries by their names."""
    constant: Any = ast
    """Value of a literal; the module `ast` for what is none."""

    @property
    def is_literal(self) -> bool:
        """Whether it is a literal."""
        return self.constant is not ast


def margin_of(piece: Piece, key: MarginKey) -> Margin:
    """Return the margin of a part for a key; infinite, by its answer, if none of its numbers is of that key."""
    margin = piece.margins.get(key)
    if margin is not None:
        return margin
    value = piece.value
    return lambda x: inf if value(x) else -inf


def all_of(values: Sequence[Value]) -> Value:
    """Return `a and b and ...`; later parts are not computed once one is false."""
    if len(values) == 2:
        first, second = values
        return lambda x: first(x) and second(x)
    return lambda x: all(value(x) for value in values)


def any_of(values: Sequence[Value]) -> Value:
    """Return `a or b or ...`; later parts are not computed once one is true."""
    if len(values) == 2:
        first, second = values
        return lambda x: first(x) or second(x)
    return lambda x: any(value(x) for value in values)


def least(margins: Sequence[Margin]) -> Margin:
    """Return the margin of `a and b and ...`."""
    if len(margins) == 1:
        return margins[0]
    if len(margins) == 2:
        first, second = margins

        def lesser(x: Any) -> float:
            a, b = first(x), second(x)
            return a if a <= b else b

        return lesser
    return lambda x: min([margin(x) for margin in margins])


def greatest(margins: Sequence[Margin]) -> Margin:
    """Return the margin of `a or b or ...`."""
    if len(margins) == 1:
        return margins[0]
    if len(margins) == 2:
        first, second = margins

        def greater(x: Any) -> float:
            a, b = first(x), second(x)
            return a if a >= b else b

        return greater
    return lambda x: max([margin(x) for margin in margins])


def opposite(margin: Margin) -> Margin:
    """Return the margin of `not a`."""
    return lambda x: 0.0 - margin(x)


def keys_of(pieces: Sequence[Piece]) -> tuple[MarginKey, ...]:
    """Return the keys of several parts in the order of the text."""
    return tuple(dict.fromkeys(key for piece in pieces for key in piece.margins))


def number(value: Any, what: str) -> Any:
    """Return a value if it is a number.

    Raises:
        Undefined: it is none, or no finite one.
    """
    if type(value) not in _NUMBER_TYPES:
        raise Undefined(f"{what} is {shown(value)}, no number")
    if type(value) is float and isnan(value):
        raise Undefined(f"{what} is no number (nan)")
    return value


def truth(value: Any, what: str) -> bool:
    """Return a value as true or false, if it is a number.

    Raises:
        Undefined: it is none.
    """
    if type(value) not in _NUMBER_TYPES:
        raise Undefined(f"{what} is {shown(value)}, not true or false")
    return bool(value)


def shown(value: Any) -> str:
    """Return a value for people, cut to a short text."""
    if type(value) is float:
        return f"{value:.6g}"
    if type(value) is int and abs(value) >= _LONG_INT:
        return "a number of many digits"
    if isinstance(value, frozenset):
        return f"a set of {len(value)}"
    if isinstance(value, list | dict) and len(value) > _MANY:
        return f"{'a list' if isinstance(value, list) else 'a table'} of {len(value)}"
    if isinstance(value, list):
        return f"[{', '.join(map(shown, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{shown(key)}: {shown(item)}" for key, item in value.items()) + "}"
    text = repr(value[:_LONG_TEXT] if isinstance(value, str) else value)
    return text + " ..." if isinstance(value, str) and len(value) > _LONG_TEXT else text


_NUMBER_TYPES: Final = frozenset({bool, int, float})
_LONG_INT: Final = 10**30
_LONG_TEXT: Final = 60
_MANY: Final = 8
