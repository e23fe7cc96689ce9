"""Narrows descriptions by what a condition says of them. What would leave nothing changes nothing.

So what stands behind a condition that is never true is described as if the condition was not there.
"""

from __future__ import annotations

import ast
from math import inf
from typing import Final

from elitescript.values.description import (
    FLOAT,
    FUNCTION,
    INT,
    NONE,
    NUMBER,
    OBJECT,
    SCALAR,
    SIZE_MAX,
    TYPES,
    WHOLE,
    Shape,
    Value,
    kind_of,
)
from elitescript.values.plain import OPPOSITE

_CLASSES: Final = {kind.__name__: (bits if kind is not int else WHOLE) for kind, bits in TYPES.items()}
"""Kinds by the name of the class: a bool is an int."""


def with_kinds(value: Value, kinds: int) -> Value:
    """Return a description with some of its kinds alone."""
    kinds &= value.kinds
    if kinds == value.kinds or not kinds:
        return value
    changes: dict[str, object] = {"kinds": kinds}
    if value.constants is not None:
        changes["constants"] = tuple(known for known in value.constants if kind_of(known) & kinds)
    elif not kinds & SCALAR:
        changes["constants"] = ()
    elif kinds == NONE:
        changes["constants"] = (None,)
    if not kinds & NUMBER:
        changes["low"], changes["high"] = inf, -inf
    if not kinds & (FUNCTION | OBJECT):
        changes["refs"] = ()
    if not kinds & ~(SCALAR | FUNCTION):
        changes["shape"] = None
    return value.but(**changes)


def by_truth(value: Value, outcome: bool) -> Value:
    """Return a description of a value that is true, or not, in a condition."""
    kinds = value.kinds & ~(NONE if outcome else FUNCTION)
    value = with_kinds(value, kinds)
    if value.constants is not None and value.constants:
        left = tuple(known for known in value.constants if bool(known) is outcome)
        if left and len(left) < len(value.constants):
            return _of(value, left)
    if not outcome and value.kinds and not value.kinds & ~(NUMBER | NONE) and value.kinds & NUMBER:
        return value.but(low=0, high=0) if value.low <= 0 <= value.high else value
    return value


def _of(value: Value, constants: tuple[object, ...]) -> Value:
    """Return a description with fewer constants."""
    kinds = value.kinds & ~SCALAR
    numbers: list[float] = []
    for known in constants:
        kinds |= kind_of(known)
        if isinstance(known, (bool, int, float)):
            numbers.append(known)
    if not kinds:
        return value
    if any(number != number for number in numbers):
        low, high = -inf, inf
    else:
        low, high = min(numbers, default=inf), max(numbers, default=-inf)
    return value.but(kinds=kinds, constants=constants, low=low, high=high)


def by_comparison(op: type[ast.cmpop], value: Value, other: Value, outcome: bool) -> Value:
    """Return a description of the left side of a comparison that came out true, or not."""
    if not value.kinds or not other.kinds:
        return value
    if not outcome:
        is_order = op not in (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)
        # With a NaN `x < 1` and `x >= 1` are both false.
        if op not in OPPOSITE or (is_order and (_may_be_nan(value) or _may_be_nan(other))):
            return value
        op = OPPOSITE[op]
    if op in (ast.Is, ast.Eq):
        return _equal(value, other)
    if op in (ast.IsNot, ast.NotEq):
        return _different(value, other)
    if (value.kinds | other.kinds) & OBJECT or other.kinds & ~NUMBER:
        return value
    value = with_kinds(value, NUMBER)
    if value.kinds & ~NUMBER:
        return value
    is_whole = not (value.kinds | other.kinds) & FLOAT
    low, high = value.low, value.high
    if op is ast.Lt:
        high = min(high, other.high - 1 if is_whole else other.high)
    elif op is ast.LtE:
        high = min(high, other.high)
    elif op is ast.Gt:
        low = max(low, other.low + 1 if is_whole else other.low)
    elif op is ast.GtE:
        low = max(low, other.low)
    else:
        return value
    return _between(value, low, high)


