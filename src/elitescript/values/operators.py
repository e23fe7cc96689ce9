"""Operators of programs over descriptions of values; those over plain values are in `plain`."""

from __future__ import annotations

import ast
from collections.abc import Callable
from math import inf
from typing import Any, Final

from elitescript.values.description import (
    _CARRIED,
    BOOL,
    BOTTOM,
    BYTES,
    COMPUTED,
    CONSTANTS_MAX,
    DICT,
    FLOAT,
    FUNCTION,
    INT,
    JOINED,
    LIST,
    LITERAL,
    MEASURED,
    NO_SITES,
    NONE,
    NUMBER,
    OBJECT,
    RANGE,
    ROW,
    SCALAR,
    SET,
    SIZE_MAX,
    SOME_BOOL,
    TEXT,
    TUPLE,
    UNKNOWN,
    WHOLE,
    Shape,
    Value,
    constant,
    join,
    of_constants,
    unknown_of,
)
from elitescript.values.plain import COMPARISONS, UNARY, Impossible, checked, compute

# Descriptions


def unary(op: ast.unaryop, value: Value) -> Value:
    """Return what an operator with one operand gives."""
    if not value.kinds:
        return BOTTOM
    if isinstance(op, ast.Not):
        known = truth(value)
        return SOME_BOOL if known is None else constant(not known, value.may, value.must)
    if not value.kinds & ~NUMBER and value.constants is not None:
        return _each(lambda number: checked(UNARY[type(op)](number)), value)
    if value.kinds & ~NUMBER:
        return UNKNOWN
    kinds = (INT if value.kinds & WHOLE else 0) | (value.kinds & FLOAT)
    may, must = value.may | COMPUTED, _carried(value.must)
    if isinstance(op, ast.UAdd):
        return Value(kinds, value.low, value.high, None, value.role, may, must)
    if isinstance(op, ast.USub):
        return Value(kinds, -value.high, -value.low, None, value.role, may, must)
    return Value(INT, -inf, inf, None, "", may, must) if not value.kinds & FLOAT else UNKNOWN


def _each(function: Callable[[Any], Any], value: Value) -> Value:
    results = []
    for number in value.constants or ():
        try:
            results.append(function(number))
        except (Impossible, ArithmeticError, TypeError, ValueError):
            continue
    if not results:
        return UNKNOWN
    found = of_constants(results, value.may, value.must)
    return found.but(role=value.role) if value.role else found


def binary(op: ast.operator, left: Value, right: Value, site: frozenset[int] = NO_SITES, node: Any = None) -> Value:
    """Return what an operator with two operands gives.

    Args:
        op: the operator.
        left, right: the operands.
        site: of the list that it makes, if it makes one.
        node: its expression.
    """
    if not left.kinds or not right.kinds:
        return BOTTOM
    both = left.kinds | right.kinds
    if not both & ~SCALAR and left.constants is not None and right.constants is not None:
        found = _of_all_constants(op, left, right)
        if found is not None:
            return found
    if not both & ~NUMBER:
        return _arithmetic(op, left, right)
    if both & OBJECT:
        # An object may define any operator.
        return unknown_of(left, right)
    return _of_other_kinds(op, left, right, site, node)


def _of_all_constants(op: ast.operator, left: Value, right: Value) -> Value | None:
    """Return what an operator gives for each pair of constants; None if these are too many, or if one is too large."""
    assert left.constants is not None and right.constants is not None
    if len(left.constants) * len(right.constants) > 2 * CONSTANTS_MAX:
        return None
    results: list[Any] = []
    for one in left.constants:
        for other in right.constants:
            try:
                results.append(compute(op, one, other))
            except Impossible:
                return None
    may, must = _origins(left, right)
    found = of_constants(results, may, must)
    role = _role(op, left, right)
    if found.constants is None:
        found = found.but(must=must, may=may)
    return found.but(role=role) if role else found


def _carried(must: int) -> int:
    return must & (_CARRIED | LITERAL) or COMPUTED


def _origins(left: Value, right: Value) -> tuple[int, int]:
    may = left.may | right.may
    must = (left.must | right.must) & _CARRIED
    if left.must & right.must & LITERAL:
        return may, must | LITERAL
    if not must & MEASURED or (left.may | right.may) & COMPUTED:
        may |= COMPUTED
    return may, must or COMPUTED


