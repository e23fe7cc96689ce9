"""The tree, the operators and the limits of expressions: for all that evaluates them without running them.

Properties, world files, watches and breakpoints, the words of alarms and the abstract evaluation of programs share
them; what a value means is of each.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable
from typing import Any, Final

from elitescript.language.advice.expression_slips import slip

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
MEMBERSHIP: Final[dict[type[ast.cmpop], Callable[[Any, Any], bool]]] = {
    ast.In: lambda item, holder: item in holder,
    ast.NotIn: lambda item, holder: item not in holder,
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


SIGNS: Final[dict[type[ast.AST], str]] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
    ast.MatMult: "@",
    ast.LShift: "<<",
    ast.RShift: ">>",
    ast.BitAnd: "&",
    ast.BitOr: "|",
    ast.BitXor: "^",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
"""Operators as they are written; `==` and `!=` take any operands."""

TEXT_MAX: Final = 2000
"""Characters of an expression that is given beside a program."""
DEPTH_MAX: Final = 40
"""Parts inside each other, in such an expression."""


class NoExpression(Exception):
    """A text is no expression, or one that is too long or too deep.

    Attributes:
        text: why, and what to write if it has a sign of another language.
        place: its first character and the one behind its last, from 0; None for the whole.
        node: where, if the text has a tree; else None.
    """

    def __init__(self, text: str, place: tuple[int, int] | None = None, node: ast.expr | None = None) -> None:
        super().__init__(text)
        self.text = text
        self.place = place
        self.node = node


def tree_of(text: str, text_max: int | None = TEXT_MAX, depth_max: int | None = DEPTH_MAX) -> ast.expr:
    """Return the tree of an expression.

    Args:
        text: of one line.
        text_max: most characters; None for any number.
        depth_max: most parts inside each other; None for any number.

    Raises:
        NoExpression: it is none.
    """
    if text_max is not None and len(text) > text_max:
        raise NoExpression(f"an expression has {text_max} characters at most, not {len(text)}")
    try:
        tree = ast.parse(text, mode="eval").body
    except SyntaxError as error:
        found = slip(text)
        if found is not None:
            raise NoExpression(found.text, (found.start, found.end)) from None
        column = min(max(error.offset or 1, 1), len(text)) - 1
        raise NoExpression(error.msg, (column, column + 1)) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise NoExpression(str(error) or "it is nested too deeply") from None
    level = [tree]
    for _ in range(depth_max or 0):
        level = [part for node in level for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)]
        if not level:
            break
    if depth_max is not None and level:
        raise NoExpression(f"parts are nested more than {depth_max} deep", node=level[0])
    return tree


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
