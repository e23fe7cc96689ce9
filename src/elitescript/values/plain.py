"""Operators of plain values, for all that evaluates expressions without running them, within bounds."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any, Final

LARGEST_EXPONENT: Final = 64
LONGEST: Final = 10_000
"""Characters of a text, and bits of a number, that are computed before the run."""

BINARY: Final[dict[type[ast.operator], Callable[[Any, Any], Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitOr: operator.or_,
    ast.BitAnd: operator.and_,
    ast.BitXor: operator.xor,
}
UNARY: Final[dict[type[ast.unaryop], Callable[[Any], Any]]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
COMPARISONS: Final[dict[type[ast.cmpop], Callable[[Any, Any], bool]]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
MIRRORED: Final[dict[type[ast.cmpop], type[ast.cmpop]]] = {
    ast.Eq: ast.Eq,
    ast.NotEq: ast.NotEq,
    ast.Lt: ast.Gt,
    ast.LtE: ast.GtE,
    ast.Gt: ast.Lt,
    ast.GtE: ast.LtE,
    ast.Is: ast.Is,
    ast.IsNot: ast.IsNot,
}
OPPOSITE: Final[dict[type[ast.cmpop], type[ast.cmpop]]] = {
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}


class Impossible(Exception):
    """The result of an operator is an error, or is not computed before the run."""


def compute(op: ast.operator, left: Any, right: Any) -> Any:
    """Return the result of an operator with plain values.

    Raises:
        Impossible: it is an error, or too large.
    """
    function = BINARY.get(type(op))
    if function is None:
        raise Impossible
    is_growing = isinstance(op, (ast.Pow, ast.LShift))
    if is_growing and not (isinstance(right, (int, float)) and abs(right) <= LARGEST_EXPONENT):
        raise Impossible
    if isinstance(op, ast.Mult) and (isinstance(left, (str, bytes)) or isinstance(right, (str, bytes))):
        text, count = (left, right) if isinstance(left, (str, bytes)) else (right, left)
        if not isinstance(count, int) or count * len(text) > LONGEST:
            raise Impossible
    if isinstance(op, ast.Mod) and isinstance(left, (str, bytes)):
        raise Impossible
    try:
        return checked(function(left, right))
    except (ArithmeticError, TypeError, ValueError):
        raise Impossible from None


def checked(result: Any) -> Any:
    """Return a plain value.

    Raises:
        Impossible: it is of another type, or longer than what is computed before the run.
    """
    if isinstance(result, (str, bytes)):
        if len(result) > LONGEST:
            raise Impossible
    elif isinstance(result, int):
        if result.bit_length() > LONGEST:
            raise Impossible
    elif not isinstance(result, float) and result is not None:
        raise Impossible
    return result