def _role(op: ast.operator, left: Value, right: Value) -> str:
    """Return the role of a number that is computed: times and lengths stay what they are in sums and with factors."""
    one, other = left.role, right.role
    if isinstance(op, (ast.Add, ast.Sub)):
        if one == other:
            return one
        if one and not other and right.must & LITERAL:
            return one
        return other if other and not one and left.must & LITERAL else ""
    if isinstance(op, ast.Mult):
        return one if not other and _is_factor(right) else other if not one and _is_factor(left) else ""
    if isinstance(op, ast.Div):
        return one if not other and _is_factor(right) else ""
    return ""


_MOST_FACTOR: Final = 20
"""A number is multiplied with or divided by more to bring it into another unit: 1000 for mm, 57.3 for degrees."""


def _is_factor(value: Value) -> bool:
    """Return whether a number leaves the unit of what is multiplied with it as it is."""
    most = max(abs(value.low), abs(value.high))
    return bool(value.must & LITERAL) and most <= _MOST_FACTOR and not (value.has_constant and most * _MOST_FACTOR < 1)


def _arithmetic(op: ast.operator, left: Value, right: Value) -> Value:
    """Return what an operator gives for numbers."""
    may, must = _origins(left, right)
    has_float = (left.kinds | right.kinds) & FLOAT
    kinds = (INT if left.kinds & WHOLE and right.kinds & WHOLE else 0) | has_float
    low, high = -inf, inf
    a, b, c, d = left.low, left.high, right.low, right.high
    try:
        if isinstance(op, ast.Add):
            low, high = _sum(a, c, -inf), _sum(b, d, inf)
        elif isinstance(op, ast.Sub):
            low, high = _sum(a, -d, -inf), _sum(b, -c, inf)
        elif isinstance(op, ast.Mult):
            low, high = _product(a, b, c, d, bool(has_float))
        elif isinstance(op, ast.Div):
            kinds = FLOAT
            if c > 0 or d < 0:
                low, high = _quotient(a, b, c, d)
        elif isinstance(op, ast.FloorDiv):
            if c > 0 and a >= 0 and a != inf:
                low, high = 0, inf if b == inf else b // c
        elif isinstance(op, ast.Mod):
            if c > 0 and d != inf and ((a != -inf and b != inf) or not has_float):
                low, high = 0, d if has_float else d - 1
        elif isinstance(op, ast.Pow):
            if not right.constants or not all(type(number) is int and 0 <= number <= 8 for number in right.constants):
                if not has_float and c >= 0:
                    return Value(INT, 0 if a >= 0 else -inf, inf, None, "", may, must)
                return Value(INT | FLOAT | OBJECT, -inf, inf, None, "", may, must, refs=None)
            if all(number % 2 == 0 for number in right.constants) and a != -inf and b != inf:
                low = 0
        elif has_float:
            return UNKNOWN
        elif isinstance(op, (ast.BitAnd, ast.BitOr, ast.BitXor)):
            if not (left.kinds | right.kinds) & ~BOOL:
                return Value(BOOL, 0, 1, (False, True), "", may, must)
            kinds = INT | ((left.kinds & right.kinds) & BOOL)
            if isinstance(op, ast.BitAnd) and (c >= 0 or a >= 0):
                low = 0
                high = min(d if c >= 0 else inf, b if a >= 0 else inf)
        elif isinstance(op, ast.RShift):
            if a >= 0:
                low, high = 0, b
        elif not isinstance(op, ast.LShift):
            return UNKNOWN
    except (ArithmeticError, ValueError):
        low, high = -inf, inf
    if low != low or high != high:
        low, high = -inf, inf
    return Value(kinds, low, high, None, _role(op, left, right), may, must)


def _sum(a: float, b: float, open_end: float) -> float:
    """Return a bound of a sum; `open_end` where both cancel to nothing known."""
    if (a in (inf, -inf) and b in (inf, -inf) and a != b) or a == open_end or b == open_end:
        return open_end
    return a + b


def _product(a: float, b: float, c: float, d: float, has_float: bool) -> tuple[float, float]:
    if inf in (a, b, c, d) or -inf in (a, b, c, d):
        # 0 times infinity is not a number: only whole numbers have no infinity.
        if has_float and ((a <= 0 <= b and (c == -inf or d == inf)) or (c <= 0 <= d and (a == -inf or b == inf))):
            return -inf, inf
        if a >= 0 and c >= 0:
            return a * c if inf not in (a, c) else 0, inf
        return -inf, inf
    corners = (a * c, a * d, b * c, b * d)
    return min(corners), max(corners)