def _may_be_nan(value: Value) -> bool:
    return bool(value.kinds & FLOAT) and value.low == -inf and value.high == inf


def _between(value: Value, low: float, high: float) -> Value:
    """Return a description of a number within bounds; the same if nothing is within them."""
    if low > high:
        return value
    if value.constants is not None:
        left = tuple(known for known in value.constants if known is not None and low <= known <= high)
        return _of(value, left) if left else value
    if low == high and value.kinds == INT:
        return value.but(low=low, high=high, constants=(low,))
    return value.but(low=low, high=high)


def _equal(value: Value, other: Value) -> Value:
    if (value.kinds | other.kinds) & OBJECT:
        # An object may be equal to anything.
        return with_kinds(value, NONE | OBJECT) if other.kinds == NONE and not value.kinds & OBJECT else value
    kinds = other.kinds | (NUMBER if other.kinds & NUMBER else 0)
    value = with_kinds(value, kinds)
    if value.kinds & ~SCALAR:
        return value
    if value.constants is not None and other.constants is not None:
        left = tuple(known for known in value.constants if known in other.constants)
        return _of(value, left) if left else value
    if not (value.kinds | other.kinds) & ~NUMBER:
        if other.constants is not None and value.kinds == other.kinds:
            within = tuple(known for known in other.constants if value.low <= known <= value.high)
            return _of(value, within) if within else value
        return _between(value, max(value.low, other.low), min(value.high, other.high))
    if other.constants is not None and value.constants is None and value.kinds == other.kinds:
        return _of(value, other.constants)
    return value


def _different(value: Value, other: Value) -> Value:
    if other.kinds == NONE:
        return with_kinds(value, value.kinds & ~NONE)
    if not other.has_constant or value.kinds & OBJECT:
        return value
    unwanted = other.constant
    if value.constants is not None and not value.kinds & ~SCALAR:
        left = tuple(known for known in value.constants if known != unwanted)
        return _of(value, left) if left and len(left) < len(value.constants) else value
    if not value.kinds & ~WHOLE and type(unwanted) is int:
        if value.low == unwanted:
            return _between(value, unwanted + 1, value.high)
        if value.high == unwanted:
            return _between(value, value.low, unwanted - 1)
    return value


def by_length(value: Value, op: type[ast.cmpop], other: Value, outcome: bool) -> Value:
    """Return a description of a list or tuple whose length was compared."""
    shape = value.shape
    if shape is None or other.kinds & ~WHOLE:
        return value
    length = by_comparison(op, Value(INT, shape.least, shape.most), other, outcome)
    if length.low == shape.least and length.high == shape.most:
        return value
    if length.low == length.high and shape.items is None and length.low <= SIZE_MAX:
        items = (shape.element,) * int(length.low)
        return value.but(shape=Shape(items, is_counted=shape.is_counted))
    if shape.items is None:
        return value.but(shape=Shape(None, shape.element, length.low, length.high, shape.is_counted))
    return value


def by_item(value: Value, index: int, op: type[ast.cmpop], other: Value, outcome: bool) -> Value:
    """Return a description of a list or tuple with an element that was compared."""
    shape = value.shape
    if shape is None or shape.items is None or not -len(shape.items) <= index < len(shape.items):
        return value
    old = shape.items[index]
    new = by_comparison(op, old, other, outcome)
    if new is old:
        return value
    items = list(shape.items)
    items[index] = new
    return value.but(shape=Shape(tuple(items), is_counted=shape.is_counted))


def by_class(value: Value, names: tuple[str, ...], outcome: bool) -> Value:
    """Return a description of a value that is of one of some classes, or of none of them."""
    if any(name not in _CLASSES for name in names):
        return value
    bits = 0
    for name in names:
        bits |= _CLASSES[name]
    # An object may be of a class that is derived from one of them.
    return with_kinds(value, bits | OBJECT if outcome else value.kinds & ~bits)