def _quotient(a: float, b: float, c: float, d: float) -> tuple[float, float]:
    if inf in (a, b, c, d) or -inf in (a, b, c, d):
        if a >= 0 and c > 0 and d != inf:
            return 0, inf
        return -inf, inf
    corners = (a / c, a / d, b / c, b / d)
    return min(corners), max(corners)


def _of_other_kinds(op: ast.operator, left: Value, right: Value, site: frozenset[int], node: Any) -> Value:
    """Return what an operator gives where at least one operand may be no number."""
    found = BOTTOM
    may, must = _origins(left, right)
    left_number, right_number = left.kinds & NUMBER, right.kinds & NUMBER
    if left_number and right_number:
        numbers = _arithmetic(op, _part(left, NUMBER), _part(right, NUMBER))
        if numbers is UNKNOWN or numbers.kinds & OBJECT:
            return unknown_of(left, right)
        found = numbers
    if isinstance(op, ast.Add):
        for kind in (TEXT, BYTES):
            if left.kinds & right.kinds & kind:
                found = join(found, Value(kind, may=may, must=must))
        for kind in (LIST, TUPLE):
            if left.kinds & right.kinds & kind:
                found = join(found, _concatenation(kind, left, right, site, node))
    elif isinstance(op, ast.Mult):
        for one, other in ((left, right), (right, left)):
            if other.kinds & WHOLE:
                for kind in (TEXT, BYTES):
                    if one.kinds & kind:
                        found = join(found, Value(kind, may=may, must=must))
                for kind in (LIST, TUPLE):
                    if one.kinds & kind:
                        found = join(found, _repetition(kind, one, other, site, node))
    elif isinstance(op, ast.Mod):
        found = join(found, Value(left.kinds & (TEXT | BYTES), may=may, must=must)) if left.kinds & 24 else found
    if isinstance(op, (ast.BitOr, ast.BitAnd, ast.BitXor, ast.Sub)):
        if left.kinds & right.kinds & SET:
            found = join(found, Value(SET, constants=(), sites=site))
        if isinstance(op, ast.BitOr) and left.kinds & right.kinds & DICT:
            found = join(found, Value(DICT, constants=(), sites=site | unknown_of(left, right).sites))
    return found if found.kinds else unknown_of(left, right)


def _part(value: Value, kinds: int) -> Value:
    """Return the description of a value if it is of some kinds."""
    return value if not value.kinds & ~kinds else value.but(kinds=value.kinds & kinds, shape=None, sites=NO_SITES)


def _concatenation(kind: int, left: Value, right: Value, site: frozenset[int], node: Any) -> Value:
    a, b = left.shape, right.shape
    if a is None or b is None:
        made = unknown_of(left, right)
        return Value(kind, constants=(), shape=None, sites=made.sites | site, node=node, must=COMPUTED | JOINED)
    if a.items is not None and b.items is not None and len(a.items) + len(b.items) <= SIZE_MAX:
        shape = Shape((*a.items, *b.items))
    else:
        shape = Shape(None, join(a.any, b.any), a.least + b.least, a.most + b.most)
    may, must = _origins(left, right)
    return Value(kind, constants=(), may=may | JOINED, must=must | JOINED, shape=shape, sites=site, node=node)


def _repetition(kind: int, rows: Value, count: Value, site: frozenset[int], node: Any) -> Value:
    shape = rows.shape
    may, must = _origins(rows, count)
    may, must = may | JOINED, must | JOINED
    if shape is None:
        return Value(kind, constants=(), shape=None, sites=rows.sites | site, may=may, must=must, node=node)
    times = count.constant if count.has_constant and not count.kinds & ~WHOLE else None
    if times is not None and shape.items is not None and times * len(shape.items) <= SIZE_MAX:
        return Value(kind, constants=(), may=may, must=must, shape=Shape(shape.items * times), sites=site, node=node)
    least = most = inf
    if count.low >= 0 and shape.least != inf:
        least = 0 if inf in (count.low, shape.least) else shape.least * count.low
    else:
        least = 0
    most = inf if inf in (count.high, shape.most) else max(0, shape.most * count.high)
    return Value(
        kind, constants=(), may=may, must=must, shape=Shape(None, shape.any, least, most), sites=site, node=node
    )


# Truth and comparisons


def truth(value: Value) -> bool | None:
    """Return whether a value is true in a condition; None if that is not certain."""
    kinds = value.kinds
    if not kinds or kinds & OBJECT:
        return None
    can_be_true = can_be_false = False
    if kinds & SCALAR:
        if value.constants is not None:
            for known in value.constants:
                if known:
                    can_be_true = True
                else:
                    can_be_false = True
        else:
            if kinds & (TEXT | BYTES):
                return None
            if kinds & NUMBER:
                can_be_false = value.low <= 0 <= value.high
                can_be_true = not value.low == value.high == 0
            if kinds & NONE:
                can_be_false = True
    if kinds & FUNCTION:
        can_be_true = True
    if kinds & (ROW | DICT | SET | RANGE):
        shape = value.shape
        if shape is None:
            return None
        can_be_true = can_be_true or shape.most > 0
        can_be_false = can_be_false or shape.least == 0
    if can_be_true and can_be_false:
        return None
    return can_be_true


def are_of_other_kinds(left: Value, right: Value) -> bool:
    """Return whether two values can never be equal because they share no kind."""
    if (left.kinds | right.kinds) & OBJECT or not left.kinds or not right.kinds:
        return False
    one = left.kinds | (NUMBER if left.kinds & NUMBER else 0)
    other = right.kinds | (NUMBER if right.kinds & NUMBER else 0)
    return not one & other


def compare(op: ast.cmpop, left: Value, right: Value) -> bool | None:
    """Return the outcome of a comparison; None if that is not certain."""
    if not left.kinds or not right.kinds:
        return None
    if isinstance(op, (ast.Eq, ast.NotEq)):
        equal = is_equal(left, right)
        return None if equal is None else equal is isinstance(op, ast.Eq)
    if isinstance(op, (ast.Is, ast.IsNot)):
        if left.kinds == right.kinds == NONE:
            return isinstance(op, ast.Is)
        if not left.kinds & right.kinds and not (left.kinds | right.kinds) & OBJECT:
            return isinstance(op, ast.IsNot)
        return None
    if type(op) not in COMPARISONS or (left.kinds | right.kinds) & ~NUMBER:
        if left.constants is not None and right.constants is not None and not (left.kinds | right.kinds) & ~SCALAR:
            return _compared_constants(op, left, right)
        return None
    if isinstance(op, (ast.Lt, ast.GtE)):
        if left.high < right.low:
            return isinstance(op, ast.Lt)
        if left.low >= right.high and not _may_be_nan(left) and not _may_be_nan(right):
            return isinstance(op, ast.GtE)
    else:
        if left.high <= right.low and not _may_be_nan(left) and not _may_be_nan(right):
            return isinstance(op, ast.LtE)
        if left.low > right.high:
            return isinstance(op, ast.Gt)
    return None


def _may_be_nan(value: Value) -> bool:
    return bool(value.kinds & FLOAT) and value.low == -inf and value.high == inf


def _compared_constants(op: ast.cmpop, left: Value, right: Value) -> bool | None:
    function = COMPARISONS.get(type(op))
    if function is None:
        return None
    outcomes = set()
    for one in left.constants or ():
        for other in right.constants or ():
            try:
                outcomes.add(bool(function(one, other)))
            except TypeError:
                continue
    return outcomes.pop() if len(outcomes) == 1 else None


def is_equal(left: Value, right: Value) -> bool | None:
    """Return whether two values are equal; None if that is not certain."""
    if are_of_other_kinds(left, right):
        return False
    both = left.kinds | right.kinds
    if both & OBJECT:
        return None
    if not both & ~SCALAR:
        if left.constants is not None and right.constants is not None:
            return _compared_constants(ast.Eq(), left, right)
        if not both & ~NUMBER and (left.high < right.low or right.high < left.low):
            return False
        return None
    if not both & ~ROW and left.shape is not None and right.shape is not None:
        a, b = left.shape, right.shape
        if a.most < b.least or b.most < a.least:
            return False
        if a.items is not None and b.items is not None:
            equal = [is_equal(one, other) for one, other in zip(a.items, b.items, strict=False)]
            if False in equal:
                return False
    return None
